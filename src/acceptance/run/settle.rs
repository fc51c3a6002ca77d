//! Puts everything that was found into the run record.

use super::evaluate::Found;
use super::{Request, RunError, described, goodness, session, sigma_tau, verdict};
use crate::acceptance::condition::checks::{Kind, none_made};
use crate::acceptance::condition::evidence;
use crate::estimate::Verdict;
use crate::figure::Figure;
use crate::i18n::Note;
use crate::measurand::GyroEvidence;
use crate::record::{
    ClauseRecord, ColumnRecord, ConditionRecord, FigureRecord, Integrity, LineRecord, MeasurandRecord,
    NoiseModelRecord, OptionRecord, PowerRecord, Program, RESULT_FORMAT, RecordingFile, RunKind, RunRecord,
    Window,
};
use crate::recording::Role;
use crate::temperature::start::Start;
use std::path::Path;

pub(super) fn record(
    request: &Request<'_>,
    found: &Found,
    mut conditions: Vec<ConditionRecord>,
    rows: Vec<MeasurandRecord>,
    power: Vec<PowerRecord>,
    figures: &[Figure],
) -> RunRecord {
    let errors = errors(request);
    let rows = super::unshown::complete(request, &found.channels, rows);
    let has_stamps = request.use_stamps && found.channels.iter().any(|c| c.role == Role::Time);
    evidence::complete(&mut conditions, has_stamps);
    let judged = verdict::whole(&rows, &conditions, &errors);
    let (verdict, mut summary) = verdict::with_idle_limits(judged, request.limits.idle.as_ref());
    let declared = |g: &GyroEvidence| g.warm_up.as_ref().is_some_and(|w| w.start == Start::Declared);
    if errors.is_empty() && verdict != Verdict::None && found.gyros.iter().any(declared) {
        summary.push(Note::new("summary.start_declared"));
    }
    // What is said of noise at rest has no meaning while the temperature moves.
    let resting = || found.gyros.iter().filter(|_| found.at_rest());
    let still = || resting().filter(|g| !g.motion.is_motion());
    RunRecord {
        verdict,
        summary: summary.into_iter().map(Into::into).collect(),
        recording: recording(request, found),
        conditions,
        checks: if request.kind == RunKind::Run {
            found.checks.settle(Kind::of(request.procedure))
        } else {
            vec![]
        },
        integrity: found.report.integrity.clone().into(),
        window: found.window.clone(),
        measurands: rows,
        lines: resting().flat_map(lines).collect(),
        noise_models: still().map(noise_model).collect(),
        goodness_of_fit: still().flat_map(goodness::records).collect(),
        deviations: resting().flat_map(sigma_tau::records).collect(),
        comparison: still().filter_map(super::comparison::record).collect(),
        explained: None,
        power,
        options: options(request, found),
        figures: figures
            .iter()
            .map(|f| FigureRecord { id: f.id.clone(), file: format!("figures/{}.svg", f.id) })
            .collect(),
        errors: errors.into_iter().map(Into::into).collect(),
        ..blank(request)
    }
}

pub(super) fn failed(request: &Request<'_>, error: &RunError) -> RunRecord {
    let mut errors = errors(request);
    errors.push(Note::new("error.not_evaluated").with("reason", error.note()));
    RunRecord {
        verdict: Verdict::Error,
        summary: errors.clone().into_iter().map(Into::into).collect(),
        recording: request.source.files().into_iter().map(unread).collect(),
        checks: if request.kind == RunKind::Run { none_made(Kind::of(request.procedure)) } else { vec![] },
        clauses: clauses(&request.procedure.clauses, "not_done"),
        errors: errors.into_iter().map(Into::into).collect(),
        ..blank(request)
    }
}

/// Clauses of a test that was not carried out as a whole.
pub(super) fn clauses(declared: &[ClauseRecord], here: &str) -> Vec<ClauseRecord> {
    let of = |c: &ClauseRecord| {
        let status = if c.status == "here" { here.to_owned() } else { c.status.clone() };
        ClauseRecord { status, ..c.clone() }
    };
    declared.iter().map(of).collect()
}

fn errors(request: &Request<'_>) -> Vec<Note> {
    let serial = request.unit.serial.as_deref().map(str::trim).filter(|s| !s.is_empty());
    if request.procedure.unit_under_test.serial_required && request.kind == RunKind::Run && serial.is_none() {
        return vec![Note::new("error.serial_missing")];
    }
    vec![]
}

/// The record with what is known before the recording is read.
fn blank(request: &Request<'_>) -> RunRecord {
    let procedure = request.procedure;
    let today = request.now.date_naive();
    let serial = request.unit.serial.as_deref();
    RunRecord {
        format: RESULT_FORMAT.to_owned(),
        program: Program { name: "sagnac".to_owned(), version: env!("CARGO_PKG_VERSION").to_owned() },
        kind: request.kind,
        procedure: request.procedure_record.clone(),
        unit_under_test: request.unit.clone(),
        session: session(request),
        recording: vec![],
        verdict: Verdict::None,
        summary: vec![],
        conditions: vec![],
        checks: vec![],
        integrity: Integrity::default(),
        window: Window::default(),
        measurands: vec![],
        lines: vec![],
        noise_models: vec![],
        goodness_of_fit: vec![],
        deviations: vec![],
        table_steps: vec![],
        interval_means: vec![],
        phases: vec![],
        comparison: vec![],
        explained: None,
        power: vec![],
        instruments: procedure.instruments.iter().map(|i| i.record_on(today)).collect(),
        waivers: procedure.waivers_for(serial),
        clauses: procedure.clauses.clone(),
        options: vec![],
        figures: vec![],
        errors: vec![],
    }
}

