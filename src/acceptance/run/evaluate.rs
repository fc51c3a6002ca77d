//! From a recording to the outcome.

use super::pass::{Collected, Inside, Overview};
use super::reading::{about, channels, plan, read_at_measured_interval, settle_integrity, tidy, window};
use super::{
    Outcome, Request, RunError, drawn, gyro_facts, power, settle, sigma_tau, thermal, verdict, warm_up,
};
use crate::acceptance::condition::checks::CheckLog;
use crate::acceptance::condition::stability_track::{StabilityFacts, StabilityKey};
use crate::acceptance::condition::{Facts, WarmUpFact, judge_all};
use crate::config::procedure::Procedure;
use crate::config::procedure::model::Taus;
use crate::i18n::{Arg, Note};
use crate::ingest::{Plan, StreamReport};
use crate::measurand::{Earth, GyroEvidence, static_bias};
use crate::noise::coarse;
use crate::noise::composite::Sampling;
use crate::noise::curve_check;
use crate::noise::digest::RateDigest;
use crate::noise::envelope::Envelope;
use crate::noise::family::Estimator;
use crate::noise::identification::Identification;
use crate::noise::intervals::BoundedPoint;
use crate::noise::lines::{SpectralLine, find_lines};
use crate::noise::motion::{Motion, motion, together};
use crate::noise::residual::GoodnessOfFit;
use crate::noise::spectral_record::SpectralRecord;
use crate::noise::tau_grid::TauGrid;
use crate::noise::whole::Whole;
use crate::record::{ConditionStatus, RunKind, Window};
use crate::recording::window::Windowed;
use crate::recording::{Channel, Role};
use crate::temperature::findings::Schedule;
use std::collections::BTreeMap;

/// Everything that was found, before verdicts.
pub(super) struct Found {
    pub channels: Vec<Channel>,
    pub report: StreamReport,
    pub tau0_s: f64,
    pub window: Window,
    pub gyros: Vec<GyroEvidence>,
    pub stability: BTreeMap<StabilityKey, StabilityFacts>,
    pub envelopes: BTreeMap<usize, Envelope>,
    pub grid: TauGrid,
    pub exact: bool,
    /// The schedule of a test over temperature.
    pub schedule: Option<Schedule>,
    /// Checks that were made.
    pub checks: CheckLog,
}

impl Found {
    /// Whether the record is one at constant conditions, so that noise of the whole record has a meaning.
    pub fn at_rest(&self) -> bool {
        self.gyros.iter().all(|g| g.over_temperature.is_none() && g.warm_up.is_none())
    }
}

pub(super) fn execute(
    request: &Request<'_>,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<Outcome, RunError> {
    let found = collect(request, progress)?;
    let procedure = request.procedure;
    let warm_up: Vec<WarmUpFact> = found
        .gyros
        .iter()
        .filter(|_| found.at_rest())
        .filter_map(|g| warm_up::fact(g, static_bias::uncertainty(g, true).standard()))
        .collect();
    let gyros = if request.kind == RunKind::Run { gyro_facts::gyros(&found) } else { vec![] };
    // Without a procedure the unit comes from the name of the column, or from a user who knows better.
    let columns =
        if request.kind == RunKind::Run { gyro_facts::columns(request.source, &found) } else { vec![] };
    let stated_serials = request.source.stated_serials();
    let mut conditions = judge_all(&Facts {
        procedure,
        integrity: &found.report.integrity,
        rows: found.report.rows,
        sample_interval_s: found.tau0_s,
        clock_notes: &found.report.notes,
        has_stamps: request.use_stamps && found.channels.iter().any(|c| c.role == Role::Time),
        usable_s: found.window.usable_s,
        longest_gap_s: longest_gap_s(&found.window),
        stability: &found.stability,
        warm_up: if request.kind == RunKind::Run { &warm_up } else { &[] },
        gyros: &gyros,
        limits: request.limits,
        columns: &columns,
        duration_s: found.report.duration_s,
        stated_serials: if request.kind == RunKind::Run { &stated_serials } else { &[] },
        serial: request.unit.serial.as_deref(),
        schedule: found.schedule.as_ref(),
        today: request.now.date_naive(),
        checks: &found.checks,
    });
    if request.kind == RunKind::Analyze {
        // An analysis asks nothing of a recording and judges no unit.
        for c in conditions.iter_mut().filter(|c| c.status == ConditionStatus::Invalid) {
            c.status = ConditionStatus::Remark;
        }
    }
    let rows = measure(request, &found);
    let drawn = drawn::draw(request, &found);
    let compensation = thermal::tables(request, &found);
    let tables = found
        .gyros
        .iter()
        .filter(|_| found.at_rest())
        .map(|g| {
            let name =
                if g.several { format!("sigma_tau_{}.csv", g.channel) } else { "sigma_tau.csv".into() };
            (name, sigma_tau::csv(g))
        })
        .chain(compensation)
        .collect();
    let powers = power::records(request.limits, &found.gyros);
    let record = settle::record(request, &found, conditions, rows, powers, &drawn);
    Ok(Outcome { record, figures: drawn, tables })
}

