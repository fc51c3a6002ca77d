//! Layouts of raw binary records: read from TOML before a recording is opened by them.

mod read;
pub mod tables;

pub use read::{load, parse};

use crate::config::diagnostics::Problems;
use crate::i18n::note;
pub use sagnac_ingest::layout::{Layout, LayoutFile};
use sagnac_ingest::{IngestError, IngestErrorKind};
use std::path::Path;

/// The diagnostic of a layout that cannot be used: its first problem, and how many there are.
pub(crate) fn refused(path: &Path, problems: &Problems) -> IngestError {
    let Some(first) = problems.list.first() else {
        return IngestError::new(IngestErrorKind::Layout, path, "ingest.raw.hint.check_layout");
    };
    let more = problems.list.len() - 1;
    let note = match more {
        0 => note!("ingest.raw.problem"),
        _ => note!("ingest.raw.problems", more),
    };
    let mut error =
        IngestError::new(IngestErrorKind::Layout, path, note.with("problem", first.message.clone()));
    if first.line > 0 {
        error = error.at(first.line as u64, Some(first.column as u64));
    }
    if !first.token.is_empty() {
        error = error.found(&first.token);
    }
    match &first.help {
        Some(help) => error.hint(note!("ingest.raw.hint.help", help = help.clone())),
        None => error,
    }
}
