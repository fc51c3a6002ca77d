//! The lock of a store, and whether its disk is shared between machines.
//!
//! Whoever uses the index holds the lock together with others; whoever replaces or migrates it holds it alone. On a disk
//! that has no shared memory between its users, the write-ahead log of the database cannot be had: there, who writes holds
//! the lock alone too.

use super::error::{StoreError, io};
use std::fs::{File, OpenOptions, TryLockError};
use std::io::ErrorKind;
use std::path::Path;
use std::time::{Duration, Instant};

/// Time for which others may hold the lock, or a transaction of the database.
pub(super) const LOCK_TIMEOUT: Duration = Duration::from_secs(60);
/// Time after which an entry that a process listed and did not finish is forgotten, where no lock tells: none takes as long.
pub(super) const FORGOTTEN_AFTER: Duration = Duration::from_secs(24 * 3600);
/// Pause between two attempts.
const RETRY_PAUSE: Duration = Duration::from_millis(5);

/// With whom the lock is held.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Sharing {
    /// Together with others.
    Together,
    /// Alone.
    Alone,
}

/// The lock, held until it is dropped.
#[derive(Debug)]
pub(super) struct Lock {
    _file: File,
}

/// Takes the lock.
///
/// # Errors
/// [`StoreError::ReadOnly`] where nothing can be written, [`StoreError::Busy`] where others hold it for too long.
pub(super) fn take(path: &Path, sharing: Sharing) -> Result<Lock, StoreError> {
    let opened = OpenOptions::new().create(true).truncate(false).write(true).open(path);
    let file = opened.map_err(|e| match e.kind() {
        ErrorKind::ReadOnlyFilesystem | ErrorKind::PermissionDenied => {
            StoreError::ReadOnly(path.parent().unwrap_or(path).to_owned())
        }
        _ => io("output_error.create", path)(e),
    })?;
    let began = Instant::now();
    loop {
        let tried = match sharing {
            Sharing::Together => file.try_lock_shared(),
            Sharing::Alone => file.try_lock(),
        };
        match tried {
            Ok(()) => return Ok(Lock { _file: file }),
            Err(TryLockError::WouldBlock) if began.elapsed() < LOCK_TIMEOUT => {
                std::thread::sleep(RETRY_PAUSE)
            }
            Err(TryLockError::WouldBlock) => return Err(StoreError::Busy(path.to_owned())),
            // A file system without locks: its transactions are all there is.
            Err(TryLockError::Error(e)) if e.kind() == ErrorKind::Unsupported => {
                return Ok(Lock { _file: file });
            }
            Err(TryLockError::Error(e)) => return Err(io("store_error.lock", path)(e)),
        }
    }
}

/// True for a file system between machines, on which the users of a database share no memory.
#[cfg(target_os = "linux")]
pub(super) fn is_shared_disk(path: &Path) -> bool {
    /// NFS, SMB, CIFS, SMB2, 9P, AFS, Ceph, Lustre, GFS2, OCFS2 and FUSE, by the numbers of `statfs(2)`.
    const NETWORK_FILE_SYSTEMS: [u32; 11] = [
        0x6969,
        0x517B,
        0xFF53_4D42,
        0xFE53_4D42,
        0x0102_1997,
        0x5346_414F,
        0x00C3_6400,
        0x0BD0_0BD0,
        0x0116_1970,
        0x7461_636F,
        0x6573_5546,
    ];
    // The number has 32 bits, whatever the type of the field is on a machine.
    rustix::fs::statfs(path).is_ok_and(|s| NETWORK_FILE_SYSTEMS.contains(&(s.f_type as u32)))
}

/// Elsewhere the answer of the database decides.
#[cfg(not(target_os = "linux"))]
pub(super) fn is_shared_disk(_: &Path) -> bool {
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lock_is_held_together_or_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lock");
        let together = [Sharing::Together; 2].map(|s| take(&path, s).unwrap());
        assert!(matches!(File::open(&path).unwrap().try_lock(), Err(TryLockError::WouldBlock)));
        drop(together);
        let _alone = take(&path, Sharing::Alone).unwrap();
        assert!(matches!(File::open(&path).unwrap().try_lock_shared(), Err(TryLockError::WouldBlock)));
    }
}
