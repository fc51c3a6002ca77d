//! A result folder on its way into the store.

use super::address::{address, sha256};
use super::entry::Entry;
use super::error::{StoreError, io};
use super::opened::Store;
use crate::output::{
    AddressedFolder, CHECKSUMS_FILE, Kind, NotRead, SIGNATURES_FOLDER, StagedFile, read_below, read_checksums,
};
use crate::record::read::{MAX_BYTES, ReadError};
use crate::signing;
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A folder that was added.
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
    /// Copies a result folder into the store, with its signatures. It is there whole or not at all. Links are not followed, and nothing
    /// but ordinary files is opened.
    ///
    /// # Errors
    /// [`StoreError`] where the folder holds no result of a test, one that its own hashes contradict, or the store cannot be written.
    pub fn add(&mut self, folder: &Path) -> Result<Added, StoreError> {
        self.writable()?;
        let name = Kind::Result.record_file();
        let record = folder.join(name);
        let bytes = contents(folder, name)?.ok_or_else(|| StoreError::Result {
            path: record.clone(),
            source: ReadError::Io(std::io::ErrorKind::NotFound.into()),
        })?;
        let entry = Entry::of_json(&bytes, &record)?;
        let (mut files, mut missing) = (BTreeMap::from([(name.to_owned(), bytes)]), vec![]);
        for name in listed(files.get(name).map(Vec::as_slice).unwrap_or_default()) {
            match contents(folder, &name)? {
                Some(contents) => {
                    files.insert(name, contents);
                }
                None => missing.push(name),
            }
        }
        let hashes: BTreeMap<String, String> =
            files.iter().map(|(name, contents)| (name.clone(), sha256(contents))).collect();
        agree(folder, files.get(CHECKSUMS_FILE), &hashes)?;
        let signatures = signatures(folder)?;
        let address = address(&hashes);
        let target = self.layout.result(&address);
        let staged = AddressedFolder::begin(&self.layout.results())?;
        for (name, contents) in files.iter().chain(&signatures) {
            staged.write(name, contents)?;
        }
        let pending = if target.is_dir() { None } else { Some(self.begin_pending(&address)?) };
        let new = staged.publish(&target)?;
        if !new {
            add_signatures(&target, &signatures)?;
        }
        self.with_index(|index| index.add(&address, &entry))?;
        if let Some(pending) = pending {
            pending.end();
        }
        Ok(Added { address, new, missing })
    }
}

/// The files that a result lists, beside itself. Results of other programs list none.
fn listed(record: &[u8]) -> BTreeSet<String> {
    let listing: Listing = serde_json::from_slice(record).unwrap_or_default();
    let own = Kind::Result.record_file();
    listing.files.into_iter().filter(|name| name != own).collect()
}

/// The bytes of a file of a folder; `None` where it is missing. A name that leads elsewhere names no file of it.
fn contents(folder: &Path, name: &str) -> Result<Option<Vec<u8>>, StoreError> {
    let path = folder.join(name);
    match read_below(folder, name, MAX_BYTES as u64) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(NotRead::Missing | NotRead::Outside) => Ok(None),
        Err(NotRead::Link | NotRead::NoFile | NotRead::TooLarge) => Err(StoreError::NoFile(path)),
        Err(NotRead::Io(e)) => Err(io("store_error.unreadable", &path)(e)),
    }
}

/// Refuses a folder whose own list of hashes contradicts what it holds. Files may be missing; results of other programs have no list.
fn agree(folder: &Path, list: Option<&Vec<u8>>, hashes: &BTreeMap<String, String>) -> Result<(), StoreError> {
    // A list that the record does not name contradicts it all the same.
    let unlisted = if list.is_none() { contents(folder, CHECKSUMS_FILE)? } else { None };
    let Some(list) = list.or(unlisted.as_ref()) else { return Ok(()) };
    let contradicted =
        |name: &str| StoreError::Contradicted { path: folder.to_owned(), name: name.to_owned() };
    let stated = std::str::from_utf8(list).ok().and_then(read_checksums);
    let stated = stated.ok_or_else(|| contradicted(CHECKSUMS_FILE))?;
    let differs = |(name, hash): &(&String, &String)| stated.get(*name) != Some(hash);
    match hashes.iter().filter(|(name, _)| *name != CHECKSUMS_FILE).find(differs) {
        Some((name, _)) => Err(contradicted(name)),
        None => Ok(()),
    }
}

/// The files of the signatures of a folder, by their names in it.
fn signatures(folder: &Path) -> Result<BTreeMap<String, Vec<u8>>, StoreError> {
    let names = signing::files(folder).into_iter().map(|name| format!("{SIGNATURES_FOLDER}/{name}"));
    names.filter_map(|name| Some(contents(folder, &name).transpose()?.map(|bytes| (name, bytes)))).collect()
}

/// Puts signatures beside a result that the store holds already. Those that are there stay.
fn add_signatures(result: &Path, signatures: &BTreeMap<String, Vec<u8>>) -> Result<(), StoreError> {
    for (name, bytes) in signatures {
        match contents(result, name)? {
            Some(there) if there == *bytes => {}
            Some(_) => return Err(StoreError::OtherSignatures(result.join(name))),
            None => {
                StagedFile::within_store(&result.join(name))?.publish_with(bytes)?;
            }
        }
    }
    Ok(())
}
