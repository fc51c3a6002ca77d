//! A single file that appears whole or not at all.

use super::{OutputError, io, parent};
use std::fs::File;
use std::path::{Path, PathBuf};

/// A file in the making. Dropped without [`StagedFile::publish`], it leaves nothing behind.
#[derive(Debug)]
pub struct StagedFile {
    target: PathBuf,
    staging: tempfile::NamedTempFile,
}

impl StagedFile {
    /// Begins a file that will appear at `target`. A file there is replaced on publication; a folder, a link or a
    /// device is refused now, before any work is done.
    ///
    /// # Errors
    /// [`OutputError`] when the place cannot be written or is taken.
    pub fn begin(target: &Path) -> Result<StagedFile, OutputError> {
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
        let folder = parent(target);
        std::fs::create_dir_all(folder).map_err(io("output_error.create_folder", folder))?;
        let prefix = format!(".{}.partial-", name.to_string_lossy());
        let mut builder = tempfile::Builder::new();
        builder.prefix(&prefix);
        // The usual rights under the user's umask, not those of a private scratch.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let staging = builder.tempfile_in(folder).map_err(io("output_error.write_into", folder))?;
        Ok(StagedFile { target: target.to_owned(), staging })
    }

    /// Where the bytes go.
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

    /// Puts the file in its place in one step.
    ///
    /// # Errors
    /// [`OutputError::Io`] when the place cannot be written.
    pub fn publish(self) -> Result<PathBuf, OutputError> {
        self.staging.as_file().sync_all().map_err(io("output_error.sync", &self.target))?;
        let put = self.staging.persist(&self.target);
        put.map_err(|e| io("output_error.put_in_place", &self.target)(e.error))?;
        super::sync_folder(parent(&self.target))?;
        Ok(self.target)
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
            let staged = StagedFile::begin(&target).unwrap();
            staged.file().unwrap().write_all(text.as_bytes()).unwrap();
            staged.publish().unwrap();
            assert_eq!(std::fs::read_to_string(&target).unwrap(), text);
        }
        let dropped = StagedFile::begin(&target).unwrap();
        dropped.file().unwrap().write_all(b"half").unwrap();
        drop(dropped);
        assert_eq!(std::fs::read_to_string(&target).unwrap(), "second");
        assert_eq!(std::fs::read_dir(folder.path().join("new")).unwrap().count(), 1);
    }

    #[test]
    fn what_is_no_file_is_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        assert!(matches!(StagedFile::begin(folder.path()), Err(OutputError::InTheWay { .. })));
        assert!(matches!(StagedFile::begin(Path::new("..")), Err(OutputError::NoName(_))));
    }
}
