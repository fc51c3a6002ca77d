//! A file of keys as text: the bound on its size, UTF-8, the byte order mark, and what keeps it from being read.

use super::diagnostics::{Problem, Problems, SourceText};
use super::shipped;
use crate::i18n::{Note, io_reason, note};
use sagnac_core::spelling::nearest;
use sagnac_ingest::open_file;
use std::io::{ErrorKind, Read};
use std::path::Path;

/// Largest file that is taken, bytes. A procedure is a few kilobytes.
const MAX_BYTES: usize = 1 << 20;

/// The byte order mark of UTF-8; it is no part of the text.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Most names of a folder among which a similar one is looked for.
const MAX_NAMES: usize = 1000;

/// Most bytes that are read: enough to know that a file is too large.
const MAX_READ_BYTES: u64 = (MAX_BYTES + BYTE_ORDER_MARK.len() + 1) as u64;

/// The sentences about a file of one kind that cannot be read at all, by their keys.
pub(crate) struct Wording {
    /// The file system refuses it; takes the `reason`.
    pub unreadable: &'static str,
    /// It is a folder.
    pub folder: &'static str,
}

/// The bytes of a file, one more than allowed at the most.
///
/// # Errors
/// One problem without a place.
pub(crate) fn bytes(path: &Path, wording: &Wording) -> Result<Vec<u8>, Problems> {
    let name = path.display().to_string();
    if path.is_dir() && shipped::find(path).is_none() {
        return Err(Problem::of_file(&name, wording.folder, None).into());
    }
    read(path).map_err(|e| {
        let help = (e.kind() == ErrorKind::NotFound).then(|| help(path));
        let message = Note::new(wording.unreadable).with("reason", io_reason(&e));
        Problem::of_file(&name, message, help).into()
    })
}

/// The text of a file, to tell what kind it is; `None` where it cannot be read: reading it says why.
pub(crate) fn peek(path: &Path) -> Option<String> {
    read(path).ok().map(|bytes| String::from_utf8_lossy(&bytes).into_owned())
}

/// The advice where a file is not there: the nearest name among the files beside it and, for a plain name, the shipped ones; else
/// where to look.
fn help(path: &Path) -> Note {
    if let Some(near) = nearest_file(path) {
        return note!("keyed.help.did_you_mean", name = near);
    }
    if path.extension().is_some() || path.components().count() > 1 {
        return "text_file.check_path".into();
    }
    let names = |list: &[shipped::Shipped]| list.iter().map(|s| s.name).collect::<Vec<_>>().join(", ");
    note!(
        "text_file.check_name",
        procedures = names(shipped::SHIPPED_PROCEDURES),
        limits = names(shipped::SHIPPED_LIMITS)
    )
}

/// The file of the most similar name, as a path that can be given in place of the wrong one.
fn nearest_file(path: &Path) -> Option<String> {
    let name = path.file_name()?.to_str()?;
    let is_plain = path.components().count() == 1;
    let shipped =
        shipped::SHIPPED_PROCEDURES.iter().chain(shipped::SHIPPED_LIMITS).map(|s| s.name.to_owned());
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let beside = std::fs::read_dir(folder).into_iter().flatten().take(MAX_NAMES).flatten();
    let beside = beside.filter_map(|entry| entry.file_name().into_string().ok());
    let known: Vec<String> = shipped.filter(|_| is_plain).chain(beside).collect();
    let near = nearest(name, known.iter().map(String::as_str))?;
    Some(path.with_file_name(near).display().to_string())
}

/// The bytes of a file, one more than allowed at the most; where there is none, those of the shipped one of that name.
///
/// # Errors
/// As [`open_file`].
pub(crate) fn read(path: &Path) -> std::io::Result<Vec<u8>> {
    if let Some(shipped) = shipped::find(path).filter(|_| !path.is_file()) {
        return Ok(shipped.text.as_bytes().to_vec());
    }
    let mut bytes = Vec::new();
    open_file(path)?.take(MAX_READ_BYTES).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// The text in the bytes of a file; `name` stands in diagnostics.
///
/// # Errors
/// Too many bytes, or bytes that are no UTF-8, at their place.
pub(crate) fn source(name: &str, bytes: &[u8]) -> Result<SourceText, Problems> {
    let body = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
    if body.len() > MAX_BYTES {
        let message = note!("keyed.too_large", bytes = MAX_BYTES);
        return Err(Problem::of_file(name, message, None).into());
    }
    std::str::from_utf8(body).map(|text| SourceText::new(name, text.to_owned())).map_err(|e| {
        let sound = String::from_utf8_lossy(body.get(..e.valid_up_to()).unwrap_or(b"")).into_owned();
        let at = sound.len();
        SourceText::new(name, sound).error(&(at..at), "text_file.not_utf8").help("text_file.save_utf8").into()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const WORDING: Wording = Wording { unreadable: "check.unreadable", folder: "check.is_folder" };

    fn said(name: &str, bytes: &[u8]) -> String {
        source(name, bytes).unwrap_err().to_string()
    }

    #[test]
    fn a_file_of_the_largest_size_is_text_with_or_without_its_mark() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.toml");
        for mark in [&b""[..], BYTE_ORDER_MARK] {
            for (length, fits) in [(MAX_BYTES, true), (MAX_BYTES + 1, false), (3 * MAX_BYTES, false)] {
                std::fs::write(&path, [mark, &vec![b'#'; length]].concat()).unwrap();
                let read = bytes(&path, &WORDING).unwrap();
                match source("a.toml", &read) {
                    Ok(source) => assert!(fits && source.text.len() == length, "{length}"),
                    Err(e) => assert!(!fits && e.to_string().contains("larger than"), "{length}: {e}"),
                }
            }
        }
    }

    #[test]
    fn a_large_file_is_too_large_wherever_a_character_is_cut() {
        for shift in 0..3 {
            let text = format!("{}{}", "#".repeat(shift), "ж".repeat(MAX_BYTES));
            let cut = &text.as_bytes()[..MAX_READ_BYTES as usize];
            assert!(said("a.toml", cut).contains("larger than"), "{shift}");
        }
    }

    #[test]
    fn what_is_no_utf_8_is_told_at_its_place() {
        let shown = said("a.toml", b"\xef\xbb\xbfa = 1\nb = \"\xc4\"\n");
        assert!(shown.contains("--> a.toml:2:6") && shown.contains("not UTF-8"), "{shown}");
    }

    #[test]
    fn what_cannot_be_opened_is_told_with_its_reason() {
        let folder = tempfile::tempdir().unwrap();
        let none = bytes(&folder.path().join("none.toml"), &WORDING).unwrap_err().to_string();
        assert!(none.contains("cannot be read: ") && none.contains("check the path"), "{none}");
        let is_folder = bytes(folder.path(), &WORDING).unwrap_err().to_string();
        assert!(is_folder.contains("this is a folder"), "{is_folder}");
        assert!(peek(folder.path()).is_none() && peek(&folder.path().join("none.toml")).is_none());
    }
}
