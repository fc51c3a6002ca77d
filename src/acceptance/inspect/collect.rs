//! One pass over a recording for everything that `inspect` says.

use super::columns::{self, Content, Listed};
use super::tracks::{Angle, HeldLevels, LevelFinder, LinearFit, runs};
use crate::acceptance::column_choice::{ColumnChoice, unusable};
use crate::acceptance::condition::stability_track::{StabilityFacts, StabilityTrack};
use crate::acceptance::reading::tidy;
use crate::criticism;
use crate::estimate::Objection;
use crate::i18n::{Arg, Note, note};
use crate::ingest::{IngestError, Plan, Source, StreamReport, TimeBaseSpec, prepare};
use crate::measurand::GyroEvidence;
use crate::measurand::evidence::Course;
use crate::noise::digest::{DigestPlan, RateAccumulator, RateDigest};
use crate::noise::envelope::{Envelope, EnvelopeAccumulator};
use crate::noise::identification::Identification;
use crate::noise::lines::{FALSE_ALARM_RATE, SpectralLine};
use crate::noise::motion::{Motion, motion, together};
use crate::recording::{Channel, Role, SampleBlock, Sink};
use rayon::prelude::*;

/// Time over which temperatures are smoothed, s.
const SMOOTHING_S: f64 = 60.0;

/// Where the time of a row comes from.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum TimeBase {
    /// The time column of this name.
    Stamps(String),
    /// The sample rate that was given; why the time column was left, where there is one.
    Declared(f64, Option<Note>),
    /// Nowhere: rows are counted. Why the time column cannot serve, where there is one.
    Rows(Option<Note>),
}

impl TimeBase {
    pub fn is_known(&self) -> bool {
        !matches!(self, TimeBase::Rows(_))
    }
}

/// A gyro channel after the pass.
pub(super) struct Gyro {
    pub slot: usize,
    pub name: String,
    pub digest: RateDigest,
    pub lines: Vec<SpectralLine>,
    pub identification: Identification,
    /// What checks contradict.
    pub objections: Vec<Objection>,
    pub quietest_deg_h: Option<f64>,
    pub angle: Angle,
    pub motion: Motion,
}

/// A temperature channel after the pass.
pub(super) struct Temperature {
    pub name: String,
    pub min_deg_c: f64,
    pub max_deg_c: f64,
    /// Steepest trend in half an hour, degC/h.
    pub steepest_deg_c_h: Option<f64>,
    pub runs: (u32, u32),
}

impl Temperature {
    pub fn range(&self) -> f64 {
        self.max_deg_c - self.min_deg_c
    }
}

/// A driven channel after the pass: deg/h or arcsec.
pub(super) struct DrivenChannel {
    pub name: String,
    pub role: Role,
    pub facts: HeldLevels,
}

/// A column that goes with the table rate.
pub(super) struct CorrelatedColumn {
    pub name: String,
    pub unit: String,
    pub correlation: f64,
    /// Units of the column, as inside, for 1 deg/h.
    pub slope: f64,
}

/// Everything that was found.
pub(super) struct Inspection {
    pub listed: Vec<Listed>,
    /// For each channel of the report, its place in `listed`.
    pub places: Vec<usize>,
    pub channels: Vec<Channel>,
    pub time: TimeBase,
    pub declared_hz: Option<f64>,
    pub tau0_s: f64,
    pub report: StreamReport,
    pub gyros: Vec<Gyro>,
    pub temperatures: Vec<Temperature>,
    pub driven: Vec<DrivenChannel>,
    pub correlated: Vec<CorrelatedColumn>,
}

