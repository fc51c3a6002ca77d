//! A result folder inside a folder in the making: it becomes visible together with the whole.

use super::kind::Kind;
use super::{OutputError, StagedFolder, listed, sync_folder};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Mutex, PoisonError};

/// The result folder of one unit in the folder of a lot. Its files are those of a result on its own.
#[derive(Debug)]
pub struct StagedPart<'a> {
    whole: &'a StagedFolder,
    folder: String,
    inputs: BTreeMap<String, String>,
    written: Mutex<BTreeSet<String>>,
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
        self.written.lock().unwrap_or_else(PoisonError::into_inner).insert(name.to_owned());
        Ok(())
    }

    /// Writes the record with the list of everything that the folder holds.
    ///
    /// # Errors
    /// As [`StagedFolder::write`].
    pub fn finish(self, record: impl Serialize) -> Result<(), OutputError> {
        let marks = Kind::Result.record_file();
        let files = self.written.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let json = listed(record, &self.inputs, files, marks)?;
        self.write(marks, &json)?;
        let folder = self.whole.staging.path().join(&self.folder);
        let figures = folder.join("figures");
        if figures.is_dir() {
            sync_folder(&figures)?;
        }
        sync_folder(&folder)
    }
}
