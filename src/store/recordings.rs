//! Copies of recordings, the only part of a store that ever leaves it: recordings are large, and results do not need them.

use super::entry::EntryRecording;
use super::error::{StoreError, io};
use super::index::Filter;
use super::layout::{is_address, names};
use super::opened::Store;
use super::statement::What;
use crate::output::StagedFile;
use sha2::{Digest, Sha256};
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

/// Bytes that are copied at a time.
const BLOCK: usize = 1 << 20;

impl Store {
    /// Copies the recordings of a result into the store; gives how many are new there.
    ///
    /// # Errors
    /// [`StoreError::OtherRecording`] where a file is not the one that was evaluated, and what the disk refuses.
    pub fn keep_recordings(&mut self, address: &str) -> Result<usize, StoreError> {
        self.writable()?;
        let mut kept = 0;
        for recording in self.result(address)?.entry.recordings {
            let Some(target) = self.place_of_copy(&recording) else { continue };
            if !target.exists() {
                copy(Path::new(&recording.path), &target, &recording.sha256)?;
                kept += 1;
            }
        }
        Ok(kept)
    }

    /// Where the copy of a recording stands; `None` for one without a hash.
    fn place_of_copy(&self, recording: &EntryRecording) -> Option<PathBuf> {
        let name = Path::new(&recording.path).file_name()?;
        is_address(&recording.sha256).then(|| self.layout.recordings().join(&recording.sha256).join(name))
    }

    /// Moves the copies of recordings into another folder, but for those of results that were evaluated at a moment or later.
    /// The new places are stated; a copy goes only when it is whole at its new place. Gives how many were moved.
    ///
    /// # Errors
    /// [`StoreError::OtherRecording`] where a copy has been changed, and what the disks refuse.
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
        let mut moved = 0;
        for hash in
            names(&self.layout.recordings())?.into_iter().filter(|n| is_address(n) && !stay.contains(n))
        {
            let folder = self.layout.recordings().join(&hash);
            for name in names(&folder)? {
                let (from, target) = (folder.join(&name), to.join(&hash).join(&name));
                if !target.exists() {
                    copy(&from, &target, &hash)?;
                }
                let path = std::path::absolute(&target).unwrap_or(target).display().to_string();
                self.state(What::Place { sha256: hash.clone(), path }, stated_at.to_owned())?;
                fs::remove_file(&from).map_err(io("store_error.move", &from))?;
                moved += 1;
            }
            fs::remove_dir(&folder).map_err(io("store_error.move", &folder))?;
        }
        Ok(moved)
    }
}

/// Copies a file whose hash is known; the copy appears whole or not at all.
fn copy(from: &Path, to: &Path, sha256: &str) -> Result<(), StoreError> {
    let mut source = File::open(from).map_err(io("store_error.unreadable", from))?;
    let staged = StagedFile::begin(to, &[], false)?;
    let mut target = staged.file()?;
    let (mut hash, mut block) = (Sha256::new(), vec![0; BLOCK]);
    loop {
        let n = source.read(&mut block).map_err(io("store_error.unreadable", from))?;
        if n == 0 {
            break;
        }
        let part = block.get(..n).unwrap_or_default();
        hash.update(part);
        target.write_all(part).map_err(|e| staged.refused(e))?;
    }
    let found = hash.finalize().iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    });
    if found != sha256 {
        return Err(StoreError::OtherRecording(from.to_owned()));
    }
    staged.publish()?;
    Ok(())
}
