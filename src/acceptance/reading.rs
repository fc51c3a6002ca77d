//! How a run reads a recording: which channels and rows, by which clock, and what of its integrity is the recording's own.

use super::request::{Request, RunError};
use super::sinks::Overview;
use super::test_kind::Reading;
use crate::config::procedure::Procedure;
use crate::ingest::{Pauses, Plan, Source, StreamReport, TimeBaseSpec, locate, prepare};
use crate::record::Window;
use crate::recording::integrity::{Fault, Integrity};
use crate::recording::window::{TimeSpan, WindowSpec};
use crate::recording::{Channel, Role, Sink};

/// How the channels of a procedure are read.
///
/// # Errors
/// [`RunError::Nothing`] without a gyro among them; what keeps the recording from being read.
pub(super) fn plan<'a>(
    request: &Request<'a>,
    channels: &'a [Channel],
    pauses: Pauses,
) -> Result<Plan<'a>, RunError> {
    let procedure = request.procedure;
    if !channels.iter().any(|c| c.role.is_gyro()) {
        return Err(RunError::Nothing(request.about("run_error.no_gyro")));
    }
    let declared = |role: Role| procedure.channels.iter().find(|c| c.channel.role == role)?.rollover;
    let spec = TimeBaseSpec {
        declared_sample_rate_hz: procedure.sample_rate_hz,
        use_stamps: request.use_stamps,
        rollover_s: declared(Role::Time),
        counter_modulus: declared(Role::Counter),
    };
    let mut plan = prepare(request.source, channels, spec)?;
    plan.set_pauses(pauses);
    for c in &procedure.channels {
        if let Some(period) = c.rollover {
            plan.set_angle_period(&c.channel.id, period);
        }
    }
    Ok(plan)
}

/// Reads a recording once more, for a quantity that one pass cannot give.
///
/// # Errors
/// Those of reading.
pub(super) fn read_again(
    reading: &Reading<'_>,
    sink: &mut dyn Sink,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<(), RunError> {
    let mut plan = plan(reading.request, &reading.channels, reading.pauses)?;
    if plan.reads_angles() {
        plan.set_increment_interval(reading.report.tau0_measured_s);
    }
    plan.stream(&mut [sink], progress)?;
    Ok(())
}

/// Marks the gaps that are pauses of the test.
pub(super) fn name_pauses(window: &mut Window, report: &StreamReport) {
    let is_pause =
        |to_s: f64| report.pauses_end_s.iter().any(|end| (end - to_s).abs() < 1e-9 * end.abs().max(1.0));
    for span in window.excluded.iter_mut().filter(|s| s.reason == "gap") {
        if is_pause(span.to_s) {
            span.reason = "pause".to_owned();
        }
    }
}

/// The part of the recording that a procedure evaluates.
pub(super) fn window(procedure: &Procedure) -> WindowSpec {
    WindowSpec {
        from_s: procedure.conditions.warm_up_s,
        to_s: procedure
            .interim
            .as_ref()
            .and_then(|plan| Some(procedure.conditions.warm_up_s + plan.evaluated_s()?)),
        exclusions: procedure
            .exclusions
            .iter()
            .map(|e| TimeSpan { from_s: e.from_s, to_s: e.to_s })
            .collect(),
    }
}

/// Samples that were read, and faults met on the way.
type Read<T> = Result<(T, StreamReport), RunError>;

/// Reads a recording once, or twice where it holds angles.
///
/// Rates from angles are divided by the interval of the first rows; where the whole recording measures another one, they
/// are made again with that.
///
/// # Errors
/// Those of reading.
pub(super) fn read_at_measured_interval<'a, T>(
    plan: &mut Plan<'a>,
    read: &mut dyn FnMut(&Plan<'a>) -> Read<T>,
) -> Read<T> {
    let nominal_s = plan.clock().interval_s;
    let found = read(plan)?;
    let measured_s = found.1.tau0_measured_s;
    if !plan.reads_angles() || (measured_s / nominal_s - 1.0).abs() <= 1e-6 {
        return Ok(found);
    }
    plan.set_increment_interval(measured_s);
    read(plan)
}

/// Enters saturation at declared rails, and leaves out what is rounding of the file and not a property of the recording.
/// `noise_deg_h` is the standard deviation of the quietest channel.
pub(super) fn settle_integrity(
    report: &mut StreamReport,
    overview: &Overview,
    tau0_s: f64,
    noise_deg_h: Option<f64>,
) {
    let mut saturated = overview.saturated();
    saturated.iter_mut().for_each(|f| locate(&report.files, f));
    let integrity = &mut report.integrity;
    declare_rails(integrity, saturated);
    integrity.timestamp_jitter_s =
        integrity.timestamp_jitter_s.map(|j| if j < 1e-7 * tau0_s { 0.0 } else { j });
    // A lattice far finer than the noise is the number of decimals in the file.
    let coarse = |q: &f64| noise_deg_h.is_some_and(|noise| *q > 0.01 * noise);
    integrity.quantization_step_deg_h = integrity.quantization_step_deg_h.filter(coarse);
}

/// Saturation at declared rails takes the place of what was guessed for the same channel.
fn declare_rails(integrity: &mut Integrity, declared: Vec<Fault>) {
    for fault in declared {
        let same = |f: &Fault| f.kind == fault.kind && f.channel == fault.channel;
        let guessed: u64 = integrity.faults.iter().filter(|f| same(f)).map(|f| f.count).sum();
        integrity.faults.retain(|f| !same(f));
        integrity.saturated = integrity.saturated.saturating_sub(guessed) + fault.count;
        integrity.faults.push(fault);
    }
}

/// A measured interval without the rounding of its last digits: 0.001 and not 0.00100000000003.
pub(crate) fn tidy(interval_s: f64) -> f64 {
    format!("{interval_s:.9e}").parse().unwrap_or(interval_s)
}

/// The channels to read: those of the procedure, without optional ones that the file lacks.
pub(super) fn channels(procedure: &Procedure, source: &Source) -> Vec<Channel> {
    procedure
        .channels
        .iter()
        .filter(|c| c.required || source.resolve(&c.channel.column).is_ok())
        .map(|c| c.channel.clone())
        .collect()
}
