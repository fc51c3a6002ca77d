//! A file that is copied to another place, with its hash as the proof: its source can be removed only by who holds a copy that
//! was read back from its new place and found to be the same.

use super::checksums::sha256_of_reader;
use super::contained::{NotRead, open_below};
use super::file::StagedFile;
use super::{OutputError, io, parent, sync_folder};
use std::fs::{self, File};
use std::io::{self as system, Read, Write};
use std::path::{Path, PathBuf};

/// Bytes that are copied at a time.
const BLOCK_BYTES: usize = 1 << 20;

/// Why a file was not copied.
#[derive(Debug)]
pub enum TransferError {
    /// The source is missing.
    NoSource(PathBuf),
    /// The source cannot be read, or is no ordinary file.
    Source(PathBuf, system::Error),
    /// The source has other contents than its hash says.
    SourceDiffers(PathBuf),
    /// Something else stands at the target, or what was written there does not read back.
    TargetDiffers(PathBuf),
    /// Source and target are one file.
    Same(PathBuf),
    /// The target cannot be written.
    Target(OutputError),
}

/// A copy that was read back and has the contents that its hash says.
#[derive(Debug)]
pub struct ProvenCopy {
    source: PathBuf,
    target: PathBuf,
    /// True where the copy was made now; false where it was there already.
    pub new: bool,
}

impl ProvenCopy {
    /// Copies a file whose SHA-256 is known. The copy appears whole or not at all. What stands at the target already is read and
    /// stays: it is the copy, or the reason to refuse.
    ///
    /// # Errors
    /// [`TransferError`].
    pub fn make(source: &Path, target: &Path, sha256: &str) -> Result<ProvenCopy, TransferError> {
        let new = target.symlink_metadata().is_err();
        if new {
            copy(source, target)?;
        } else if is_same_file(source, target) {
            return Err(TransferError::Same(source.to_owned()));
        }
        match (hash(target), new) {
            (Ok(found), _) if found == sha256 => {}
            (_, false) => return Err(TransferError::TargetDiffers(target.to_owned())),
            (_, true) => {
                // It was made a moment ago from this source: a source that differs is the likelier cause.
                let source_differs = hash(source).is_ok_and(|found| found != sha256);
                let _ = fs::remove_file(target);
                let source = source.to_owned();
                return Err(match source_differs {
                    true => TransferError::SourceDiffers(source),
                    false => TransferError::TargetDiffers(target.to_owned()),
                });
            }
        }
        Ok(ProvenCopy { source: source.to_owned(), target: target.to_owned(), new })
    }

    /// Where the copy is.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// Removes the source, which another process may have done already.
    ///
    /// # Errors
    /// [`OutputError::Io`].
    pub fn remove_source(self) -> Result<(), OutputError> {
        match fs::remove_file(&self.source) {
            Err(e) if e.kind() != system::ErrorKind::NotFound => Err(io("store_error.move", &self.source)(e)),
            _ => sync_folder(parent(&self.source)),
        }
    }
}

/// An ordinary file, opened without following a link at its name.
fn open(path: &Path) -> Result<File, system::Error> {
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    open_below(parent(path), &name).map_err(|e| match e {
        NotRead::Io(e) => e,
        NotRead::Missing => system::ErrorKind::NotFound.into(),
        NotRead::Outside | NotRead::Link | NotRead::NoFile | NotRead::TooLarge => {
            system::ErrorKind::InvalidInput.into()
        }
    })
}

/// SHA-256 of a file as the disk has it, as far as the system lets its cache be left aside.
fn hash(path: &Path) -> Result<String, system::Error> {
    let file = open(path)?;
    #[cfg(target_os = "linux")]
    let _ = rustix::fs::fadvise(&file, 0, None, rustix::fs::Advice::DontNeed);
    sha256_of_reader(file)
}

fn copy(source: &Path, target: &Path) -> Result<(), TransferError> {
    let unread = |e: system::Error| match e.kind() {
        system::ErrorKind::NotFound => TransferError::NoSource(source.to_owned()),
        _ => TransferError::Source(source.to_owned(), e),
    };
    let mut from = open(source).map_err(unread)?;
    let staged = StagedFile::within_store(target).map_err(TransferError::Target)?;
    let mut to = staged.file().map_err(TransferError::Target)?;
    let mut block = vec![0; BLOCK_BYTES];
    loop {
        let n = match from.read(&mut block) {
            Ok(0) => break,
            Ok(n) => n,
            Err(e) if e.kind() == system::ErrorKind::Interrupted => continue,
            Err(e) => return Err(unread(e)),
        };
        let written = to.write_all(block.get(..n).unwrap_or_default());
        written.map_err(|e| TransferError::Target(staged.refused(e)))?;
    }
    staged.publish().map_err(TransferError::Target)?;
    Ok(())
}

/// True where two paths lead to one file, through links or mounts.
#[cfg(unix)]
fn is_same_file(one: &Path, two: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let of = |path: &Path| path.metadata().ok().map(|m| (m.dev(), m.ino()));
    of(one).is_some_and(|id| of(two) == Some(id))
}

#[cfg(not(unix))]
fn is_same_file(one: &Path, two: &Path) -> bool {
    one.canonicalize().is_ok_and(|id| two.canonicalize().is_ok_and(|other| other == id))
}

#[cfg(test)]
mod tests {
    use super::super::sha256;
    use super::*;

    #[test]
    fn nothing_is_removed_without_a_copy_that_reads_back() {
        let dir = tempfile::tempdir().unwrap();
        let (from, to) = (dir.path().join("from"), dir.path().join("new/to"));
        let whole = vec![7_u8; 3 << 20];
        fs::write(&from, &whole).unwrap();
        fs::create_dir(dir.path().join("new")).unwrap();
        let mut flipped = whole.clone();
        flipped[1 << 20] ^= 1;
        for wrong in [&[][..], &whole[..whole.len() - 1], &flipped] {
            fs::write(&to, wrong).unwrap();
            let refused = ProvenCopy::make(&from, &to, &sha256(&whole));
            assert!(matches!(refused, Err(TransferError::TargetDiffers(_))), "{refused:?}");
            assert_eq!(fs::read(&to).unwrap(), wrong);
        }
        fs::remove_file(&to).unwrap();
        let refused = ProvenCopy::make(&from, &to, &sha256(b"other"));
        assert!(matches!(refused, Err(TransferError::SourceDiffers(_))), "{refused:?}");
        assert!(!to.exists());
        let copy = ProvenCopy::make(&from, &to, &sha256(&whole)).unwrap();
        assert!(copy.new && from.exists());
        copy.remove_source().unwrap();
        assert!(!from.exists() && fs::read(&to).unwrap() == whole);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_to_the_source_is_no_copy_of_it() {
        let dir = tempfile::tempdir().unwrap();
        let (from, to) = (dir.path().join("from"), dir.path().join("to"));
        fs::write(&from, "text").unwrap();
        std::os::unix::fs::symlink(&from, &to).unwrap();
        assert!(matches!(ProvenCopy::make(&from, &to, &sha256(b"text")), Err(TransferError::Same(_))));
        fs::remove_file(&to).unwrap();
        fs::hard_link(&from, &to).unwrap();
        assert!(matches!(ProvenCopy::make(&from, &to, &sha256(b"text")), Err(TransferError::Same(_))));
        assert!(from.exists());
    }
}
