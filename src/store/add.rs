//! A result folder on its way into the store.

use super::address::{address, sha256};
use super::entry::Entry;
use super::error::{StoreError, io};
use super::opened::Store;
use crate::output::{AddressedFolder, Kind, is_plain};
use crate::record::read;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// What came of a folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Added {
    /// Its address.
    pub address: String,
    /// False where the store had it already.
    pub new: bool,
    /// Files that its result lists and its folder lacks.
    pub missing: Vec<String>,
}

/// The files that a result lists.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Listing {
    files: Vec<String>,
}

impl Store {
    /// Copies a result folder into the store. It is there whole or not at all.
    ///
    /// # Errors
    /// [`StoreError`] where the folder holds no result of a test, or the store cannot be written.
    pub fn add(&mut self, folder: &Path) -> Result<Added, StoreError> {
        self.writable()?;
        let record = folder.join(Kind::Result.record_file());
        let bytes =
            read::bytes(&record).map_err(|source| StoreError::Result { path: record.clone(), source })?;
        let entry = Entry::of_json(&bytes, &record)?;
        let staged = AddressedFolder::begin(&self.layout.results())?;
        let (mut hashes, mut missing) = (BTreeMap::new(), vec![]);
        for name in listed(&bytes) {
            let is_record = name == Kind::Result.record_file();
            let contents = if is_record { Some(bytes.clone()) } else { contents(folder, &name)? };
            let Some(contents) = contents else {
                missing.push(name);
                continue;
            };
            staged.write(&name, &contents)?;
            hashes.insert(name, sha256(&contents));
        }
        let address = address(&hashes);
        let target = self.layout.result(&address);
        let pending = if target.is_dir() { None } else { Some(self.begin_pending(&address)?) };
        let new = staged.publish(&target)?;
        self.with_index(|index| index.add(&address, &entry))?;
        if let Some(pending) = pending {
            pending.end();
        }
        Ok(Added { address, new, missing })
    }
}

/// The files of a result: itself and those that it lists. Results of other programs list none.
fn listed(record: &[u8]) -> Vec<String> {
    let listing: Listing = serde_json::from_slice(record).unwrap_or_default();
    let own = Kind::Result.record_file();
    let others = listing.files.into_iter().filter(|name| name != own);
    std::iter::once(own.to_owned()).chain(others).collect()
}

/// The bytes of a file of a folder; `None` where it is missing. A name that leads elsewhere names no file of it.
fn contents(folder: &Path, name: &str) -> Result<Option<Vec<u8>>, StoreError> {
    if !is_plain(name) {
        return Ok(None);
    }
    let path = folder.join(name);
    match fs::read(&path) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(e) => Err(io("store_error.unreadable", &path)(e)),
    }
}
