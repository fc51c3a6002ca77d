//! Files below a folder that somebody else filled: reached without following a link, and opened only where they are ordinary
//! files. A pipe would wait for a writer, a device never ends, and a link leads to where its maker likes.

use super::checksums::sha256_of_reader;
use super::is_plain;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// What stands at a name in a folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Found {
    /// An ordinary file.
    File,
    /// A folder with nothing in it.
    EmptyFolder,
    /// A link to a file or folder.
    Link,
    /// A pipe, a socket or a device.
    Special,
}

/// Why a file below a folder was not read.
#[derive(Debug)]
pub enum NotRead {
    /// The name is absolute, leads out of the folder, or is no plain path.
    Outside,
    /// Nothing stands there.
    Missing,
    /// A part of the path is a link.
    Link,
    /// It is no ordinary file.
    NoFile,
    /// It has more bytes than may be read.
    TooLarge,
    /// The operating system refused.
    Io(io::Error),
}

impl From<io::Error> for NotRead {
    fn from(error: io::Error) -> NotRead {
        match error.kind() {
            io::ErrorKind::NotFound | io::ErrorKind::NotADirectory => NotRead::Missing,
            _ => NotRead::Io(error),
        }
    }
}

/// Opens an ordinary file by its name below a folder, which itself may be reached through links.
///
/// # Errors
/// [`NotRead`].
pub fn open_below(root: &Path, name: &str) -> Result<File, NotRead> {
    if !is_plain(name) {
        return Err(NotRead::Outside);
    }
    let mut path = root.to_owned();
    for part in Path::new(name).components() {
        path.push(part);
        // Looked at part by part, so that it can be said what is in the way; the opening below does not rely on it.
        if path.symlink_metadata()?.file_type().is_symlink() {
            return Err(NotRead::Link);
        }
    }
    let file = open_without_links(root, name)?;
    if file.metadata()?.is_file() { Ok(file) } else { Err(NotRead::NoFile) }
}

/// Opens a path below a folder; no part of it may be a link, and a pipe without a writer does not block.
#[cfg(target_os = "linux")]
fn open_without_links(root: &Path, name: &str) -> io::Result<File> {
    use rustix::fs::{Mode, OFlags, openat};
    let mut at: std::os::fd::OwnedFd = File::open(root)?.into();
    let mut parts = Path::new(name).components().peekable();
    while let Some(part) = parts.next() {
        let kind = if parts.peek().is_some() { OFlags::DIRECTORY } else { OFlags::NONBLOCK };
        let flags = OFlags::RDONLY | OFlags::NOFOLLOW | OFlags::CLOEXEC | kind;
        at = openat(&at, part.as_os_str(), flags, Mode::empty())?;
    }
    Ok(at.into())
}

/// Elsewhere, what was looked at before is opened if it is a file.
#[cfg(not(target_os = "linux"))]
fn open_without_links(root: &Path, name: &str) -> io::Result<File> {
    let path = root.join(name);
    if path.symlink_metadata()?.is_file() {
        File::open(path)
    } else {
        Err(io::ErrorKind::InvalidInput.into())
    }
}

/// Reads an ordinary file below a folder, of at most `most` bytes.
///
/// # Errors
/// [`NotRead`].
pub fn read_below(root: &Path, name: &str, most: u64) -> Result<Vec<u8>, NotRead> {
    let mut bytes = vec![];
    open_below(root, name)?.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most { Err(NotRead::TooLarge) } else { Ok(bytes) }
}

/// SHA-256 of an ordinary file below a folder, of whatever size.
///
/// # Errors
/// [`NotRead`].
pub fn sha256_below(root: &Path, name: &str) -> Result<String, NotRead> {
    Ok(sha256_of_reader(open_below(root, name)?)?)
}

/// Everything below a folder by its name, in the order of the names: files, empty folders, and what should not be there. Links are
/// named and not followed.
///
/// # Errors
/// A folder that cannot be read.
pub fn found_below(root: &Path) -> io::Result<Vec<(String, Found)>> {
    let mut found = vec![];
    let mut open: Vec<(PathBuf, String)> = vec![(root.to_owned(), String::new())];
    while let Some((folder, before)) = open.pop() {
        let mut is_empty = true;
        for entry in fs::read_dir(&folder)? {
            let entry = entry?;
            is_empty = false;
            let name = format!("{before}{}", entry.file_name().to_string_lossy());
            let kind = entry.file_type()?;
            if kind.is_dir() {
                open.push((entry.path(), format!("{name}/")));
            } else if kind.is_symlink() {
                found.push((name, Found::Link));
            } else if kind.is_file() {
                found.push((name, Found::File));
            } else {
                found.push((name, Found::Special));
            }
        }
        if is_empty && !before.is_empty() {
            found.push((before.trim_end_matches('/').to_owned(), Found::EmptyFolder));
        }
    }
    found.sort_by(|a, b| a.0.cmp(&b.0));
    Ok(found)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;

    #[test]
    fn only_ordinary_files_inside_are_read() {
        let (inside, outside) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let root = inside.path();
        fs::create_dir_all(root.join("a/b")).unwrap();
        fs::create_dir(root.join("empty")).unwrap();
        fs::write(root.join("a/b/file"), "text").unwrap();
        fs::write(outside.path().join("file"), "secret").unwrap();
        symlink(outside.path().join("file"), root.join("link")).unwrap();
        symlink(outside.path(), root.join("folder-link")).unwrap();
        symlink(root.join("a"), root.join("inner-link")).unwrap();
        let made = std::process::Command::new("mkfifo").arg(root.join("pipe")).status().unwrap();
        assert!(made.success());
        assert_eq!(read_below(root, "a/b/file", 4).unwrap(), b"text");
        assert!(matches!(read_below(root, "a/b/file", 3), Err(NotRead::TooLarge)));
        for name in ["link", "folder-link/file", "inner-link/b/file"] {
            assert!(matches!(open_below(root, name), Err(NotRead::Link)), "{name}");
        }
        for name in ["pipe", "a/b"] {
            assert!(matches!(open_below(root, name), Err(NotRead::NoFile)), "{name}");
        }
        for name in ["missing", "a/b/file/more"] {
            assert!(matches!(open_below(root, name), Err(NotRead::Missing)), "{name}");
        }
        let absolute = outside.path().join("file").display().to_string();
        for name in ["", "../x", "a/../../x", "./a", absolute.as_str()] {
            assert!(matches!(open_below(root, name), Err(NotRead::Outside)), "{name}");
        }
        let names: Vec<(String, Found)> = found_below(root).unwrap();
        let expected = [
            ("a/b/file", Found::File),
            ("empty", Found::EmptyFolder),
            ("folder-link", Found::Link),
            ("inner-link", Found::Link),
            ("link", Found::Link),
            ("pipe", Found::Special),
        ];
        assert_eq!(names, expected.map(|(name, found)| (name.to_owned(), found)));
    }
}