fn collect(request: &Request<'_>, progress: &mut dyn FnMut(u64, u64)) -> Result<Found, RunError> {
    let procedure = request.procedure;
    let channels = channels(procedure, request.source);
    let mut plan = plan(request, &channels)?;
    let nominal_s = plan.clock().interval_s;
    let grid = request.taus.clone().unwrap_or_else(|| match &procedure.analysis.taus {
        Taus::Octave => TauGrid::Octave,
        Taus::Decade => TauGrid::Decade,
        Taus::All => TauGrid::All,
        Taus::List(taus) => TauGrid::List(taus.clone()),
    });
    grid.check(tidy(nominal_s))?;
    let exact = request.exact || procedure.analysis.exact;
    let mut read = |plan: &Plan<'_>| -> Result<_, RunError> {
        let mut overview = Overview::new(procedure, &channels, tidy(nominal_s));
        let inside =
            Inside::new(procedure, &channels, &grid, Estimator::ALL, exact, tidy(nominal_s), plan.start_s());
        let mut windowed = Windowed::new(inside, window(procedure), plan.start_s(), nominal_s);
        let report = plan.stream(&mut [&mut overview, &mut windowed], progress)?;
        Ok(((overview, windowed), report))
    };
    let ((overview, windowed), mut report) = read_at_measured_interval(&mut plan, &mut read)?;
    let (inside, window) = windowed.finish();
    let Collected { gyros, stability, means } = inside.finish();
    let tau0_s = tidy(report.tau0_measured_s);
    let several = gyros.len() > 1;
    let mut gyros: Vec<GyroEvidence> = gyros
        .into_iter()
        .filter_map(|(slot, digest)| {
            let channel = channels.get(slot)?.id.clone();
            let step_deg_h = report.channels.get(slot).and_then(|c| c.values.quantization_step);
            Some(evidence(procedure, channel, several, tau0_s, digest, step_deg_h))
        })
        .collect();
    let envelopes = overview.finish();
    let warming = channels.iter().enumerate().filter(|(_, c)| c.role == Role::Temperature);
    let range = |e: &Envelope| {
        let means = || e.bins.iter().map(|b| b.mean).filter(|m| m.is_finite());
        means().fold(f64::NEG_INFINITY, f64::max) - means().fold(f64::INFINITY, f64::min)
    };
    let warming_deg_c = warming.filter_map(|(slot, _)| envelopes.get(&slot).map(range)).fold(0.0, f64::max);
    for gyro in &mut gyros {
        gyro.motion = motion(&gyro.digest.blocks, tau0_s, gyro.digest.quietest_deg_h, warming_deg_c);
    }
    together(gyros.iter_mut().map(|g| &mut g.motion).collect());
    let has_stamps = request.use_stamps && channels.iter().any(|c| c.role == Role::Time);
    let first_stamp_s = has_stamps.then(|| plan.start_s());
    let (gyros, schedule) = thermal::examine(procedure, &channels, gyros, means.as_ref(), first_stamp_s);
    if gyros.iter().all(|g| g.digest.samples < 2) {
        return Err(RunError::Nothing(if window.usable_s > 0.0 || procedure.conditions.warm_up_s == 0.0 {
            about(request, "run_error.too_few")
        } else {
            about(request, "run_error.nothing_left")
                .with("warm_up", Arg::Stated(procedure.conditions.warm_up_s))
                .with("length", Arg::decimals(report.duration_s, 6))
        }));
    }
    settle_integrity(&mut report, &overview, tau0_s, &gyros);
    Ok(Found {
        channels,
        report,
        tau0_s,
        window,
        gyros,
        stability,
        envelopes,
        grid,
        exact,
        schedule,
        checks: CheckLog::default(),
    })
}

/// The longest gap in what was evaluated, s.
pub(super) fn longest_gap_s(window: &Window) -> f64 {
    let gaps = window.excluded.iter().filter(|s| s.reason == "gap");
    gaps.map(|s| s.to_s - s.from_s).fold(0.0, f64::max)
}

