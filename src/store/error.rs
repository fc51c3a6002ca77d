//! Why a store cannot be used, or a folder cannot be added to it.

use crate::i18n::{Arg, Lang, Localize, Note, io_reason, note};
use crate::output::{OutputError, TransferError};
use crate::record::read::ReadError;
use rusqlite::ErrorCode;
use std::fmt;
use std::path::{Path, PathBuf};

/// Why something about a store failed.
#[derive(Debug)]
pub enum StoreError {
    /// The operating system refused.
    Io {
        /// What failed: a key of the locale tables.
        action: &'static str,
        /// On which path.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// A folder could not be written.
    Output(OutputError),
    /// There is no store at the path.
    NoStore(PathBuf),
    /// Something is there already, where a store was to be made.
    Taken(PathBuf),
    /// The store was written by a later program.
    LaterStore {
        /// The store.
        path: PathBuf,
        /// The format that it names.
        found: String,
    },
    /// The index is missing.
    NoIndex(PathBuf),
    /// The index is cut or damaged, or is no index.
    DamagedIndex {
        /// The index.
        path: PathBuf,
        /// What the database says of it, in English.
        reason: String,
    },
    /// The file is a database of something else.
    ForeignIndex(PathBuf),
    /// The index was written by a later program.
    LaterIndex {
        /// The index.
        path: PathBuf,
        /// Its version.
        found: i64,
        /// The latest version that is known here.
        known: i64,
    },
    /// The index is of an earlier version and cannot be made anew where it is.
    EarlierIndex {
        /// The index.
        path: PathBuf,
        /// Its version.
        found: i64,
    },
    /// Nothing can be written into the store.
    ReadOnly(PathBuf),
    /// Others have held the store for too long.
    Busy(PathBuf),
    /// The database refused for another reason, in English.
    Database {
        /// The index.
        path: PathBuf,
        /// The reason.
        reason: String,
    },
    /// A result cannot be read.
    Result {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: ReadError,
    },
    /// What is no acceptance test of a unit has no place in a store.
    NoTest(PathBuf),
    /// A file of a result is a link, a pipe or another thing that is no ordinary file, or too large.
    NoFile(PathBuf),
    /// The hashes that a result states contradict one of its files.
    Contradicted {
        /// The folder.
        path: PathBuf,
        /// The file.
        name: String,
    },
    /// Other signatures of the result are in the store already.
    OtherSignatures(PathBuf),
    /// A file is not the recording that was evaluated.
    OtherRecording(PathBuf),
    /// What stands at the target of a copy is not the recording.
    OtherCopy(PathBuf),
    /// A folder that recordings are to leave the store for lies in a store.
    InsideStore(PathBuf),
    /// No result, or more than one, has an address that begins so.
    Address {
        /// The given text.
        given: String,
        /// How many there are.
        count: usize,
    },
    /// A result would supersede itself, or one that supersedes it.
    Circle {
        /// The result.
        address: String,
    },
}

impl StoreError {
    /// The error as a note.
    pub fn note(&self) -> Note {
        let at = |key: &'static str, path: &Path| Note::new(key).with("path", path.display().to_string());
        match self {
            StoreError::Io { action, path, source } => at(action, path).with("reason", io_reason(source)),
            StoreError::Output(error) => error.note(),
            StoreError::NoStore(path) => at("store_error.no_store", path),
            StoreError::Taken(path) => at("store_error.taken", path),
            StoreError::LaterStore { path, found } => {
                at("store_error.later_store", path).with("found", found.as_str())
            }
            StoreError::NoIndex(path) => at("store_error.no_index", path),
            StoreError::DamagedIndex { path, reason } => {
                at("store_error.damaged_index", path).with("reason", reason.as_str())
            }
            StoreError::ForeignIndex(path) => at("store_error.foreign_index", path),
            StoreError::LaterIndex { path, found, known } => at("store_error.later_index", path)
                .with("found", found.to_string())
                .with("known", known.to_string()),
            StoreError::EarlierIndex { path, found } => {
                at("store_error.earlier_index", path).with("found", found.to_string())
            }
            StoreError::ReadOnly(path) => at("store_error.read_only", path),
            StoreError::Busy(path) => at("store_error.busy", path),
            StoreError::Database { path, reason } => {
                at("store_error.database", path).with("reason", reason.as_str())
            }
            StoreError::Result { path, source } => source.note(path),
            StoreError::NoTest(path) => at("store_error.no_test", path),
            StoreError::NoFile(path) => at("store_error.no_file", path),
            StoreError::Contradicted { path, name } => {
                at("store_error.contradicted", path).with("name", name.as_str())
            }
            StoreError::OtherSignatures(path) => at("store_error.other_signatures", path),
            StoreError::OtherRecording(path) => at("store_error.other_recording", path),
            StoreError::OtherCopy(path) => at("store_error.other_copy", path),
            StoreError::InsideStore(path) => at("store_error.inside_store", path),
            StoreError::Address { given, count: 0 } => {
                note!("store_error.no_address", given = given.as_str())
            }
            StoreError::Address { given, count } => {
                note!("store_error.several", given = given.as_str(), n = *count)
            }
            StoreError::Circle { address } => {
                note!("store_error.circle", address = Arg::from(address.as_str()))
            }
        }
    }

    /// The error of a database in a file.
    pub(super) fn of_database(path: &Path, error: &rusqlite::Error) -> StoreError {
        let path = path.to_owned();
        let reason = error.to_string();
        match error.sqlite_error_code() {
            Some(ErrorCode::DatabaseCorrupt | ErrorCode::NotADatabase) => {
                StoreError::DamagedIndex { path, reason }
            }
            Some(ErrorCode::ReadOnly) => StoreError::ReadOnly(path),
            Some(ErrorCode::DatabaseBusy | ErrorCode::DatabaseLocked) => StoreError::Busy(path),
            _ => StoreError::Database { path, reason },
        }
    }
}

impl From<TransferError> for StoreError {
    fn from(error: TransferError) -> StoreError {
        match error {
            TransferError::NoSource(path) => {
                io("store_error.unreadable", &path)(std::io::ErrorKind::NotFound.into())
            }
            TransferError::Source(path, source) => io("store_error.unreadable", &path)(source),
            TransferError::SourceDiffers(path) => StoreError::OtherRecording(path),
            TransferError::TargetDiffers(path) => StoreError::OtherCopy(path),
            TransferError::Same(path) => StoreError::InsideStore(path),
            TransferError::Target(error) => StoreError::Output(error),
        }
    }
}

impl From<OutputError> for StoreError {
    fn from(error: OutputError) -> Self {
        StoreError::Output(error)
    }
}

impl fmt::Display for StoreError {
    /// In English.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.note().say(Lang::En))
    }
}

impl std::error::Error for StoreError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            StoreError::Io { source, .. } => Some(source),
            StoreError::Output(error) => Some(error),
            StoreError::Result { source, .. } => Some(source),
            _ => None,
        }
    }
}

/// The error of an action on a path.
pub(super) fn io(action: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> StoreError + use<> {
    let path = path.to_owned();
    move |source| StoreError::Io { action, path, source }
}
