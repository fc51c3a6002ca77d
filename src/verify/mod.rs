//! Whether a folder of results is still what was written: its hashes, its pages, its verdict, its figures, its signatures.
//!
//! Each check gives what it found. A check that was asked for and cannot be made says why: it is neither passed nor failed, and the
//! whole is no success.

mod anew;
mod folder;
mod pages;
mod parts;
mod pdf;
mod sheet;
mod signatures;
mod verdict;

pub use anew::{Anew, anew};
pub use folder::{Folder, hashes, stated_hashes};
pub use pages::pages;
pub use parts::waits_for_recording;
pub use pdf::pdf;
pub use signatures::{Signing, required, signatures};
pub use verdict::verdict;

use crate::i18n::Note;
use crate::output::{Kind, SIGNATURES_FOLDER};
use crate::record::{self, RunRecord};
use crate::report::Renderer;

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

    /// What was found.
    pub fn note(&self) -> &Note {
        match self {
            Finding::Agrees(note)
            | Finding::Differs(note)
            | Finding::Undone(note)
            | Finding::Unchecked(note) => note,
        }
    }
}

/// The record of a run or an analysis that a folder holds.
pub fn run_of(folder: &Folder) -> Option<RunRecord> {
    match folder.kind {
        Kind::Result => record::read::open(&folder.record_file()).ok(),
        _ => None,
    }
}

/// Every check that needs nothing but the folder, its signatures aside: hashes, pages, texts, verdicts, and the units of a lot.
pub fn contents(folder: &Folder, renderer: &Renderer) -> Vec<Finding> {
    let mut findings = hashes(folder, SIGNATURES_FOLDER);
    findings.extend(pages(folder, renderer));
    if let Some(run) = run_of(folder) {
        findings.extend(verdict(&run));
        findings.extend(folder::texts(&folder.path, &run));
        findings.extend(parts::phases(folder, &run));
    }
    match folder.kind {
        Kind::Lot => findings.extend(parts::units(folder, renderer)),
        Kind::DataSheet => findings.extend(sheet::sheet(folder)),
        _ => {}
    }
    findings
}
