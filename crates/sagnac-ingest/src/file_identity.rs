//! Whether a path still leads to the file that was opened, as it was then.
//!
//! A recording is read more than once: for its clock, for its values, for its hash. A file that is replaced or written
//! to in between would give figures of one recording under the hash of another, and its size need not tell.

use super::byte_stream::io_error;
use super::{IngestError, IngestErrorKind};
use std::fs::Metadata;
use std::path::Path;
use std::time::SystemTime;

/// What tells one state of a file from another.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct FileIdentity {
    bytes: u64,
    modified: Option<SystemTime>,
    /// Device and number of the file on it, where the system has them.
    place: Option<(u64, u64)>,
}

impl FileIdentity {
    pub(super) fn of(metadata: &Metadata) -> FileIdentity {
        #[cfg(unix)]
        let place = {
            use std::os::unix::fs::MetadataExt;
            Some((metadata.dev(), metadata.ino()))
        };
        #[cfg(not(unix))]
        let place = None;
        FileIdentity { bytes: metadata.len(), modified: metadata.modified().ok(), place }
    }

    /// Refuses a file that is not what it was.
    ///
    /// # Errors
    /// [`IngestErrorKind::Changed`].
    pub(super) fn check_unchanged(&self, path: &Path) -> Result<(), IngestError> {
        let changed = |what: &'static str| {
            Err(IngestError::new(IngestErrorKind::Changed, path, what).hint("ingest.hint.wait"))
        };
        let now = match std::fs::metadata(path) {
            Ok(metadata) => FileIdentity::of(&metadata),
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => return changed("ingest.identity.gone"),
            Err(e) => return Err(io_error(path, &e)),
        };
        if now == *self {
            return Ok(());
        }
        changed(if now.place == self.place {
            "ingest.identity.written_to"
        } else {
            "ingest.identity.replaced"
        })
    }
}
