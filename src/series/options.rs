//! How a recording is read as a series, and why it cannot be.

use crate::i18n::{Lang, Localize, Note, note};
use crate::ingest::{IngestError, ReadOptions, RecordingError};
use crate::recording::Channel;

/// How a recording is read as a series; what is left out is found from the recording.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SeriesOptions {
    /// How its files are read.
    pub read: ReadOptions,
    /// Column of the rate, by name or position counted from 1; found by its name where it is left out.
    pub rate: Option<String>,
    /// Unit of that column; found from its name where it is left out.
    pub unit: Option<String>,
    /// Take the first column that looks like an output, in whatever unit, where it is not stated which is meant: for those
    /// who need the rows and not the rate.
    pub any_rate: bool,
    /// Channels as a procedure declares them; empty: found by their names.
    pub channels: Vec<Channel>,
    /// Sample rate, Hz: needed where there are no time stamps, and of help where their rounding leaves it open.
    pub sample_rate_hz: Option<f64>,
}

/// Why a recording cannot be read as a series.
#[derive(Debug, Clone, PartialEq)]
pub enum SeriesError {
    /// It cannot be opened.
    Open(RecordingError),
    /// It cannot be read.
    Read(IngestError),
    /// Time, rate or unit is not evident from it.
    Unclear(Note),
}

impl SeriesError {
    /// The error as a note.
    pub fn note(&self) -> Note {
        match self {
            SeriesError::Open(RecordingError::File(e)) | SeriesError::Read(e) => e.note(),
            SeriesError::Open(other) => note!("system.other", reason = other.to_string()),
            SeriesError::Unclear(note) => note.clone(),
        }
    }

    /// The diagnostic as it goes to the terminal, in a language.
    pub fn say(&self, lang: Lang) -> String {
        let error = |what: String| format!("{}: {what}\n", note!("diagnostic.error").say(lang));
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
