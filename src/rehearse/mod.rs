//! A test rehearsed before a unit is recorded: units below, at and above each limit are simulated and go through the pipeline of a run.

mod unit;

use crate::acceptance::{Request, execute, power};
use crate::config::model::ModelFile;
use crate::config::procedure::{EffectiveLimits, LimitsFile, Loaded, Procedure};
use crate::estimate::Verdict;
use crate::i18n::{Note, note};
use crate::ingest::Source;
use crate::lot::share::Share;
use crate::record::{
    HistoryShare, Message, NeededLength, Program, REHEARSAL_FORMAT, RehearsalRecord, RehearsedLength,
    RehearsedLevel, RehearsedRow, RunKind, RunRecord, UnitUnderTest, VerdictCounts,
};
use crate::simulate::stream;
use chrono::{DateTime, SecondsFormat, Utc};
use rayon::prelude::*;
use std::sync::Mutex;
use unit::{Bench, Level};

/// Sizes of units as multiples of a limit: well inside, at it, and well beyond it.
const FACTORS: [f64; 3] = [0.5, 1.0, 1.5];

/// Rate of the simulated recordings where neither procedure nor model states one, Hz.
const DEFAULT_SAMPLE_RATE_HZ: f64 = 1.0;

/// Most samples of a simulated recording.
const MAX_SAMPLES: f64 = 2e7;

/// Order of a rehearsal.
pub struct Order<'a> {
    /// The procedure.
    pub procedure: &'a Loaded<Procedure>,
    /// The limits file beside it.
    pub limits: Option<&'a Loaded<LimitsFile>>,
    /// The limits that hold.
    pub effective: &'a EffectiveLimits,
    /// The model of a nominal unit with its path.
    pub model: Option<(&'a ModelFile, String)>,
    /// Usable lengths, s; empty for those of the procedure.
    pub lengths_s: Vec<f64>,
    /// Rate of the recordings, Hz; `None`: that of the procedure or the model.
    pub sample_rate_hz: Option<f64>,
    /// Units of each level.
    pub units: usize,
    /// Risk that a length is to keep.
    pub risk: f64,
    /// Seed.
    pub seed: u64,
    /// The present moment.
    pub now: DateTime<Utc>,
}

/// A test of one simulated unit.
struct Trial {
    length: usize,
    /// Position among the levels; `None` for a nominal unit.
    level: Option<usize>,
    verdict: Verdict,
    /// Verdicts of rows with a limit: id, channel.
    rows: Vec<(String, String, Verdict)>,
}

/// Rehearses a test. `progress` gets units tested and units in all.
///
/// # Errors
/// A note that says why this test cannot be rehearsed.
pub fn rehearse(order: &Order<'_>, progress: &(dyn Fn(u64, u64) + Sync)) -> Result<RehearsalRecord, Note> {
    let procedure = &order.procedure.value;
    let stated = order.sample_rate_hz.or(procedure.sample_rate_hz);
    let of_model = order.model.as_ref().map(|(m, _)| m.claim.sample_rate_hz);
    let sample_rate_hz = stated.or(of_model).unwrap_or(DEFAULT_SAMPLE_RATE_HZ);
    let model = order.model.as_ref().map(|(m, _)| *m);
    let bench = Bench::new(procedure, order.effective, model, sample_rate_hz)?;
    let needed = needed(order, &bench);
    let lengths_s = lengths(order, &needed)?;
    let longest = lengths_s.iter().copied().fold(0.0, f64::max) + procedure.conditions.warm_up_s;
    if longest * sample_rate_hz > MAX_SAMPLES {
        let samples = format!("{:.0}", longest * sample_rate_hz);
        return Err(note!("rehearse.too_long", samples, most = format!("{MAX_SAMPLES:.0}")));
    }
    let levels: Vec<Level> = if bench.is_at_rest() { levels(order, &bench) } else { vec![] };
    let trials = trials(order, &bench, &lengths_s, &levels, progress)?;
    let lengths: Vec<RehearsedLength> = lengths_s
        .iter()
        .enumerate()
        .map(|(i, length_s)| summed(length_s / 3600.0, &levels, trials.iter().filter(|t| t.length == i)))
        .collect();
    let keeps = |l: &&RehearsedLength| {
        let within = |share: &Option<HistoryShare>| share.is_none_or(|s| s.value() <= order.risk);
        within(&l.consumers_risk) && within(&l.producers_risk)
    };
    Ok(RehearsalRecord {
        format: REHEARSAL_FORMAT.to_owned(),
        program: Program::this(),
        made_at: order.now.to_rfc3339_opts(SecondsFormat::Secs, true),
        procedure: order.procedure.record(order.limits),
        model: order.model.as_ref().map(|(_, path)| path.clone()),
        seed: order.seed,
        units: order.units,
        sample_rate_hz,
        stated_risk: order.risk,
        nominal: bench.nominal_values(),
        shortest_h: lengths.iter().find(keeps).map(|l| l.length_h),
        lengths,
        needed,
        notes: notes(order, &bench, stated.or(of_model).is_none()),
    })
}

