//! Whether a folder of results is still what was written: its hashes, its pages, its verdict, its figures, its signatures.
//!
//! Each check gives what it found. A check that was asked for and cannot be made says why: it is neither passed nor failed, and the
//! whole is no success.

mod anew;
mod finding;
mod folder;
mod pages;
mod parts;
mod pdf;
mod sheet;
mod signatures;
mod verdict;

pub use anew::{Anew, anew};
pub use finding::Finding;
pub use folder::{Folder, hashes, run_of, stated_hashes};
pub use pages::pages;
pub use parts::waits_for_recording;
pub use pdf::pdf;
pub use signatures::{Signing, required, signatures};
pub use verdict::verdict;

use crate::output::{Kind, SIGNATURES_FOLDER};
use crate::report::Renderer;

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
        Kind::Lot => findings.extend(parts::units(folder, &|unit| contents(unit, renderer))),
        Kind::DataSheet => findings.extend(sheet::sheet(folder)),
        _ => {}
    }
    findings
}