/// Lines of a channel, and its noise with the lines left out. `step_deg_h` is the step of its output.
pub(crate) fn spectral(
    channel: &str,
    digest: &RateDigest,
    tau0_s: f64,
    line_false_alarm: f64,
    step_deg_h: Option<f64>,
) -> (Vec<SpectralLine>, Identification) {
    let lines = find_lines(&digest.welch.spectrum, tau0_s, line_false_alarm).lines;
    let record = SpectralRecord {
        blocks: &digest.blocks,
        welch: Some(&digest.welch.spectrum),
        tau0_s,
        lines: &lines,
        sampling: Sampling::Averaging,
    };
    let curve = digest.octaves.as_ref().unwrap_or(&digest.deviations).curve(Estimator::Allan);
    let points: Vec<(u64, f64)> =
        curve.map(|c| c.points.iter().map(|p| (p.m, p.deviation)).collect()).unwrap_or_default();
    let rounded_above_hz = step_deg_h.and_then(|step| coarse::highest_hz(step, tau0_s, &points));
    let noise = record.identify_up_to(channel, rounded_above_hz);
    (noise.lines, noise.ranged.identification)
}

/// How well the description of a channel fits it.
fn goodness(
    digest: &RateDigest,
    lines: &[SpectralLine],
    identification: &Identification,
    octaves: &[BoundedPoint],
    tau0_s: f64,
) -> GoodnessOfFit {
    let record = SpectralRecord {
        blocks: &digest.blocks,
        welch: Some(&digest.welch.spectrum),
        tau0_s,
        lines,
        sampling: Sampling::Averaging,
    };
    let points: Vec<_> = octaves.iter().map(|p| p.point).collect();
    GoodnessOfFit::of(&record, &identification.described, &points)
}

fn evidence(
    procedure: &Procedure,
    channel: String,
    several: bool,
    tau0_s: f64,
    digest: RateDigest,
    step_deg_h: Option<f64>,
) -> GyroEvidence {
    let alarm = procedure.analysis.line_false_alarm;
    let (mut lines, mut identification) = spectral(&channel, &digest, tau0_s, alarm, step_deg_h);
    let model = &identification.described.model;
    let sigma_tau = sigma_tau::allan_points(&digest.deviations, model, tau0_s);
    let octaves = digest
        .octaves
        .as_ref()
        .map_or_else(|| sigma_tau.clone(), |set| sigma_tau::allan_points(set, model, tau0_s));
    let whole = Whole::of(&digest, &octaves, identification.highest_hz);
    let withheld_line = whole.lines(&mut lines);
    if withheld_line.is_some() {
        let kept: Vec<f64> = lines.iter().map(|l| l.frequency_hz).collect();
        identification.described.keep_lines(|line| kept.contains(&line.frequency_hz));
    }
    whole.parts(&mut identification);
    curve_check::contest(&mut identification, &octaves, tau0_s, digest.samples);
    let goodness = goodness(&digest, &lines, &identification, &octaves, tau0_s);
    let longest_stretch_s = digest.deviations.stretches.longest() as f64 * tau0_s;
    let earth = procedure.site.as_ref().map(|site| {
        let rate = site.earth_rate_along(&channel);
        Earth { rate_deg_h: rate.value, uncertainty_deg_h: rate.uncertainty }
    });
    GyroEvidence {
        channel,
        several,
        tau0_s,
        longest_stretch_s,
        digest,
        sigma_tau,
        octaves,
        identification,
        goodness,
        lines,
        withheld_line,
        motion: Motion::Unknown,
        earth,
        over_temperature: None,
        warm_up: None,
    }
}

fn measure(request: &Request<'_>, found: &Found) -> Vec<crate::record::MeasurandRecord> {
    let mut rows = Vec::new();
    for spec in &request.procedure.measurands {
        for gyro in &found.gyros {
            if spec.channel.as_ref().is_some_and(|c| *c != gyro.channel) {
                continue;
            }
            for mut estimate in spec.measurand.evaluate_gyro(gyro, &spec.options()) {
                if spec.measurand.needs_stillness && found.at_rest() && gyro.motion.is_motion() {
                    estimate = spec
                        .measurand
                        .not_identifiable(&estimate.channel, None, estimate.method)
                        .note(Note::new("note.moving"));
                }
                rows.push(verdict::row(&estimate, request.limits, request.procedure));
            }
        }
    }
    rows
}