pub(super) fn collect(
    source: &Source,
    choice: &ColumnChoice,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<Inspection, IngestError> {
    let mut listed = columns::list(source)?;
    columns::choose(&mut listed, choice, source)?;
    let sample_rate_hz = source.rate_without_stamps_hz(choice.sample_rate_hz);
    let time = time_base(source, &listed, sample_rate_hz);
    let (channels, places) = columns::channels(&listed, time.is_known());
    let plan = prepare(source, &channels, spec(&time))?;
    let mut pass = Pass::new(&channels, &plan, time.is_known());
    let report = plan.stream(&mut [&mut pass], progress)?;
    let tau0_s = tidy(report.tau0_measured_s);
    let smoothed = time.is_known() && report.duration_s >= 10.0 * SMOOTHING_S;
    let temperatures = pass.temperatures(&channels, smoothed);
    let warming = temperatures.iter().map(Temperature::range).fold(0.0, f64::max);
    let driven = pass.driven(&channels, !time.is_known());
    let correlated = pass.correlated(&channels);
    let gyros = pass.gyros(&channels, &report, tau0_s, warming);
    Ok(Inspection {
        places,
        time,
        declared_hz: sample_rate_hz,
        tau0_s,
        report,
        gyros,
        temperatures,
        driven,
        correlated,
        listed,
        channels: channels.clone(),
    })
}

/// Finds out whether the time column serves; where it does not, the declared rate or the count of the rows does.
fn time_base(source: &Source, listed: &[Listed], sample_rate_hz: Option<f64>) -> TimeBase {
    let (channels, _) = columns::channels(listed, true);
    let without = |why: Option<Note>| {
        sample_rate_hz.map_or(TimeBase::Rows(why.clone()), |hz| TimeBase::Declared(hz, why))
    };
    let Some(time) = channels.iter().find(|c| c.role == Role::Time) else {
        let text = listed.iter().find_map(|c| match &c.content {
            Content::Text(sample) if c.guess.role == Role::Time => Some(why(&c.name, sample.as_str())),
            _ => None,
        });
        let base = without(text);
        return base;
    };
    match unusable(source, time) {
        Some(reason) => without(Some(why(&time.id, reason))),
        None => TimeBase::Stamps(time.id.clone()),
    }
}

/// Why a time column cannot serve.
fn why(column: &str, reason: impl Into<Arg>) -> Note {
    note!("inspect.of_column", column, what = reason)
}

fn spec(time: &TimeBase) -> TimeBaseSpec {
    match time {
        TimeBase::Stamps(_) => TimeBaseSpec::default(),
        TimeBase::Declared(hz, _) => {
            TimeBaseSpec { declared_sample_rate_hz: Some(*hz), use_stamps: false, ..TimeBaseSpec::default() }
        }
        // One row a second, so that positions can be identified; no time is shown.
        TimeBase::Rows(_) => {
            TimeBaseSpec { declared_sample_rate_hz: Some(1.0), use_stamps: false, ..TimeBaseSpec::default() }
        }
    }
}

struct GyroTrack {
    slot: usize,
    digest: RateAccumulator,
    envelope: EnvelopeAccumulator,
    angle: Angle,
}

struct Pass {
    tau0_s: f64,
    start_s: f64,
    gyros: Vec<GyroTrack>,
    temperatures: Vec<(usize, StabilityTrack, EnvelopeAccumulator)>,
    driven: Vec<(usize, LevelFinder)>,
    table: Option<usize>,
    follow: Vec<(usize, LinearFit)>,
}

impl Pass {
    fn new(channels: &[Channel], plan: &Plan<'_>, timed: bool) -> Pass {
        let tau0_s = tidy(plan.clock().interval_s);
        let slots = |wanted: fn(Role) -> bool| {
            channels.iter().enumerate().filter(move |(_, c)| wanted(c.role)).map(|(slot, _)| slot)
        };
        let gyros = slots(Role::is_gyro).filter(|_| timed).map(|slot| GyroTrack {
            slot,
            digest: RateAccumulator::new(DigestPlan::new(tau0_s)),
            envelope: EnvelopeAccumulator::new(),
            angle: Angle::default(),
        });
        let temperatures = slots(|r| r == Role::Temperature)
            .map(|s| (s, StabilityTrack::new(SMOOTHING_S, tau0_s, None), EnvelopeAccumulator::new()));
        let driven = slots(|r| matches!(r, Role::TableRate | Role::TableAngle | Role::OuterRate))
            .map(|s| (s, LevelFinder::default()));
        let table = channels.iter().position(|c| c.role == Role::TableRate);
        let follow = slots(|r| r.is_gyro() || r == Role::Auxiliary)
            .filter(|_| table.is_some())
            .map(|s| (s, LinearFit::default()));
        Pass {
            tau0_s,
            start_s: plan.start_s(),
            gyros: gyros.collect(),
            temperatures: temperatures.collect(),
            driven: driven.collect(),
            table,
            follow: follow.collect(),
        }
    }

    fn gyros(
        self,
        channels: &[Channel],
        report: &StreamReport,
        tau0_s: f64,
        warming_deg_c: f64,
    ) -> Vec<Gyro> {
        let course = |(slot, _, envelope): &(usize, StabilityTrack, EnvelopeAccumulator)| {
            Some((channels.get(*slot)?.id.clone(), envelope.finish()))
        };
        let temperatures: Vec<(String, Envelope)> = self.temperatures.iter().filter_map(course).collect();
        let with = |track: GyroTrack| {
            let name = channels.get(track.slot)?.id.clone();
            let digest = track.digest.finish();
            let quietest_deg_h = digest.quietest_deg_h;
            let step_deg_h = report.channels.get(track.slot).and_then(|c| c.values.quantization_step);
            let motion = motion(&digest.blocks, tau0_s, quietest_deg_h, warming_deg_c);
            let first = GyroEvidence::first_look(name, digest, tau0_s, FALSE_ALARM_RATE, step_deg_h);
            let course = Course { rate: track.envelope.finish(), temperatures: temperatures.clone() };
            let evidence = GyroEvidence { motion, course: Some(course), ..first };
            Some(Gyro {
                slot: track.slot,
                objections: criticism::of_gyro(&evidence).to_vec(),
                name: evidence.channel,
                motion,
                digest: evidence.digest,
                lines: evidence.lines,
                identification: evidence.identification,
                quietest_deg_h,
                angle: track.angle,
            })
        };
        let mut gyros: Vec<Gyro> = self.gyros.into_par_iter().filter_map(with).collect();
        together(gyros.iter_mut().map(|g| &mut g.motion).collect());
        gyros
    }

    /// Extremes are smoothed where the record is long enough for it.
    fn temperatures(&self, channels: &[Channel], smoothed: bool) -> Vec<Temperature> {
        let found = self.temperatures.iter().filter_map(|(slot, track, envelope)| {
            let facts: StabilityFacts = track.clone().finish()?;
            let means: Vec<f64> = envelope.finish().bins.iter().map(|b| b.mean).collect();
            let (min_deg_c, max_deg_c) = if smoothed {
                (facts.smooth_min.value, facts.smooth_max.value)
            } else {
                (facts.raw_min, facts.raw_max)
            };
            Some(Temperature {
                name: channels.get(*slot)?.id.clone(),
                min_deg_c,
                max_deg_c,
                steepest_deg_c_h: facts.steepest_deg_c_per_h,
                runs: runs(&means),
            })
        });
        found.collect()
    }

    fn driven(&self, channels: &[Channel], every_row_counts: bool) -> Vec<DrivenChannel> {
        let found = self.driven.iter().filter_map(|(slot, levels)| {
            let channel = channels.get(*slot)?;
            let facts = levels.finish(every_row_counts)?;
            Some(DrivenChannel { name: channel.id.clone(), role: channel.role, facts })
        });
        found.collect()
    }

    fn correlated(&self, channels: &[Channel]) -> Vec<CorrelatedColumn> {
        let found = self.follow.iter().filter_map(|(slot, follow)| {
            let (channel, (correlation, slope)) = (channels.get(*slot)?, follow.finish()?);
            let unit =
                if channel.role.is_gyro() { "deg/h".to_owned() } else { channel.unit.text().to_owned() };
            Some(CorrelatedColumn { name: channel.id.clone(), unit, correlation, slope })
        });
        found.filter(|f| f.correlation.abs() > 0.9).collect()
    }
}

impl Sink for Pass {
    fn push(&mut self, block: &SampleBlock<'_>) {
        for gyro in &mut self.gyros {
            let Some(values) = block.values.get(gyro.slot) else { continue };
            gyro.digest.push(values, block.first_index, block.continues);
            gyro.envelope.push(values, block.first_index);
            gyro.angle.push(values, self.tau0_s);
        }
        for (slot, track, envelope) in &mut self.temperatures {
            if let Some(values) = block.values.get(*slot) {
                track.push(values, block.time_s - self.start_s, block.continues);
                envelope.push(values, block.first_index);
            }
        }
        for (slot, levels) in &mut self.driven {
            levels.push(block.values.get(*slot).map(Vec::as_slice).unwrap_or_default());
        }
        let Some(table) = self.table.and_then(|t| block.values.get(t)) else { return };
        for (slot, follow) in &mut self.follow {
            follow.push(table, block.values.get(*slot).map(Vec::as_slice).unwrap_or_default());
        }
    }
}