/// A file of a recording that was not evaluated.
fn unread(path: &Path) -> RecordingFile {
    RecordingFile {
        path: path.display().to_string(),
        sha256: crate::ingest::byte_stream::digest(path).map(|d| d.sha256).unwrap_or_default(),
        bytes: std::fs::metadata(path).map_or(0, |m| m.len()),
        samples: 0,
        sample_interval_s: 0.0,
        sample_interval_uncertainty_s: None,
        clock_drift_ppm: None,
        phase: None,
        start: None,
        duration_s: 0.0,
        columns: vec![],
    }
}

/// The files of the recording.
fn recording(request: &Request<'_>, found: &Found) -> Vec<RecordingFile> {
    let report = &found.report;
    let several = report.files.len() > 1;
    let columns: Vec<ColumnRecord> = report
        .channels
        .iter()
        .map(|c| ColumnRecord {
            name: c.column.clone(),
            channel: c.id.clone(),
            role: c.role.id().to_owned(),
            unit: c.unit.clone(),
        })
        .collect();
    let used = |m: Option<f64>| m.filter(|_| request.use_stamps).filter(|v| v.is_finite());
    report
        .files
        .iter()
        .map(|f| RecordingFile {
            path: f.path.display().to_string(),
            sha256: f.facts.sha256.clone(),
            bytes: f.facts.bytes,
            samples: f.facts.rows,
            sample_interval_s: if several { super::reading::tidy(f.sample_interval_s) } else { found.tau0_s },
            sample_interval_uncertainty_s: used(report.clock.map(|c| c.uncertainty_s)),
            clock_drift_ppm: used(report.clock.and_then(|c| c.drift)).map(|d| d * 1e6),
            phase: f.phase.clone(),
            start: f.start.clone(),
            duration_s: f.duration_s,
            columns: columns.clone(),
        })
        .collect()
}

fn lines(gyro: &GyroEvidence) -> Vec<LineRecord> {
    gyro.lines
        .iter()
        .map(|l| LineRecord {
            channel: gyro.channel.clone(),
            frequency_hz: l.frequency_hz,
            resolution_hz: l.resolution_hz,
            amplitude_deg_h: l.amplitude_deg_h,
            excess: l.excess,
            false_alarm_probability: l.false_alarm_probability,
        })
        .collect()
}

fn noise_model(gyro: &GyroEvidence) -> NoiseModelRecord {
    let id = &gyro.identification;
    let model = &id.supported;
    NoiseModelRecord {
        channel: gyro.channel.clone(),
        method: id.method.to_owned(),
        terms: id.claimed.iter().map(|t| t.id().to_owned()).collect(),
        angle_random_walk: model.n,
        bias_instability: model.b,
        rate_random_walk: model.k,
        rate_ramp: model.r,
        quantization: model.q,
        misfit: id.misfit.per_dof,
        misfit_probability: id.misfit.probability,
        misfit_band_hz: id.misfit.worst_band_hz.filter(|_| id.misfit.worst_probability < 0.01),
        markov: id.described.model.markov.iter().map(|d| [d.rms_deg_h, d.decay_time_s]).collect(),
        quasi_periodic: id
            .described
            .model
            .quasi_periodic
            .iter()
            .map(|d| [d.rms_deg_h, d.frequency_hz, d.decay_time_s])
            .collect(),
        cutoff_hz: id.cutoff.as_ref().and_then(|c| c.value),
        remarks: described::remarks(gyro).into_iter().map(Into::into).collect(),
    }
}

fn options(request: &Request<'_>, found: &Found) -> Vec<OptionRecord> {
    let procedure = request.procedure;
    let option = |name: &str, value: String| OptionRecord { name: name.to_owned(), value };
    if let Some(setup) = &procedure.rate_table {
        return super::table::options(procedure, setup, request.use_stamps);
    }
    let of_influence = super::influence::options(procedure);
    if !of_influence.is_empty() {
        let usual = [option("recording.use_stamps", request.use_stamps.to_string())];
        return of_influence.into_iter().chain(usual).collect();
    }
    vec![
        option("analysis.taus", describe_grid(&found.grid)),
        option("analysis.exact", found.exact.to_string()),
        option("analysis.line_false_alarm", procedure.analysis.line_false_alarm.to_string()),
        option("conditions.warm_up", format!("{} s", procedure.conditions.warm_up_s)),
        option("recording.use_stamps", request.use_stamps.to_string()),
    ]
}

fn describe_grid(grid: &crate::noise::tau_grid::TauGrid) -> String {
    use crate::noise::tau_grid::TauGrid;
    match grid {
        TauGrid::Octave => "octave".into(),
        TauGrid::Decade => "decade".into(),
        TauGrid::All => "all".into(),
        TauGrid::List(taus) => {
            let taus: Vec<String> = taus.iter().map(|t| format!("{t} s")).collect();
            taus.join(", ")
        }
    }
}
