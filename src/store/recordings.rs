//! Copies of recordings, the only part of a store that ever leaves it: recordings are large, and results do not need them.

use super::entry::EntryRecording;
use super::error::StoreError;
use super::index::Filter;
use super::layout::{is_address, names};
use super::opened::Store;
use super::statement::What;
use crate::output::{ProvenCopy, TransferError, outside_stores, remove_abandoned};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

impl Store {
    /// Copies the recordings of a result into the store; gives how many are new there.
    ///
    /// # Errors
    /// [`StoreError::OtherRecording`] where a file is not the one that was evaluated, [`StoreError::OtherCopy`] where the copy has been
    /// changed, and what the disk refuses.
    pub fn keep_recordings(&mut self, address: &str) -> Result<usize, StoreError> {
        self.writable()?;
        let mut kept = 0;
        for recording in self.result(address)?.entry.recordings {
            let Some(target) = self.place_of_copy(&recording) else { continue };
            // The user may have named it by a link.
            let named = PathBuf::from(&recording.path);
            let source = named.canonicalize().unwrap_or(named);
            let copy = ProvenCopy::make(&source, &target, &recording.sha256)?;
            kept += usize::from(copy.new);
        }
        Ok(kept)
    }

    /// Where the copy of a recording stands; `None` for one without a hash.
    fn place_of_copy(&self, recording: &EntryRecording) -> Option<PathBuf> {
        let name = Path::new(&recording.path).file_name()?;
        is_address(&recording.sha256).then(|| self.layout.recordings().join(&recording.sha256).join(name))
    }

    /// Moves the copies of recordings into another folder, but for those of results that were evaluated at a moment or later.
    /// The new places are stated; a copy goes only when it was read back whole at its new place. Gives how many were moved.
    ///
    /// # Errors
    /// [`StoreError::InsideStore`] for a folder that lies in a store, [`StoreError::OtherRecording`] where a copy has been changed,
    /// [`StoreError::OtherCopy`] where something else stands at its new place, and what the disks refuse.
    pub fn prune(&mut self, to: &Path, since: Option<&str>, stated_at: &str) -> Result<usize, StoreError> {
        self.writable()?;
        let stay: BTreeSet<String> = match since {
            None => BTreeSet::new(),
            Some(since) => {
                let filter = Filter { since: Some(since.to_owned()), ..Filter::default() };
                let late = self.attempts(&filter)?;
                late.into_iter().flat_map(|a| a.entry.recordings).map(|r| r.sha256).collect()
            }
        };
        // Said before anything is made or moved, also where there is nothing to move.
        outside(&to.join("copy"), to)?;
        let mut moved = 0;
        for hash in
            names(&self.layout.recordings())?.into_iter().filter(|n| is_address(n) && !stay.contains(n))
        {
            let folder = self.layout.recordings().join(&hash);
            remove_abandoned(&folder);
            for name in self.layout.copies(&hash)? {
                let target = to.join(&hash).join(&name);
                // A link below the target could lead back.
                outside(&target, to)?;
                let copy = match ProvenCopy::make(&folder.join(&name), &target, &hash) {
                    // Another has moved it meanwhile.
                    Err(TransferError::NoSource(_)) => continue,
                    made => made?,
                };
                let path = std::path::absolute(copy.target()).unwrap_or(target).display().to_string();
                self.state(What::Place { sha256: hash.clone(), path }, stated_at.to_owned())?;
                copy.remove_source()?;
                moved += 1;
            }
            // Stays where another puts a copy into it.
            let _ = fs::remove_dir(&folder);
        }
        Ok(moved)
    }
}

/// Refuses a place in a store, whatever links lead there.
fn outside(place: &Path, to: &Path) -> Result<(), StoreError> {
    outside_stores(place).map_err(|_| StoreError::InsideStore(to.to_owned()))
}
