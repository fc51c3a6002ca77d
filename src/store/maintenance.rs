//! The index made anew, and every hash computed anew.

use super::address::{address, sha256};
use super::error::{StoreError, io};
use super::finding::Finding;
use super::folders::{Filled, fill, statements};
use super::index::Index;
use super::layout::{Layout, names};
use super::lock::{self, Sharing};
use super::marker::marker;
use super::opened::Store;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// What an index was made from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rebuilt {
    /// Results.
    pub results: usize,
    /// Statements.
    pub statements: usize,
    /// What was left out.
    pub findings: Vec<Finding>,
}

/// What was looked at.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Verified {
    /// Results.
    pub results: usize,
    /// Statements.
    pub statements: usize,
    /// What is wrong.
    pub findings: Vec<Finding>,
}

/// Makes the index of a store anew from its folders and statements. The earlier one stays until the new one is whole.
///
/// # Errors
/// [`StoreError`] where the store is in use for too long, or the disk refuses.
pub fn rebuild(path: &Path) -> Result<Rebuilt, StoreError> {
    let layout = Layout::at(path);
    let shared_disk = marker(&layout)?.shared_disk || lock::is_shared_disk(path);
    let _lock = lock::take(&layout.lock(), Sharing::Alone)?;
    let new = layout.index().with_extension("sqlite.new");
    remove_database(&new)?;
    let mut index = Index::create(&new, shared_disk)?;
    let Filled { results, statements, findings } = fill(&mut index, &layout)?;
    index.close()?;
    // What the earlier index left in its log must not be taken for that of the new one.
    remove_database(&layout.index())?;
    fs::rename(&new, layout.index()).map_err(io("output_error.put_in_place", &layout.index()))?;
    Ok(Rebuilt { results, statements, findings })
}

fn remove_database(path: &Path) -> Result<(), StoreError> {
    for ending in ["", "-wal", "-shm", "-journal"] {
        let mut name = path.as_os_str().to_owned();
        name.push(ending);
        match fs::remove_file(&name) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
                return Err(io("output_error.write", path)(e));
            }
            _ => {}
        }
    }
    Ok(())
}

/// Computes the address of every result and the hash of every statement anew, and sets the index against them.
///
/// # Errors
/// [`StoreError`] where the index or a folder cannot be read at all.
pub fn verify(store: &Store) -> Result<Verified, StoreError> {
    let layout = &store.layout;
    store.index.check()?;
    let mut findings = vec![];
    let statements = statements(layout, &mut findings)?.len();
    let there = layout.addresses()?;
    for expected in &there {
        let folder = layout.result(expected);
        match address_of(&folder) {
            Ok(found) if found == *expected => {}
            Ok(found) => findings.push(Finding::Changed { path: folder, found }),
            Err(why) => findings.push(Finding::Unreadable { path: folder, why: why.to_string() }),
        }
    }
    let there: BTreeSet<String> = there.into_iter().collect();
    let indexed: BTreeSet<String> = store.index.addresses()?.into_iter().collect();
    findings.extend(there.difference(&indexed).cloned().map(Finding::NotIndexed));
    findings.extend(indexed.difference(&there).cloned().map(Finding::NoFolder));
    Ok(Verified { results: there.len(), statements, findings })
}

/// The address of whatever a folder holds.
fn address_of(folder: &Path) -> Result<String, StoreError> {
    let mut hashes = BTreeMap::new();
    let mut open = vec![(folder.to_owned(), String::new())];
    while let Some((at, before)) = open.pop() {
        for name in names(&at)? {
            let (path, name) = (at.join(&name), format!("{before}{name}"));
            if path.is_dir() {
                open.push((path, format!("{name}/")));
            } else {
                let bytes = fs::read(&path).map_err(io("store_error.unreadable", &path))?;
                hashes.insert(name, sha256(&bytes));
            }
        }
    }
    Ok(address(&hashes))
}
