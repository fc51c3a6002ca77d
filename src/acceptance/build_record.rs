//! The run record: what every kind of test writes into it.

use super::condition::checks::none_made;
use super::condition::evidence;
use super::reading::tidy;
use super::request::{Request, RunError, session};
use super::test_kind::Reading;
use super::verdict;
use crate::config::procedure::unit_facts::unknown;
use crate::estimate::Verdict;
use crate::figure::Figure;
use crate::i18n::{Note, note};
use crate::record::{
    ClauseRecord, ColumnRecord, ConditionRecord, FaultText, FigureRecord, MeasurandRecord, OptionRecord,
    Program, RESULT_FORMAT, RecordingFile, RunRecord,
};
use std::path::Path;

/// The record of a run, with the verdict of the whole. `own_checks` are those that the kind of test adds.
pub(super) fn build_record(
    reading: &Reading<'_>,
    own_checks: &[&str],
    mut conditions: Vec<ConditionRecord>,
    rows: Vec<MeasurandRecord>,
    figures: &[Figure],
    options: Vec<(&'static str, String)>,
) -> RunRecord {
    let request = reading.request;
    let errors = errors(request);
    evidence::complete(&mut conditions, reading.has_stamps());
    let judged = verdict::whole(&rows, &conditions, &errors);
    let (verdict, summary) = verdict::with_idle_limits(judged, request.limits.idle.as_ref());
    let use_stamps = ("recording.use_stamps", request.use_stamps.to_string());
    let option = |(name, value): (&str, String)| OptionRecord { name: name.to_owned(), value };
    let files = recording(reading);
    RunRecord {
        verdict,
        summary: summary.into_iter().map(Into::into).collect(),
        bench: request.on_bench(&files).map(|on| on.record(request.bench_checks, verdict)),
        recording: files,
        conditions,
        checks: if request.is_run() { reading.checks.records(own_checks) } else { vec![] },
        integrity: reading.report.integrity.clone().with_texts(FaultText::from),
        window: reading.window.clone(),
        measurands: rows,
        options: options.into_iter().chain([use_stamps]).map(option).collect(),
        figures: figures
            .iter()
            .map(|f| FigureRecord { id: f.id.clone(), file: format!("figures/{}.svg", f.id) })
            .collect(),
        errors: errors.into_iter().map(Into::into).collect(),
        ..blank(request)
    }
}

/// The record of a run whose recording could not be evaluated.
pub(super) fn failed(request: &Request<'_>, own_checks: &[&str], error: &RunError) -> RunRecord {
    let mut errors = errors(request);
    errors.push(note!("error.not_evaluated", reason = error.note()));
    RunRecord {
        verdict: Verdict::Error,
        summary: errors.clone().into_iter().map(Into::into).collect(),
        recording: request.source.files().into_iter().map(unread).collect(),
        checks: if request.is_run() { none_made(own_checks) } else { vec![] },
        clauses: clauses(&request.procedure.clauses, "not_done"),
        errors: errors.into_iter().map(Into::into).collect(),
        ..blank(request)
    }
}

/// Clauses of a test that was not carried out as a whole.
pub(super) fn clauses(declared: &[ClauseRecord], here: &str) -> Vec<ClauseRecord> {
    let of = |c: &ClauseRecord| {
        let status = if c.is_here() { here.to_owned() } else { c.status.clone() };
        ClauseRecord { status, ..c.clone() }
    };
    declared.iter().map(of).collect()
}

fn errors(request: &Request<'_>) -> Vec<Note> {
    let asked = &request.procedure.unit_under_test;
    if request.is_run() { unknown(&request.unit, asked.serial_required, &asked.requires) } else { vec![] }
}

/// The record with what is known before the recording is read.
fn blank(request: &Request<'_>) -> RunRecord {
    let procedure = request.procedure;
    let today = request.now.date_naive();
    let serial = request.unit.serial.as_deref();
    RunRecord {
        format: RESULT_FORMAT.to_owned(),
        program: Program::this(),
        kind: request.kind,
        procedure: request.procedure_record.clone(),
        unit_under_test: request.unit.clone(),
        session: session(request),
        instruments: procedure.instruments.iter().map(|i| i.record_on(today)).collect(),
        waivers: procedure.waivers_for(serial),
        exclusions: procedure.exclusions.clone(),
        clauses: procedure.clauses.clone(),
        ..RunRecord::default()
    }
}

/// A file of a recording that was not evaluated.
fn unread(path: &Path) -> RecordingFile {
    RecordingFile {
        path: path.display().to_string(),
        sha256: crate::ingest::byte_stream::digest(path).map(|d| d.sha256).unwrap_or_default(),
        bytes: std::fs::metadata(path).map_or(0, |m| m.len()),
        ..RecordingFile::default()
    }
}

/// The files of the recording.
pub(super) fn recording(reading: &Reading<'_>) -> Vec<RecordingFile> {
    let report = &reading.report;
    let several = report.files.len() > 1;
    let columns: Vec<ColumnRecord> = report
        .channels
        .iter()
        .map(|c| ColumnRecord {
            name: c.column.clone(),
            channel: c.id.clone(),
            role: c.role,
            unit: c.unit.clone(),
        })
        .collect();
    let used = |m: Option<f64>| m.filter(|_| reading.request.use_stamps).filter(|v| v.is_finite());
    report
        .files
        .iter()
        .map(|f| RecordingFile {
            path: f.path.display().to_string(),
            sha256: f.facts.sha256.clone(),
            bytes: f.facts.bytes,
            samples: f.facts.rows,
            sample_interval_s: if several { tidy(f.sample_interval_s) } else { reading.tau0_s },
            sample_interval_uncertainty_s: used(report.clock.map(|c| c.uncertainty_s)),
            clock_drift_ppm: used(report.clock.and_then(|c| c.drift)).map(|d| d * 1e6),
            phase: f.phase.clone(),
            start: f.start.clone(),
            duration_s: f.duration_s,
            columns: columns.clone(),
        })
        .collect()
}
