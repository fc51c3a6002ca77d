//! The advice after a verb: one sentence and, below it, the command.

use super::place::for_shell;
use crate::config::procedure::Procedure;
use crate::i18n::{Note, note};
use crate::ingest::Source;
use std::path::{Path, PathBuf};

/// After a recording was looked at: a procedure and limits from it. `options` stand behind the recording. `None` for
/// several files, which `init` does not read.
pub fn init(recording: &[PathBuf], options: &str) -> Option<Note> {
    Some(note!("next_step.init", recording = only(recording)?, options))
}

/// After a recording was inspected: as [`init`], with the options that its columns leave open and those by which it was `read`.
/// `None` without a column that looks like a gyro output.
pub fn after_inspection(recording: &[PathBuf], source: &Source, read: &str) -> Option<Note> {
    let mut gyros = source.columns().iter().filter(|c| c.numeric).map(|c| c.inferred());
    let gyro = gyros.find(|found| found.role.is_gyro())?;
    let mut options = String::new();
    if !gyro.unit_is_named && !read.contains("--unit ") {
        options.push_str(" --unit UNIT");
    }
    if source.time_column().is_none()
        && source.stated_sample_rate_hz().is_none()
        && !read.contains("--sample-rate")
    {
        options.push_str(" --sample-rate HZ");
    }
    options.push_str(read);
    init(recording, &options)
}

/// After a unit failed at rest: where and why it differs from its model. `None` where the procedure has a model, so that
/// the report tells it, and for tests that move the unit.
pub fn after_fail(recording: &[PathBuf], procedure: &Procedure) -> Option<Note> {
    let p = procedure;
    let moved = p.rate_table.is_some() || p.repeatability_test.is_some() || p.comparison_test.is_some();
    if moved || p.explain.is_some() {
        return None;
    }
    Some(note!("next_step.explain", recording = only(recording)?))
}

/// After an effect was found.
pub fn after_effect(kind: &str) -> Note {
    note!("next_step.effect", effect = kind)
}

/// After a model was written: another recording against it.
pub fn after_model(model: &Path) -> Note {
    note!("next_step.model", model = for_shell(&model.display().to_string()))
}

/// After a recording was made: what it holds.
pub fn after_record(recording: &Path) -> Note {
    note!("next_step.record", recording = for_shell(&recording.display().to_string()))
}

/// After a test was planned: its recording, simulated.
pub fn after_plan(model: &Path, schedule: &Path) -> Note {
    note!(
        "next_step.plan",
        model = for_shell(&model.display().to_string()),
        schedule = for_shell(&schedule.display().to_string())
    )
}

/// After the demonstration.
pub fn after_demo() -> Note {
    note!("next_step.own_recording")
}

fn only(recording: &[PathBuf]) -> Option<String> {
    match recording {
        [one] => Some(for_shell(&one.display().to_string())),
        _ => None,
    }
}
