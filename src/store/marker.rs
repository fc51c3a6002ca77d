//! The file that marks a folder as a store.

use super::database::{database_files, remove_database};
use super::error::{StoreError, io};
use super::index::{Index, Journal};
use super::layout::{Layout, STORE_FORMAT, names};
use super::lock;
use crate::i18n::{Note, note};
use crate::output::{StagedFile, is_partial};
use crate::record::read;
use serde::{Deserialize, Serialize};
use std::fs;
use std::io::Write;
use std::path::Path;

/// The file that says what a folder is.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Marker {
    format: String,
    /// True where several machines use the disk, so that the index must not rely on memory that its users share.
    #[serde(default)]
    pub shared_disk: bool,
}

/// Makes a store in a folder that is empty or not there. `shared_disk` where several machines will use it; a disk that is known
/// to be of that kind needs no saying. Gives what must be known of it.
///
/// # Errors
/// [`StoreError::Taken`] where something is there already, and what the disk refuses.
pub fn init(path: &Path, shared_disk: bool) -> Result<Vec<Note>, StoreError> {
    let layout = Layout::at(path);
    fs::create_dir_all(path).map_err(io("output_error.create_folder", path))?;
    if !is_free(&layout)? {
        return Err(StoreError::Taken(path.to_owned()));
    }
    let shared_disk = shared_disk || lock::is_shared_disk(path);
    for folder in [layout.results(), layout.statements(), layout.pending()] {
        fs::create_dir_all(&folder).map_err(io("output_error.create_folder", &folder))?;
    }
    remove_database(&layout.index())?;
    let index = Index::create(&layout.index(), shared_disk)?;
    let shared_disk = index.journal == Journal::Rollback;
    index.close()?;
    let marker = Marker { format: STORE_FORMAT.to_owned(), shared_disk };
    let bytes = serde_json::to_vec_pretty(&marker)
        .map_err(|e| StoreError::Database { path: layout.marker(), reason: e.to_string() })?;
    // The last of all: a folder without it is no store.
    let staged = StagedFile::within_store(&layout.marker())?;
    staged.file()?.write_all(&bytes).map_err(io("output_error.write", &layout.marker()))?;
    staged.publish()?;
    Ok(if shared_disk { vec![on_shared_disk(&layout)] } else { vec![] })
}

/// True for a folder that is empty, or holds no more than what a killed `init` leaves: empty folders, and an index behind them.
fn is_free(layout: &Layout) -> Result<bool, StoreError> {
    let folders = [layout.results(), layout.statements(), layout.pending()];
    let database = database_files(&layout.index());
    let behind_folders = folders.iter().all(|f| f.is_dir());
    for name in names(layout.root())? {
        let path = layout.root().join(&name);
        let is_left = match folders.contains(&path) {
            true => names(&path)?.is_empty(),
            false => is_partial(&name) || (behind_folders && database.contains(&path)),
        };
        if !is_left {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Remark on a store on a disk that its users share.
pub(super) fn on_shared_disk(layout: &Layout) -> Note {
    note!("store.shared_disk", path = layout.root().display().to_string())
}

/// What a folder says that it is.
pub(super) fn marker(layout: &Layout) -> Result<Marker, StoreError> {
    let path = layout.marker();
    let no_store = || StoreError::NoStore(layout.root().to_owned());
    let bytes = match read::bytes(&path) {
        Ok(bytes) => bytes,
        Err(read::ReadError::Io(e)) if e.kind() == std::io::ErrorKind::NotFound => return Err(no_store()),
        Err(source) => return Err(StoreError::Result { path, source }),
    };
    match read::of_format::<Marker>(&bytes, STORE_FORMAT) {
        Ok(marker) => Ok(marker),
        Err(read::ReadError::OtherVersion { found, .. }) => {
            Err(StoreError::LaterStore { path: layout.root().to_owned(), found })
        }
        Err(_) => Err(no_store()),
    }
}
