//! A recording as a whole, in the units of the contract of explanations: time, rate, and the columns beside them.
//!
//! Acceptance never holds a recording; an explanation looks at it many times and does.

mod choose;
mod collect;
mod smooth;

pub use collect::load_series;
pub use smooth::smooth;

use crate::effect::Column;
use crate::ingest::{IngestError, ReadOptions, RecordingError};
use crate::record::Integrity;
use crate::recording::Channel;
use crate::text::{Lang, Note};
use std::collections::BTreeMap;

/// What the user decides about a recording; the rest is found from it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SeriesOptions {
    /// How its files are read.
    pub read: ReadOptions,
    /// Column of the rate, by name or position counted from 1; found by its name where it is left out.
    pub rate: Option<String>,
    /// Unit of that column; found from its name where it is left out.
    pub unit: Option<String>,
    /// Take the first column that looks like an output, in whatever unit, where it is not told which is meant: for those
    /// who need the rows and not the rate.
    pub any_rate: bool,
    /// Channels as a procedure declares them; empty: found by their names.
    pub channels: Vec<Channel>,
    /// Sample rate, Hz: needed where there are no time stamps, and of help where their rounding leaves it open.
    pub sample_rate_hz: Option<f64>,
}

/// A recording: every row that can be used, in order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Series {
    /// Time of each row, s, on the recording's own scale.
    pub time_s: Vec<f64>,
    /// Output of the gyro, deg/h.
    pub rate_deg_h: Vec<f64>,
    /// The columns beside, in the units that their names tell, a value a row.
    pub columns: BTreeMap<Column, Vec<f64>>,
    /// Position of each row on the uniform grid of the recording, 0 for the first; where samples are missing,
    /// positions are skipped.
    pub index: Vec<u64>,
    /// What was left out or mended.
    pub faults: Faults,
    /// Which column of the file each quantity was read from.
    pub read_from: Vec<ReadFrom>,
    /// Mean sample interval over the unbroken stretches, s.
    pub sample_interval_s: f64,
    /// SHA-256 of the file, hexadecimal; empty for a recording in memory.
    pub sha256: String,
    /// What must be known of the recording.
    pub notes: Vec<Note>,
}

/// Rows that were left out, and values that were mended. Nothing is left out that is not counted here.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Faults {
    /// Rows of the file.
    pub rows: usize,
    /// Rows left out because their time cannot be used: unreadable, repeated, or out of order.
    pub without_time: usize,
    /// Rows left out because their rate is no finite number.
    pub without_rate: usize,
    /// Samples missing between rows.
    pub missing: usize,
    /// Values of the columns beside that are no finite numbers; they were interpolated between their neighbours.
    pub interpolated: BTreeMap<Column, usize>,
    /// Everything that was found, fault by fault.
    pub integrity: Integrity,
}

impl Series {
    /// What must be known of the recording: what was found about it, and the rows that were left out or mended.
    pub fn remarks(&self) -> Vec<Note> {
        let mut out = self.notes.clone();
        let faults = &self.faults;
        for (key, count) in [
            ("explain.note.without_time", faults.without_time),
            ("explain.note.without_rate", faults.without_rate),
        ] {
            if count > 0 {
                out.push(Note::new(key).with("count", count));
            }
        }
        for (column, count) in &faults.interpolated {
            out.push(Note::new("explain.note.mended").with("count", *count).with("column", column.name()));
        }
        out
    }
}

/// Where a quantity was read from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReadFrom {
    /// Name of the contract, `time_s`, `rate_deg_h`, or that of a column beside.
    pub name: &'static str,
    /// Column of the file.
    pub column: String,
    /// Unit in the file.
    pub unit: String,
}

/// Why a recording cannot be taken.
#[derive(Debug, Clone, PartialEq)]
pub enum SeriesError {
    /// It cannot be opened.
    Open(RecordingError),
    /// It cannot be read.
    Read(IngestError),
    /// It does not say what is needed of it.
    Unclear(Note),
}

impl SeriesError {
    /// What is wrong, as a note.
    pub fn note(&self) -> Note {
        match self {
            SeriesError::Open(RecordingError::File(e)) | SeriesError::Read(e) => e.note(),
            SeriesError::Open(other) => Note::new("system.other").with("reason", other.to_string()),
            SeriesError::Unclear(note) => note.clone(),
        }
    }

    /// The diagnostic as it goes to the terminal, in a language.
    pub fn say(&self, lang: Lang) -> String {
        let error = |what: String| format!("{}: {what}\n", Note::new("diagnostic.error").say(lang));
        match self {
            SeriesError::Open(e) => e.say(lang),
            SeriesError::Read(e) => error(e.say(lang)),
            SeriesError::Unclear(note) => error(note.say(lang)),
        }
    }
}

impl std::fmt::Display for SeriesError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.say(Lang::En).trim_end())
    }
}

impl std::error::Error for SeriesError {}

impl From<RecordingError> for SeriesError {
    fn from(e: RecordingError) -> Self {
        SeriesError::Open(e)
    }
}

impl From<IngestError> for SeriesError {
    fn from(e: IngestError) -> Self {
        SeriesError::Read(e)
    }
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
