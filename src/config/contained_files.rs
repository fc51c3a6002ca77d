//! Files that a file names: they stand in its folder or below it, and no path, drive or link leads out.
//!
//! One rule for a manifest, for the phases and the model of a procedure and for layouts. What the rule refuses is not
//! opened, so that no diagnostic shows a line of it. Paths of the command line are the user's own.

use super::diagnostics::Span;
use super::reader::Reader;
use crate::i18n::{Note, io_reason};
use std::io::ErrorKind;
use std::path::{Component, Path, PathBuf};

/// A file that may be opened.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct ContainedFile {
    /// Path as it can be opened.
    pub path: PathBuf,
    /// Where it really is.
    pub canonical: PathBuf,
}

/// The folder of a file; that of the program where the path has none.
pub(crate) fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// A path as written, relative to a folder.
pub(crate) fn joined(folder: &Path, text: &str) -> PathBuf {
    if folder == Path::new(".") || folder.as_os_str().is_empty() {
        PathBuf::from(text)
    } else {
        folder.join(text)
    }
}

/// True when a path as written cannot lead out of the folder it starts from; reports what is wrong with it.
pub(crate) fn stays(text: &str, at: &Span, reader: &mut Reader<'_>) -> bool {
    let drive = text.as_bytes().get(1) == Some(&b':');
    let key = if Path::new(text).is_absolute() || text.starts_with(['/', '\\']) || drive {
        "inside.absolute"
    } else if text.split(['/', '\\']).any(|part| part == "..") {
        "inside.leaves"
    } else if text.contains('\\') {
        "inside.backslash"
    } else if Path::new(text).components().any(|c| !matches!(c, Component::Normal(_) | Component::CurDir)) {
        "inside.leaves"
    } else {
        return true;
    };
    reader.error(at, Note::new(key).with("path", text), Some("inside.help.inside".into()));
    false
}

/// An ordinary file in a folder or below it; `None` when a problem was reported.
pub(crate) fn file(text: &str, folder: &Path, at: &Span, reader: &mut Reader<'_>) -> Option<ContainedFile> {
    if !stays(text, at, reader) {
        return None;
    }
    let path = joined(folder, text);
    let about = |key: &'static str| Note::new(key).with("path", text);
    let canonical = match path.canonicalize() {
        Ok(canonical) => canonical,
        Err(e) if e.kind() == ErrorKind::NotFound => {
            reader.error(at, about("inside.missing"), Some("inside.help.missing".into()));
            return None;
        }
        Err(e) => {
            reader.error(at, about("inside.unreadable").with("reason", io_reason(&e)), None);
            return None;
        }
    };
    let home = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    let (key, help) = if !canonical.starts_with(&home) {
        ("inside.link_leaves", "inside.help.inside")
    } else if canonical.is_dir() {
        ("inside.folder", "inside.help.folder")
    } else if !canonical.is_file() {
        ("inside.no_file", "inside.help.inside")
    } else {
        return Some(ContainedFile { path, canonical });
    };
    reader.error(at, about(key), Some(help.into()));
    None
}
