//! Results that were made elsewhere, and recordings that have moved since.

use super::error::StoreError;
use super::layout::names;
use super::opened::Store;
use super::statement::What;
use crate::output::Kind;
use sagnac_ingest::byte_stream;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Folders in folders that are looked into.
const MAX_FOLDER_DEPTH: usize = 12;

/// The result folders at and below a path, in the order of their names. What lies inside of a result, such as its phases, is a
/// part of it.
///
/// # Errors
/// [`StoreError::Io`] where a folder cannot be read.
pub fn result_folders(path: &Path) -> Result<Vec<PathBuf>, StoreError> {
    let record = Kind::Result.record_file();
    if path.is_file() && path.file_name().is_some_and(|n| n == record) {
        return Ok(vec![
            path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new(".")).to_owned(),
        ]);
    }
    let mut found = vec![];
    let mut open = vec![(path.to_owned(), 0)];
    while let Some((folder, depth)) = open.pop() {
        if folder.join(record).is_file() {
            found.push(folder);
            continue;
        }
        let below = |name: &String| {
            let path = folder.join(name);
            // A link could lead round in a circle.
            let is_folder = path.symlink_metadata().is_ok_and(|m| m.is_dir());
            (is_folder && depth < MAX_FOLDER_DEPTH).then_some((path, depth + 1))
        };
        open.extend(names(&folder)?.iter().filter_map(below));
    }
    found.sort();
    Ok(found)
}

/// What came of the search for recordings.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct RecordingSearch {
    /// Recordings that were found at a place that the store did not know.
    pub found: usize,
    /// Recordings that are where the store says.
    pub in_place: usize,
    /// Recordings that are at no known place.
    pub missing: usize,
}

impl Store {
    /// Looks for the recordings of all results: at the places that the store knows, then by size and hash below some folders.
    /// A new place is stated.
    ///
    /// # Errors
    /// [`StoreError`] where a folder cannot be read or the store cannot be written.
    pub fn find_recordings(
        &mut self,
        folders: &[PathBuf],
        stated_at: &str,
    ) -> Result<RecordingSearch, StoreError> {
        let mut search = RecordingSearch::default();
        let mut by_size: BTreeMap<u64, Vec<PathBuf>> = BTreeMap::new();
        for path in folders.iter().map(|f| files_below(f)).collect::<Result<Vec<_>, _>>()?.concat() {
            if let Ok(meta) = path.metadata() {
                by_size.entry(meta.len()).or_default().push(path);
            }
        }
        for (sha256, bytes) in self.index.recordings()? {
            let is_it = |path: &Path| {
                path.metadata().is_ok_and(|m| m.len() == bytes)
                    && byte_stream::digest(path).is_ok_and(|d| d.sha256 == sha256)
            };
            if self.places(&sha256)?.iter().any(|p| is_it(Path::new(p))) {
                search.in_place += 1;
                continue;
            }
            let same_size = by_size.get(&bytes).map(Vec::as_slice).unwrap_or_default();
            match same_size.iter().find(|p| is_it(p)) {
                Some(path) => {
                    let path = std::path::absolute(path).unwrap_or_else(|_| path.clone());
                    self.state(
                        What::Place { sha256, path: path.display().to_string() },
                        stated_at.to_owned(),
                    )?;
                    search.found += 1;
                }
                None => search.missing += 1,
            }
        }
        Ok(search)
    }
}

/// The files at and below a path.
fn files_below(path: &Path) -> Result<Vec<PathBuf>, StoreError> {
    if path.is_file() {
        return Ok(vec![path.to_owned()]);
    }
    let mut found = vec![];
    let mut open = vec![(path.to_owned(), 0)];
    while let Some((folder, depth)) = open.pop() {
        for name in names(&folder)? {
            let path = folder.join(name);
            let Ok(meta) = path.symlink_metadata() else { continue };
            if meta.is_file() {
                found.push(path);
            } else if meta.is_dir() && depth < MAX_FOLDER_DEPTH {
                open.push((path, depth + 1));
            }
        }
    }
    Ok(found)
}