/// What a reader must know of the rehearsal.
fn notes(order: &Order<'_>, bench: &Bench<'_>, assumed_rate: bool) -> Vec<Message> {
    let mut notes = vec![];
    if assumed_rate {
        notes.push(note!("rehearse.note.rate", hz = DEFAULT_SAMPLE_RATE_HZ));
    }
    if !bench.is_at_rest() {
        notes.push(note!("rehearse.note.nominal_only"));
    }
    let without: Vec<&str> = bench.unvaried(order.effective).collect();
    if bench.is_at_rest() && !without.is_empty() {
        notes.push(note!("rehearse.note.unvaried", ids = without.join(", ")));
    }
    if order.effective.set.limits.is_empty() {
        notes.push(note!("rehearse.note.no_limits"));
    }
    notes.into_iter().map(Into::into).collect()
}

/// The lengths to rehearse, the shortest first: those asked for, or the least and the planned one of the procedure and the one that the slowest
/// limit needs.
fn lengths(order: &Order<'_>, needed: &[NeededLength]) -> Result<Vec<f64>, Note> {
    let conditions = &order.procedure.value.conditions;
    let least = conditions.minimum_duration_s.unwrap_or(0.0);
    let mut lengths = order.lengths_s.clone();
    if let Some(short) = lengths.iter().find(|l| **l < least) {
        let (short_h, least_h) = (short / 3600.0, least / 3600.0);
        return Err(note!("rehearse.below_minimum", short_h, least_h));
    }
    if lengths.is_empty() {
        lengths.extend(conditions.minimum_duration_s);
        lengths.extend(conditions.planned_duration_s);
        let of_model = order.model.as_ref().and_then(|(m, _)| m.simulation.duration_s);
        lengths.extend(of_model.map(|s| s - conditions.warm_up_s).filter(|s| *s >= least && *s > 0.0));
        let longest = lengths.iter().copied().fold(0.0, f64::max);
        let slowest = needed.first().and_then(|n| n.needed_h).map(|h| 3600.0 * h.ceil());
        lengths.extend(slowest.filter(|s| *s > least && *s < 2.0 * longest));
    }
    lengths.sort_by(f64::total_cmp);
    lengths.dedup();
    if lengths.is_empty() {
        return Err(note!("rehearse.no_length"));
    }
    Ok(lengths)
}

/// How long each limit needs by the predicted uncertainty, the longest first; a limit that no length decides comes before all.
fn needed(order: &Order<'_>, bench: &Bench<'_>) -> Vec<NeededLength> {
    let mut list = vec![];
    for spec in &order.effective.set.limits {
        let Some(channel) = bench.channel_of(spec, order.effective) else { continue };
        let situation = bench.situation(channel);
        let Some(power) = power::of_limit(spec.measurand, &spec.limit, &situation) else { continue };
        let Some(limit) = spec.limit.max else { continue };
        list.push(NeededLength {
            id: spec.measurand.id.to_owned(),
            channel: channel.to_owned(),
            limit,
            unit: spec.measurand.unit.to_owned(),
            needed_h: power.needed_duration_h,
        });
    }
    list.sort_by(|a, b| {
        let hours = |n: &NeededLength| n.needed_h.unwrap_or(f64::INFINITY);
        hours(b).total_cmp(&hours(a))
    });
    list
}

/// Units below, at and above each limit that a coefficient of the model can be set by.
fn levels(order: &Order<'_>, bench: &Bench<'_>) -> Vec<Level> {
    let specs = order.effective.set.limits.iter();
    let varied = specs.filter_map(|s| Some((s, bench.channel_of(s, order.effective)?, bench.varied(s)?)));
    varied
        .flat_map(|(spec, channel, limit)| {
            FACTORS.map(|factor| Level {
                measurand: spec.measurand,
                channel: channel.to_owned(),
                factor,
                value: factor * limit,
            })
        })
        .collect()
}

