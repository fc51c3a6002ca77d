//! Numbers of attempts that are being made, so that two tests of a unit at the same time do not take the same one.
//!
//! A number is taken by a file whose process holds a lock on it. The file goes when the result is in the index, or when somebody
//! finds that its process lives no more.

use super::address::sha256;
use super::error::{StoreError, io};
use super::layout::names;
use super::lock::FORGOTTEN_AFTER;
use super::opened::Store;
use sagnac_ingest::open_file;
use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// A number that no other attempt takes as long as this lives.
#[derive(Debug)]
pub struct Reservation {
    /// The number, from 1.
    pub number: u64,
    path: PathBuf,
    _lock: File,
}

impl Drop for Reservation {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.path);
    }
}

impl Store {
    /// The highest number that others have taken for tests of a unit by a procedure. To be asked for before the index: who gives a
    /// number back has its result there.
    pub(super) fn highest_taken(&self, unit: &str, procedure: &str) -> Result<u64, StoreError> {
        let beginning = beginning(unit, procedure);
        let mut highest = 0;
        for name in names(&self.layout.attempts())? {
            let Some(number) = name.strip_prefix(&beginning).and_then(|n| n.parse::<u64>().ok()) else {
                continue;
            };
            let path = self.layout.attempts().join(&name);
            if is_alive(&path) {
                highest = highest.max(number);
            } else {
                let _ = fs::remove_file(&path);
            }
        }
        Ok(highest)
    }

    /// Takes a number that nobody has; to be called by who has the turn.
    pub(super) fn reserve(
        &self,
        unit: &str,
        procedure: &str,
        number: u64,
    ) -> Result<Reservation, StoreError> {
        let folder = self.layout.attempts();
        fs::create_dir_all(&folder).map_err(io("output_error.create_folder", &folder))?;
        let path = folder.join(format!("{}{number}", beginning(unit, procedure)));
        let file = File::create_new(&path).map_err(io("output_error.create", &path))?;
        // Where the file system has no locks, age tells.
        let _ = file.try_lock();
        Ok(Reservation { number, path, _lock: file })
    }
}

/// How the names of the numbers of a unit and a procedure begin.
fn beginning(unit: &str, procedure: &str) -> String {
    format!("{}-", sha256(format!("{unit}\n{procedure}").as_bytes()))
}

/// True where the process that took a number lives, as far as can be told.
fn is_alive(path: &Path) -> bool {
    let Ok(file) = open_file(path) else { return false };
    match file.try_lock() {
        Ok(()) => false,
        Err(TryLockError::WouldBlock) => true,
        Err(TryLockError::Error(_)) => {
            let modified = path.metadata().and_then(|m| m.modified()).ok();
            let age = modified.and_then(|m| SystemTime::now().duration_since(m).ok());
            age.is_none_or(|age| age < FORGOTTEN_AFTER)
        }
    }
}
