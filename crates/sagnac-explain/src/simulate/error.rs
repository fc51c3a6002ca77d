//! Why a claim cannot be simulated.

use crate::message::Note;
use std::fmt;

/// Why a claim cannot be simulated.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulateError(pub Note);

impl SimulateError {
    /// The reason.
    pub fn note(&self) -> &Note {
        &self.0
    }
}

impl fmt::Display for SimulateError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.plain())
    }
}

impl std::error::Error for SimulateError {}

impl From<Note> for SimulateError {
    fn from(note: Note) -> Self {
        SimulateError(note)
    }
}
