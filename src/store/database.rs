//! The files of a database on disk.

use super::error::{StoreError, io};
use std::fs;
use std::path::{Path, PathBuf};

/// A database and the files that it keeps beside it.
pub(super) fn database_files(path: &Path) -> Vec<PathBuf> {
    let with = |ending: &str| {
        let mut name = path.as_os_str().to_owned();
        name.push(ending);
        PathBuf::from(name)
    };
    ["", "-wal", "-shm", "-journal"].map(with).to_vec()
}

/// Removes a database, and what it keeps beside it after that.
pub(super) fn remove_database(path: &Path) -> Result<(), StoreError> {
    for file in database_files(path) {
        match fs::remove_file(&file) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
                return Err(io("output_error.write", path)(e));
            }
            _ => {}
        }
    }
    Ok(())
}
