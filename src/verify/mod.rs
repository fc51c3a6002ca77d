//! Whether a folder of results is still what was written: its hashes, its pages, its verdict, its figures.
//!
//! Each check gives what it found. A check that cannot be made says why: it is neither passed nor failed.

mod folder;
mod pages;
mod pdf;
mod verdict;

pub use folder::{Folder, hashes, stated_hashes};
pub use pages::pages;
pub use pdf::pdf;
pub use verdict::verdict;

use crate::i18n::Note;

/// What a check found.
#[derive(Debug, Clone, PartialEq)]
pub enum Finding {
    /// Something is as it was written.
    Agrees(Note),
    /// Something is not.
    Differs(Note),
    /// Something could not be checked, or must be known.
    Unchecked(Note),
}

impl Finding {
    /// True for something that is not as it was written.
    pub fn differs(&self) -> bool {
        matches!(self, Finding::Differs(_))
    }
}
