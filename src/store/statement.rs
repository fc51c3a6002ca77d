//! Statements about results after they were made. A statement is a file of its own, named by its hash; it is never
//! changed or taken back, only followed by another.

use super::address::sha256;
use super::error::{StoreError, io};
use super::layout::{Layout, is_address, names};
use crate::output::{MAX_RECORD_BYTES, StagedFile};
use crate::record::read;
use sagnac_ingest::read_file;
use serde::{Deserialize, Serialize};
use std::io::Write;
use std::path::PathBuf;

/// Version of the format of a statement.
const STATEMENT_FORMAT: &str = "statement/1";

/// A statement.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Statement {
    format: String,
    /// Subject of a statement.
    #[serde(flatten)]
    pub what: What,
    /// When, RFC 3339.
    pub stated_at: String,
}

/// Subject of a statement.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "kind")]
pub enum What {
    /// A result supersedes another.
    Correction {
        /// Address of the result that does not count any more.
        superseded: String,
        /// Address of the one that counts in its place.
        by: String,
        /// Why.
        reason: String,
        /// Who says so; empty where it is not said.
        operator: String,
    },
    /// A recording is at another place than its result says.
    Place {
        /// SHA-256 of its bytes.
        sha256: String,
        /// Where it is.
        path: String,
    },
}

impl Statement {
    /// A statement.
    pub fn new(what: What, stated_at: String) -> Statement {
        Statement { format: STATEMENT_FORMAT.to_owned(), what, stated_at }
    }

    /// Its hash and the bytes of its file.
    pub(super) fn bytes(&self, layout: &Layout) -> Result<(String, Vec<u8>), StoreError> {
        let bytes = serde_json::to_vec_pretty(self)
            .map_err(|e| StoreError::Database { path: layout.statements(), reason: e.to_string() })?;
        Ok((sha256(&bytes), bytes))
    }
}

fn file(layout: &Layout, hash: &str) -> PathBuf {
    layout.statements().join(format!("{hash}.json"))
}

/// Writes the file of a statement; it appears whole or not at all.
pub(super) fn write(layout: &Layout, hash: &str, bytes: &[u8]) -> Result<(), StoreError> {
    let path = file(layout, hash);
    let staged = StagedFile::within_store(&path)?;
    staged.file()?.write_all(bytes).map_err(io("output_error.write", &path))?;
    staged.publish()?;
    Ok(())
}

/// The statement of a hash; `None` where there is none, or one that was changed.
pub(super) fn at(layout: &Layout, hash: &str) -> Option<Statement> {
    let bytes = read_file(&file(layout, hash), MAX_RECORD_BYTES).ok()?;
    read::of_format(&bytes, STATEMENT_FORMAT).ok().filter(|_| sha256(&bytes) == hash)
}

/// A statement as it stands in the store.
pub(super) struct Stored {
    /// The file.
    pub path: PathBuf,
    /// The hash that it is named by.
    pub hash: String,
    /// The hash of its bytes.
    pub found: String,
    /// The statement; `None` where the file is none.
    pub statement: Option<Statement>,
}

/// All statements of a store, by their hashes.
pub(super) fn all(layout: &Layout) -> Result<Vec<Stored>, StoreError> {
    let mut out = vec![];
    for name in names(&layout.statements())? {
        let Some(hash) = name.strip_suffix(".json").filter(|stem| is_address(stem)) else {
            continue;
        };
        let path = layout.statements().join(&name);
        let bytes = read_file(&path, MAX_RECORD_BYTES).map_err(io("store_error.unreadable", &path))?;
        let statement = read::of_format(&bytes, STATEMENT_FORMAT).ok();
        out.push(Stored { hash: hash.to_owned(), found: sha256(&bytes), statement, path });
    }
    Ok(out)
}
