//! Locks of a folder of results: one watcher at a time, and one test.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Error, ErrorKind, Result};
use std::path::Path;

/// File that a watcher holds.
pub const WATCHER_LOCK: &str = "watcher.lock";
/// File that the process of a test holds: a test outlives a watcher that was killed.
pub const TEST_LOCK: &str = "test.lock";

/// Takes a lock; `None` where another process holds it. It ends with the file and every copy of it.
///
/// # Errors
/// A file that cannot be made or locked.
pub fn take(path: &Path) -> Result<Option<File>> {
    if path.symlink_metadata().is_ok_and(|m| !m.is_file()) {
        return Err(Error::from(ErrorKind::AlreadyExists));
    }
    let file = OpenOptions::new().create(true).truncate(false).write(true).open(path)?;
    match file.try_lock() {
        Ok(()) => Ok(Some(file)),
        Err(TryLockError::WouldBlock) => Ok(None),
        // A file system without locks: whoever watches takes care.
        Err(TryLockError::Error(e)) if e.kind() == ErrorKind::Unsupported => Ok(Some(file)),
        Err(TryLockError::Error(e)) => Err(e),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_copy_holds_the_lock_too() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(TEST_LOCK);
        let held = take(&path).unwrap().unwrap();
        let copy = held.try_clone().unwrap();
        drop(held);
        assert!(take(&path).unwrap().is_none());
        drop(copy);
        assert!(take(&path).unwrap().is_some());
    }
}
