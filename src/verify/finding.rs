//! What a check found.

use crate::i18n::Note;

/// What a check found.
#[derive(Debug, Clone, PartialEq)]
pub enum Finding {
    /// Something is as it was written.
    Agrees(Note),
    /// Something is not.
    Differs(Note),
    /// A check that was asked for could not be made.
    Undone(Note),
    /// Something was not asked for, or must be known.
    Unchecked(Note),
}

impl Finding {
    /// True for something that is not as it was written.
    pub fn differs(&self) -> bool {
        matches!(self, Finding::Differs(_))
    }

    /// The finding as a note.
    pub fn note(&self) -> &Note {
        match self {
            Finding::Agrees(note)
            | Finding::Differs(note)
            | Finding::Undone(note)
            | Finding::Unchecked(note) => note,
        }
    }
}
