//! What can be wrong in a store.

use crate::i18n::{Arg, Note};
use std::path::{Path, PathBuf};

/// Something wrong in a store.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Finding {
    /// The files of a result are not those that its address was made from.
    Changed {
        /// The folder.
        path: PathBuf,
        /// The address that its files have now.
        found: String,
    },
    /// A statement is not what its name was made from, or none.
    Statement(PathBuf),
    /// A result cannot be read.
    Unreadable {
        /// The folder.
        path: PathBuf,
        /// Why.
        why: String,
    },
    /// The index lacks a result.
    NotIndexed(String),
    /// The index has a result whose folder is missing.
    NoFolder(String),
}

impl Finding {
    /// What is wrong, as a note.
    pub fn note(&self) -> Note {
        let shown = |path: &Path| path.display().to_string();
        match self {
            Finding::Changed { path, found } => {
                Note::new("store_finding.changed").with("path", shown(path)).with("found", found.as_str())
            }
            Finding::Statement(path) => Note::new("store_finding.statement").with("path", shown(path)),
            Finding::Unreadable { path, why } => Note::new("store_finding.unreadable")
                .with("path", shown(path))
                .with("why", Arg::from(why.as_str())),
            Finding::NotIndexed(address) => {
                Note::new("store_finding.not_indexed").with("address", address.as_str())
            }
            Finding::NoFolder(address) => {
                Note::new("store_finding.no_folder").with("address", address.as_str())
            }
        }
    }
}
