//! A single file that appears whole or not at all.

use super::partial::{self, Partial};
use super::{OutputError, io, outside_file, outside_stores, parent};
use crate::i18n::note;
use std::fs::File;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

/// A file in the making. Dropped without [`StagedFile::publish`], it leaves nothing behind.
#[derive(Debug)]
pub struct StagedFile {
    target: PathBuf,
    staging: Partial<tempfile::NamedTempFile>,
    force: bool,
}

impl StagedFile {
    /// Begins a file that will appear at `target`. A file there is replaced on publication where `force` is given or
    /// it holds the same; a folder, a link, a device or a file of `read` is refused now, before any work is done.
    ///
    /// # Errors
    /// [`OutputError`] when the place cannot be written or is taken.
    pub fn begin(target: &Path, read: &[PathBuf], force: bool) -> Result<StagedFile, OutputError> {
        outside_stores(target)?;
        StagedFile::begin_anywhere(target, read, force)
    }

    /// Begins a file that will appear at `target`, which may lie in a store: for what a store itself writes. A file there stays,
    /// unless it holds the same.
    ///
    /// # Errors
    /// As [`StagedFile::begin`].
    pub fn within_store(target: &Path) -> Result<StagedFile, OutputError> {
        StagedFile::begin_anywhere(target, &[], false)
    }

    fn begin_anywhere(target: &Path, read: &[PathBuf], force: bool) -> Result<StagedFile, OutputError> {
        let Some(name) = target.file_name() else {
            return Err(OutputError::NoName(target.to_owned()));
        };
        if let Ok(found) = target.symlink_metadata()
            && !found.is_file()
        {
            let why = if found.is_dir() {
                "output_file.folder"
            } else if found.is_symlink() {
                "output_error.why.link"
            } else {
                "output_file.no_file"
            };
            return Err(OutputError::InTheWay { path: target.to_owned(), why: why.into() });
        }
        outside_file(target, read)?;
        let folder = parent(target);
        std::fs::create_dir_all(folder).map_err(io("output_error.create_folder", folder))?;
        partial::remove_abandoned(folder);
        let prefix = partial::prefix(&name.to_string_lossy());
        let mut builder = tempfile::Builder::new();
        builder.prefix(&prefix);
        // The usual rights under the user's umask, not those of a private scratch.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let staging =
            Partial::begin(|| builder.tempfile_in(folder)).map_err(io("output_error.write_into", folder))?;
        Ok(StagedFile { target: target.to_owned(), staging, force })
    }

    /// The path that the file will have.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// The file that the bytes go to.
    ///
    /// # Errors
    /// [`OutputError::Io`] when the file cannot be opened once more.
    pub fn file(&self) -> Result<File, OutputError> {
        self.staging.as_file().try_clone().map_err(io("output_error.create", &self.target))
    }

    /// The error of writing into it.
    pub fn refused(&self, source: std::io::Error) -> OutputError {
        io("output_error.write", &self.target)(source)
    }

    /// Writes all of the file, and puts it in its place.
    ///
    /// # Errors
    /// [`OutputError::Io`] when it cannot be written, or as [`StagedFile::publish`].
    pub fn publish_with(self, contents: &[u8]) -> Result<PathBuf, OutputError> {
        self.file()?.write_all(contents).map_err(|e| self.refused(e))?;
        self.publish()
    }

    /// Puts the file in its place in one step.
    ///
    /// # Errors
    /// [`OutputError::Io`] when the place cannot be written.
    pub fn publish(self) -> Result<PathBuf, OutputError> {
        self.staging.as_file().sync_all().map_err(io("output_error.sync", &self.target))?;
        if !self.force && self.target.symlink_metadata().is_ok() {
            let same =
                equal(self.staging.path(), &self.target).map_err(io("output_error.look_at", &self.target))?;
            if !same {
                let why = note!("output_file.other");
                return Err(OutputError::InTheWay { path: self.target, why });
            }
        }
        let (staging, _entry) = self.staging.into_parts();
        let put = staging.persist(&self.target);
        put.map_err(|e| io("output_error.put_in_place", &self.target)(e.error))?;
        super::sync_folder(parent(&self.target))?;
        Ok(self.target)
    }
}

/// True when two files hold the same.
fn equal(one: &Path, two: &Path) -> std::io::Result<bool> {
    let (mut one, mut two) = (File::open(one)?, File::open(two)?);
    if one.metadata()?.len() != two.metadata()?.len() {
        return Ok(false);
    }
    let (mut a, mut b) = (vec![0; 1 << 16], vec![0; 1 << 16]);
    loop {
        let n = one.read(&mut a)?;
        if n == 0 {
            return Ok(true);
        }
        match two.read_exact(b.get_mut(..n).unwrap_or_default()) {
            Ok(()) if a.get(..n) == b.get(..n) => {}
            Ok(()) => return Ok(false),
            Err(e) if e.kind() == std::io::ErrorKind::UnexpectedEof => return Ok(false),
            Err(e) => return Err(e),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    #[test]
    fn a_file_appears_whole_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("new/a.csv");
        for text in ["first", "second"] {
            let staged = StagedFile::begin(&target, &[], true).unwrap();
            staged.file().unwrap().write_all(text.as_bytes()).unwrap();
            staged.publish().unwrap();
            assert_eq!(std::fs::read_to_string(&target).unwrap(), text);
        }
        for (text, taken) in [("second", true), ("third!", false)] {
            let unasked = StagedFile::begin(&target, &[], false).unwrap();
            unasked.file().unwrap().write_all(text.as_bytes()).unwrap();
            assert_eq!(unasked.publish().is_ok(), taken, "{text}");
            assert_eq!(std::fs::read_to_string(&target).unwrap(), "second");
        }
        let read = [target.clone()];
        assert!(matches!(StagedFile::begin(&target, &read, true), Err(OutputError::InputInside { .. })));
        let dropped = StagedFile::begin(&target, &[], true).unwrap();
        dropped.file().unwrap().write_all(b"half").unwrap();
        drop(dropped);
        assert_eq!(std::fs::read_to_string(&target).unwrap(), "second");
        assert_eq!(std::fs::read_dir(folder.path().join("new")).unwrap().count(), 1);
    }

    #[test]
    fn what_is_no_file_is_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        assert!(matches!(StagedFile::begin(folder.path(), &[], true), Err(OutputError::InTheWay { .. })));
        assert!(matches!(StagedFile::begin(Path::new(".."), &[], true), Err(OutputError::NoName(_))));
    }
}
