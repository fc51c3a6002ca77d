//! A result folder inside a folder in the making: it becomes visible together with the whole.

use super::checksums::{CHECKSUMS_FILE, checksums, sha256};
use super::kind::Kind;
use super::{OutputError, StagedFolder, listed, sync_folder};
use serde::Serialize;
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// The result folder of one unit in the folder of a lot. Its files are those of a result on its own.
#[derive(Debug)]
pub struct StagedPart<'a> {
    whole: &'a StagedFolder,
    folder: String,
    inputs: BTreeMap<String, String>,
    written: Mutex<BTreeMap<String, String>>,
}

impl<'a> StagedPart<'a> {
    /// Begins the folder `folder`, a plain name, within a whole. `inputs` are what its result is made from.
    pub fn begin(whole: &'a StagedFolder, folder: &str, inputs: BTreeMap<String, String>) -> StagedPart<'a> {
        StagedPart { whole, folder: folder.to_owned(), inputs, written: Mutex::default() }
    }

    /// Writes one file into the folder; `name` may hold sub-folders.
    ///
    /// # Errors
    /// As [`StagedFolder::write`].
    pub fn write(&self, name: &str, contents: &[u8]) -> Result<(), OutputError> {
        if !Kind::Result.owns(name.split('/').next().unwrap_or_default()) {
            return Err(OutputError::Unforeseen(name.to_owned()));
        }
        self.whole.put(&format!("{}/{name}", self.folder), contents)?;
        self.written.lock().unwrap_or_else(PoisonError::into_inner).insert(name.to_owned(), sha256(contents));
        Ok(())
    }

    /// The bytes of the record as [`StagedPart::finish`] will write it once the files `still` are written too.
    ///
    /// # Errors
    /// [`OutputError::Unwritable`] for a record that is no JSON.
    pub fn record_with(&self, record: impl Serialize, still: &[&str]) -> Result<Vec<u8>, OutputError> {
        let written = self.written.lock().unwrap_or_else(PoisonError::into_inner);
        let names = written.keys().map(String::as_str).chain(still.iter().copied());
        listed(record, &self.inputs, names, Kind::Result.record_file())
    }

    /// Writes the record with the list of everything that the folder holds, and the hashes of all of it.
    ///
    /// # Errors
    /// As [`StagedFolder::write`].
    pub fn finish(self, record: impl Serialize) -> Result<(), OutputError> {
        let marks = Kind::Result.record_file();
        let json = self.record_with(record, &[])?;
        self.write(marks, &json)?;
        let hashes = self.written.lock().unwrap_or_else(PoisonError::into_inner).clone();
        self.write(CHECKSUMS_FILE, checksums(&hashes).as_bytes())?;
        let folder = self.whole.staging.path().join(&self.folder);
        let figures = folder.join("figures");
        if figures.is_dir() {
            sync_folder(&figures)?;
        }
        sync_folder(&folder)
    }
}