/// Tests the units of all lengths and levels. The seed of a unit depends on its place alone, so that the number of threads changes nothing.
fn trials(
    order: &Order<'_>,
    bench: &Bench<'_>,
    lengths_s: &[f64],
    levels: &[Level],
    progress: &(dyn Fn(u64, u64) + Sync),
) -> Result<Vec<Trial>, Note> {
    let kinds = 1 + levels.len();
    let jobs: Vec<(usize, usize, usize)> = (0..lengths_s.len())
        .flat_map(|length| (0..kinds).map(move |kind| (length, kind)))
        .flat_map(|(length, kind)| (0..order.units).map(move |unit| (length, kind, unit)))
        .collect();
    let done = Mutex::new(0u64);
    let all = jobs.len() as u64;
    jobs.into_par_iter()
        .map(|(length, kind, unit)| {
            let level = kind.checked_sub(1).and_then(|k| levels.get(k));
            let place = ((length * kinds + kind) * order.units + unit) as u64;
            let length_s = lengths_s.get(length).copied().unwrap_or_default();
            let source = bench.recording(length_s, level, stream(order.seed, place))?;
            let record = tested(order, bench, &source);
            if let Ok(mut done) = done.lock() {
                *done += 1;
                progress(*done, all);
            }
            Ok(Trial {
                length,
                level: kind.checked_sub(1),
                verdict: record.as_ref().map_or(Verdict::Error, |r| r.verdict),
                rows: record.map_or(vec![], |r| {
                    let limited = r.measurands.into_iter().filter(|m| m.verdict != Verdict::None);
                    limited.map(|m| (m.id, m.channel, m.verdict)).collect()
                }),
            })
        })
        .collect()
}

/// The record of a run on a simulated recording; `None` where it could not be evaluated.
fn tested(order: &Order<'_>, bench: &Bench<'_>, source: &Source) -> Option<RunRecord> {
    let request = Request {
        kind: RunKind::Run,
        procedure: bench.procedure(),
        procedure_record: None,
        limits: order.effective,
        source,
        use_stamps: true,
        unit: UnitUnderTest { serial: Some("rehearsal".to_owned()), ..UnitUnderTest::default() },
        serial_of_recording: false,
        operator: None,
        station: None,
        now: order.now,
        taus: None,
        exact: false,
        bench_checks: None,
    };
    execute(&request, &mut |_, _| {}).ok().map(|outcome| outcome.record)
}

/// The verdicts of one length.
fn summed<'t>(length_h: f64, levels: &[Level], trials: impl Iterator<Item = &'t Trial>) -> RehearsedLength {
    let trials: Vec<&Trial> = trials.collect();
    let nominal: Vec<&&Trial> = trials.iter().filter(|t| t.level.is_none()).collect();
    let mut rows: Vec<RehearsedRow> = vec![];
    for (id, channel, verdict) in nominal.iter().flat_map(|t| &t.rows) {
        let known = rows.iter_mut().find(|r| r.id == *id && r.channel == *channel);
        let counts = VerdictCounts::of([*verdict]);
        match known {
            Some(row) => row.counts += counts,
            None => rows.push(RehearsedRow { id: id.clone(), channel: channel.clone(), counts }),
        }
    }
    let of_level = |(i, level): (usize, &Level)| {
        let own: Vec<&&Trial> = trials.iter().filter(|t| t.level == Some(i)).collect();
        let is_row = |(id, channel, _): &&(String, String, Verdict)| {
            id == level.measurand.id && *channel == level.channel
        };
        RehearsedLevel {
            id: level.measurand.id.to_owned(),
            channel: level.channel.clone(),
            factor: level.factor,
            value: level.value,
            unit: level.measurand.unit.to_owned(),
            whole: VerdictCounts::of(own.iter().map(|t| t.verdict)),
            row: VerdictCounts::of(own.iter().filter_map(|t| Some(t.rows.iter().find(is_row)?.2))),
        }
    };
    let levels: Vec<RehearsedLevel> = levels.iter().enumerate().map(of_level).collect();
    let beyond = levels.iter().filter(|l| l.factor >= 1.0);
    let worst = beyond.max_by_key(|l| l.whole.pass).map(|l| (l.whole.pass, l.whole.total()));
    let counts = VerdictCounts::of(nominal.iter().map(|t| t.verdict));
    RehearsedLength {
        length_h,
        rows,
        levels,
        consumers_risk: worst.and_then(|(count, of)| Share::of(count, of)).map(Into::into),
        producers_risk: Share::of(counts.total() - counts.pass, counts.total()).map(Into::into),
        nominal: counts,
    }
}
