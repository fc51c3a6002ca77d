//! From a file to a checked value with its identity.

use super::diagnostics::{Problem, Problems, SourceText};
use super::limits::LimitsFile;
use super::model::{Loaded, Procedure};
use super::parse;
use crate::text::{Note, io_reason};
use sha2::{Digest, Sha256};
use std::io::Read;
use std::path::Path;
use std::sync::Arc;

/// Most bytes that are read of a file: enough to know that it is too large.
const MOST_BYTES: u64 = (1 << 20) + 1;

/// Reads a procedure.
///
/// # Errors
/// Every problem of the file, each with its place; a file that cannot be read is one problem without a place.
pub fn load(path: &Path) -> Result<Loaded<Procedure>, Problems> {
    parse_procedure(&name_of(path), &bytes_of(path)?)
}

/// Reads a limits file.
///
/// # Errors
/// As [`load`].
pub fn load_limits(path: &Path) -> Result<Loaded<LimitsFile>, Problems> {
    parse_limits(&name_of(path), &bytes_of(path)?)
}

/// Reads a procedure from the bytes of a file; `name` stands in diagnostics and results.
///
/// # Errors
/// Every problem of the text.
pub fn parse_procedure(name: &str, bytes: &[u8]) -> Result<Loaded<Procedure>, Problems> {
    let mut procedure = loaded(name, bytes, parse::procedure)?;
    // A layout stands beside its procedure, wherever the program is started.
    if let (Some(layout), Some(folder)) =
        (&mut procedure.value.recording.read.layout, Path::new(name).parent())
    {
        *layout = folder.join(&*layout);
    }
    Ok(procedure)
}

/// Reads a limits file from its bytes.
///
/// # Errors
/// Every problem of the text.
pub fn parse_limits(name: &str, bytes: &[u8]) -> Result<Loaded<LimitsFile>, Problems> {
    loaded(name, bytes, parse::limits_file)
}

fn loaded<T>(
    name: &str,
    bytes: &[u8],
    parse: fn(&SourceText) -> (Option<T>, Problems),
) -> Result<Loaded<T>, Problems> {
    let text = text_of(name, bytes)?;
    let source = SourceText::new(name, text);
    match parse(&source) {
        (Some(value), warnings) => Ok(Loaded {
            value,
            path: name.to_owned(),
            sha256: Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect(),
            source: Arc::new(source),
            warnings: warnings.list,
        }),
        (None, problems) => Err(problems),
    }
}

/// The text of a file; a byte order mark is no part of it.
fn text_of(name: &str, bytes: &[u8]) -> Result<String, Problems> {
    let body = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    match std::str::from_utf8(body) {
        Ok(text) => Ok(text.to_owned()),
        Err(e) => {
            let sound = String::from_utf8_lossy(body.get(..e.valid_up_to()).unwrap_or(b"")).into_owned();
            let at = sound.len();
            let source = SourceText::new(name, sound);
            Err(source.error(&(at..at), "check.not_utf8").help("check.help.utf8").into())
        }
    }
}

fn name_of(path: &Path) -> String {
    path.display().to_string()
}

pub(super) fn bytes_of(path: &Path) -> Result<Vec<u8>, Problems> {
    let failed = |e: std::io::Error| -> Problems {
        let help = match e.kind() {
            std::io::ErrorKind::NotFound => Some("check.help.path".into()),
            _ => None,
        };
        let message = Note::new("check.unreadable").with("reason", io_reason(&e));
        Problem::of_file(&name_of(path), message, help).into()
    };
    if path.is_dir() {
        return Err(Problem::of_file(&name_of(path), "check.is_folder", None).into());
    }
    let file = std::fs::File::open(path).map_err(failed)?;
    let mut bytes = vec![];
    file.take(MOST_BYTES).read_to_end(&mut bytes).map_err(failed)?;
    Ok(bytes)
}
