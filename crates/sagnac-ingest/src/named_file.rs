//! Files that a user names, opened and read within bounds: a pipe would wait for a writer, and a device such as `/dev/zero` never
//! ends.

use std::fmt;
use std::fs::File;
use std::io::{Error, ErrorKind, Read, Result};
use std::path::Path;

/// Why a file is not read although the operating system would.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileFault {
    /// A pipe, a socket or a device.
    Special,
    /// More than `most` bytes.
    TooLarge {
        /// Bytes that are read at most.
        most: u64,
    },
}

impl FileFault {
    /// The fault in an error of [`open_file`] or [`read_file`].
    pub fn of(error: &Error) -> Option<FileFault> {
        error.get_ref().and_then(|e| e.downcast_ref()).copied()
    }
}

impl fmt::Display for FileFault {
    /// In English.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FileFault::Special => f.write_str("a pipe or a device, not a file"),
            FileFault::TooLarge { most } => write!(f, "more than {most} bytes"),
        }
    }
}

impl std::error::Error for FileFault {}

impl From<FileFault> for Error {
    fn from(fault: FileFault) -> Error {
        Error::new(ErrorKind::InvalidInput, fault)
    }
}

/// Opens a file. What is neither a file nor a folder is refused before it is opened; a folder is refused when it is read.
///
/// # Errors
/// What the operating system says, and [`FileFault::Special`].
pub fn open_file(path: &Path) -> Result<File> {
    if is_special(&path.metadata()?) {
        return Err(FileFault::Special.into());
    }
    let file = File::open(path)?;
    // Another one may stand there by now.
    if is_special(&file.metadata()?) { Err(FileFault::Special.into()) } else { Ok(file) }
}

fn is_special(metadata: &std::fs::Metadata) -> bool {
    !metadata.is_file() && !metadata.is_dir()
}

/// The bytes of a file, of which there are at most `most`.
///
/// # Errors
/// As [`open_file`], and [`FileFault::TooLarge`].
pub fn read_file(path: &Path, most: u64) -> Result<Vec<u8>> {
    let mut bytes = vec![];
    open_file(path)?.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most { Err(FileFault::TooLarge { most }.into()) } else { Ok(bytes) }
}

/// As [`read_file`], of text in UTF-8.
///
/// # Errors
/// As [`read_file`], and [`ErrorKind::InvalidData`].
pub fn read_text(path: &Path, most: u64) -> Result<String> {
    String::from_utf8(read_file(path, most)?).map_err(|e| Error::new(ErrorKind::InvalidData, e))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_read_up_to_its_bound() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        std::fs::write(&path, "text").unwrap();
        assert_eq!(read_file(&path, 4).unwrap(), b"text");
        assert_eq!(read_text(&path, 4).unwrap(), "text");
        let error = read_file(&path, 3).unwrap_err();
        assert_eq!(FileFault::of(&error), Some(FileFault::TooLarge { most: 3 }));
        let error = read_file(folder.path(), 3).unwrap_err();
        assert_eq!(FileFault::of(&error), None);
    }

    #[cfg(unix)]
    #[test]
    fn pipes_and_devices_are_not_opened() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        for path in [pipe.as_path(), Path::new("/dev/zero")] {
            for error in [open_file(path).unwrap_err(), read_file(path, 3).unwrap_err()] {
                assert_eq!(FileFault::of(&error), Some(FileFault::Special), "{}", path.display());
            }
        }
    }
}
