//! The two results, and what was evaluated for their comparison.

use crate::config::procedure::site::Site;
use crate::i18n::Note;
use crate::record::{InstrumentRecord, MeasurandRecord, RunRecord};
use serde::{Deserialize, Serialize};

/// A result that is compared.
pub struct Given<'a> {
    /// Name of its folder.
    pub name: &'a str,
    /// File or folder as given.
    pub path: &'a str,
    /// The result.
    pub record: &'a RunRecord,
    /// The site of its procedure, where that is known.
    pub site: Option<Site>,
}

/// What was evaluated for the comparison.
#[derive(Default)]
pub struct Evaluated {
    /// The recording of the first result under the procedure of the second.
    pub first_by_second: Option<RunRecord>,
    /// The recording of the second result under the procedure of the first.
    pub second_by_first: Option<RunRecord>,
    /// Which of the two recordings is the longer one, from 0, and its beginning, as long as the other recording, under its own
    /// procedure.
    pub shortened: Option<(usize, RunRecord)>,
    /// Keys of the procedures that differ, by their names.
    pub differing_keys: Vec<String>,
    /// What could not be evaluated, and why.
    pub missing: Vec<Note>,
}

/// One of the two results.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Side {
    /// Name of its folder.
    pub name: String,
    /// File or folder as given.
    pub path: String,
    /// Id and revision of its procedure; absent for an analysis without one.
    pub procedure: Option<String>,
    /// SHA-256 of the files of its recording.
    pub recording_sha256: Vec<String>,
    /// Usable time, s.
    pub usable_s: f64,
    /// Interval of the samples, s.
    pub sample_interval_s: Option<f64>,
    /// Mean temperature, degC, where a condition observed it.
    pub temperature_deg_c: Option<f64>,
    /// Instruments, by name and serial number.
    pub instruments: Vec<String>,
}

impl Side {
    pub(super) fn of(given: &Given<'_>) -> Side {
        let record = given.record;
        let procedure = record.procedure.as_ref().map(|p| format!("{} {}", p.id, p.revision));
        let instrument = |i: &InstrumentRecord| match &i.serial {
            Some(serial) => format!("{} {serial}", i.name.text()),
            None => i.name.text().to_owned(),
        };
        Side {
            name: given.name.to_owned(),
            path: given.path.to_owned(),
            procedure,
            recording_sha256: record.recording.iter().map(|f| f.sha256.clone()).collect(),
            usable_s: record.window.usable_s,
            sample_interval_s: record.recording.first().map(|f| f.sample_interval_s).filter(|t| *t > 0.0),
            temperature_deg_c: temperature(record),
            instruments: record.instruments.iter().map(instrument).collect(),
        }
    }
}

/// The mean temperature that a condition observed, degC.
fn temperature(record: &RunRecord) -> Option<f64> {
    let conditions = record.conditions.iter().filter(|c| c.id.split('.').next() == Some("temperature"));
    conditions.filter_map(|c| c.observed.get("mean")?.as_f64()).next()
}

/// True for rows of one quantity of one channel in one phase.
pub(super) fn same_row(a: &MeasurandRecord, b: &MeasurandRecord) -> bool {
    (&a.id, &a.channel, &a.phase) == (&b.id, &b.channel, &b.phase) && a.unit == b.unit
}
