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
    /// Something that no store holds, a link in place of a file among it.
    Stray(PathBuf),
    /// A signature of a result does not hold.
    Signature {
        /// The folder of the result.
        path: PathBuf,
        /// The statement that was signed.
        name: String,
    },
    /// A copy of a recording has been changed.
    Recording(PathBuf),
    /// The tables of the index are not those of this program.
    Tables,
    /// The index says otherwise of a result than its folder.
    IndexDiffers {
        /// Address of the result.
        address: String,
        /// What differs.
        parts: Vec<Part>,
    },
    /// The index lacks a result.
    NotIndexed(String),
    /// The index has a result whose folder is missing.
    NoFolder(String),
    /// The index has a statement, by its hash, whose file is missing or says otherwise.
    NoStatement(String),
    /// The index lacks a statement, or says otherwise.
    StatementNotIndexed(String),
    /// A result names an earlier attempt that the store does not hold.
    NoAttempt {
        /// Address of the result.
        address: String,
        /// Address of the earlier attempt.
        missing: String,
    },
    /// A result counts in its own place, through corrections that lead round.
    Circle(String),
    /// A correction is of a result that the store does not hold.
    CorrectsNothing(String),
}

/// A part of what the index has of a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// The unit.
    Unit,
    /// Procedure, limits, station, operator, moment.
    Test,
    /// Verdict and reasons.
    Verdict,
    /// Measured values and their limits.
    Values,
    /// Recordings.
    Recordings,
    /// The place among the attempts of the unit.
    Place,
    /// What counts in its place.
    Correction,
}

impl Part {
    /// The key of its name.
    fn key(self) -> &'static str {
        match self {
            Part::Unit => "store_part.unit",
            Part::Test => "store_part.test",
            Part::Verdict => "store_part.verdict",
            Part::Values => "store_part.values",
            Part::Recordings => "store_part.recordings",
            Part::Place => "store_part.place",
            Part::Correction => "store_part.correction",
        }
    }
}

impl Finding {
    /// The finding as a note.
    pub fn note(&self) -> Note {
        let of_path =
            |key: &'static str, path: &Path| Note::new(key).with("path", path.display().to_string());
        let of_address = |key: &'static str, address: &str| Note::new(key).with("address", address);
        match self {
            Finding::Changed { path, found } => {
                of_path("store_finding.changed", path).with("found", found.as_str())
            }
            Finding::Statement(path) => of_path("store_finding.statement", path),
            Finding::Unreadable { path, why } => {
                of_path("store_finding.unreadable", path).with("why", Arg::from(why.as_str()))
            }
            Finding::Stray(path) => of_path("store_finding.stray", path),
            Finding::Signature { path, name } => {
                of_path("store_finding.signature", path).with("name", name.as_str())
            }
            Finding::Recording(path) => of_path("store_finding.recording", path),
            Finding::Tables => "store_finding.tables".into(),
            Finding::IndexDiffers { address, parts } => {
                let parts = parts.iter().map(|p| Arg::Key(p.key().to_owned())).collect();
                of_address("store_finding.index_differs", address)
                    .with("parts", Arg::Several(parts, ", ".into()))
            }
            Finding::NotIndexed(address) => of_address("store_finding.not_indexed", address),
            Finding::NoFolder(address) => of_address("store_finding.no_folder", address),
            Finding::NoStatement(hash) => of_address("store_finding.no_statement", hash),
            Finding::StatementNotIndexed(hash) => of_address("store_finding.statement_not_indexed", hash),
            Finding::NoAttempt { address, missing } => {
                of_address("store_finding.no_attempt", address).with("missing", missing.as_str())
            }
            Finding::Circle(address) => of_address("store_finding.circle", address),
            Finding::CorrectsNothing(address) => of_address("store_finding.corrects_nothing", address),
        }
    }
}
