//! A result folder in the making: the whole, or a part of it that becomes visible together with the whole.

use super::checksums::{CHECKSUMS_FILE, checksums};
use super::kind::Kind;
use super::{OutputError, StagedFolder, listed, sync_folder};
use serde::Serialize;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::PoisonError;

/// A result folder in the making, of which the files are those of a result on its own.
#[derive(Debug)]
pub struct StagedPart<'a> {
    whole: &'a StagedFolder,
    /// Beginning of its names in the whole: empty, or its folder with a slash.
    below: String,
    kind: Kind,
    /// The inputs of its result; `None`: those of the whole.
    inputs: Option<BTreeMap<String, String>>,
}

impl<'a> StagedPart<'a> {
    /// The whole folder.
    pub fn all_of(whole: &'a StagedFolder) -> StagedPart<'a> {
        StagedPart { whole, below: String::new(), kind: whole.kind, inputs: None }
    }

    /// Begins the folder `folder`, a plain name, of one unit in the folder of a lot. `inputs` are what its result is made from.
    pub fn begin(whole: &'a StagedFolder, folder: &str, inputs: BTreeMap<String, String>) -> StagedPart<'a> {
        StagedPart { whole, below: format!("{folder}/"), kind: Kind::Result, inputs: Some(inputs) }
    }

    /// Writes one file into the folder; `name` may hold sub-folders.
    ///
    /// # Errors
    /// [`OutputError::Io`] when it cannot be written, [`OutputError::Unforeseen`] for a name that a later run would
    /// not know as its own.
    pub fn write(&self, name: &str, contents: &[u8]) -> Result<(), OutputError> {
        if !self.kind.owns(name.split('/').next().unwrap_or_default()) {
            return Err(OutputError::Unforeseen(name.to_owned()));
        }
        self.whole.put(&format!("{}{name}", self.below), contents)
    }

    /// The hashes of the files that were written, by their names in this folder.
    fn written(&self) -> BTreeMap<String, String> {
        let all = self.whole.written.lock().unwrap_or_else(PoisonError::into_inner);
        let own = all.iter().filter_map(|(name, hash)| Some((name.strip_prefix(&self.below)?, hash)));
        own.map(|(name, hash)| (name.to_owned(), hash.clone())).collect()
    }

    /// The bytes of the record as it will be written once the files `still` are written too.
    ///
    /// # Errors
    /// [`OutputError::Unwritable`] for a record that is no JSON.
    pub fn record_with(&self, record: impl Serialize, still: &[&str]) -> Result<Vec<u8>, OutputError> {
        let inputs = match &self.inputs {
            Some(own) => Cow::Borrowed(own),
            None => self.whole.inputs(),
        };
        let names = self.written().into_keys().chain(still.iter().copied().map(str::to_owned));
        listed(record, &inputs, names, self.kind.record_file())
    }

    /// Writes the record with the list of everything that the folder holds, and the hashes of all of it; gives the bytes of the record.
    ///
    /// # Errors
    /// As [`StagedPart::write`], and as [`StagedPart::record_with`].
    pub fn finish(self, record: impl Serialize) -> Result<Vec<u8>, OutputError> {
        let json = self.record_with(record, &[])?;
        self.write(self.kind.record_file(), &json)?;
        self.write(CHECKSUMS_FILE, checksums(&self.written()).as_bytes())?;
        let folder = self.whole.staging.path().join(&self.below);
        let figures = folder.join("figures");
        if figures.is_dir() {
            sync_folder(&figures)?;
        }
        sync_folder(&folder)?;
        Ok(json)
    }
}
