//! Why a recording could not be read: one diagnostic that says where, what was found and what to do.

use sagnac_core::message::{Note, note};
use sagnac_core::visible::steers;
use std::fmt;
use std::path::{Path, PathBuf};

/// The kind of the error, for programs that handle kinds differently.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IngestErrorKind {
    /// The file cannot be opened or read.
    Io,
    /// The file is of a kind that is not read here.
    UnknownFormat,
    /// The file has no rows.
    Empty,
    /// The compressed data are damaged or end early.
    Damaged,
    /// The compressed data unpack to far more than a recording could.
    Bomb,
    /// The file changed while it was read.
    Changed,
    /// A column that was asked for is not there, or its name is not unique.
    Column,
    /// Most fields of a wanted column are no numbers, or most rows have the wrong number of fields.
    NotNumeric,
    /// The time stamps cannot serve as a time base, or there is none.
    TimeBase,
    /// A channel's unit does not fit its role.
    Unit,
    /// The files of a recording do not belong together.
    Parts,
    /// The layout of a raw binary file is missing, broken, or does not fit it.
    Layout,
}

#[derive(Debug, Clone, PartialEq)]
struct Details {
    kind: IngestErrorKind,
    path: PathBuf,
    line: Option<u64>,
    column: Option<u64>,
    text: Option<String>,
    message: Note,
    hint: Option<Note>,
}

/// Why a recording could not be read: a diagnostic with its place, the text found there and advice.
#[derive(Debug, Clone, PartialEq)]
pub struct IngestError(Box<Details>);

/// Longest piece of a file that is quoted in a diagnostic, characters.
const QUOTED: usize = 40;

impl IngestError {
    /// An error of a file as a whole. The message, a note or the key of one without arguments, is a fragment that says
    /// what is wrong.
    pub fn new(kind: IngestErrorKind, path: &Path, message: impl Into<Note>) -> IngestError {
        IngestError(Box::new(Details {
            kind,
            path: path.to_owned(),
            line: None,
            column: None,
            text: None,
            message: message.into(),
            hint: None,
        }))
    }

    /// Adds the place: line and column in the unpacked text, both counted from 1.
    #[must_use]
    pub fn at(mut self, line: u64, column: Option<u64>) -> IngestError {
        self.0.line = Some(line);
        self.0.column = column;
        self
    }

    /// Adds the text found there.
    #[must_use]
    pub fn found(mut self, text: &str) -> IngestError {
        self.0.text = Some(shorten(text));
        self
    }

    /// Adds what to do.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<Note>) -> IngestError {
        self.0.hint = Some(hint.into());
        self
    }

    /// The kind of the error, for programs that handle kinds differently.
    pub fn kind(&self) -> IngestErrorKind {
        self.0.kind
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.0.path
    }

    /// Line, counted from 1.
    pub fn line(&self) -> Option<u64> {
        self.0.line
    }

    /// Column of the line in characters, counted from 1.
    pub fn column(&self) -> Option<u64> {
        self.0.column
    }

    /// The offending text.
    pub fn text(&self) -> Option<&str> {
        self.0.text.as_deref()
    }

    /// The fault, without place and hint.
    pub fn message(&self) -> &Note {
        &self.0.message
    }

    /// What to do.
    pub fn advice(&self) -> Option<&Note> {
        self.0.hint.as_ref()
    }

    /// The whole diagnostic as a note: place, what is wrong, what was found, what to do.
    pub fn note(&self) -> Note {
        let d = &self.0;
        let mut place = d.path.display().to_string();
        if let Some(line) = d.line {
            place.push_str(&format!(":{line}"));
            if let Some(column) = d.column {
                place.push_str(&format!(":{column}"));
            }
        }
        let key = match (&d.text, &d.hint) {
            (None, None) => "ingest_error.plain",
            (Some(_), None) => "ingest_error.found",
            (None, Some(_)) => "ingest_error.hint",
            (Some(_), Some(_)) => "ingest_error.found_hint",
        };
        let mut note = Note::new(key).with("place", place).with("message", d.message.clone());
        if let Some(text) = &d.text {
            note = note.with("found", note!("ingest.found", text = text.as_str()));
        }
        if let Some(hint) = &d.hint {
            note = note.with("hint", hint.clone());
        }
        note
    }
}

impl fmt::Display for IngestError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.note().plain())
    }
}

impl std::error::Error for IngestError {}

/// Cuts a text that is quoted, and makes control characters visible.
pub(crate) fn shorten(text: &str) -> String {
    let clean: String = text.chars().take(QUOTED).map(|c| if steers(c) { '\u{fffd}' } else { c }).collect();
    if text.chars().nth(QUOTED).is_some() { clean + "…" } else { clean }
}
