//! From a file to a checked value with its identity.

use super::diagnostics::{Problems, SourceText};
use super::limits::LimitsFile;
use super::model::{Loaded, Procedure};
use super::parse;
use crate::keyed::file::{self, Wording};
use sha2::{Digest, Sha256};
use std::path::Path;
use std::sync::Arc;

/// What is said of a file that cannot be read at all.
const WORDING: Wording = Wording { unreadable: "check.unreadable", folder: "check.is_folder" };

/// Reads a procedure.
///
/// # Errors
/// Every problem of the file, each with its place; a file that cannot be read is one problem without a place.
pub fn load(path: &Path) -> Result<Loaded<Procedure>, Problems> {
    parse_procedure(&name_of(path), &file::bytes(path, &WORDING)?)
}

/// Reads a limits file.
///
/// # Errors
/// As [`load`].
pub fn load_limits(path: &Path) -> Result<Loaded<LimitsFile>, Problems> {
    parse_limits(&name_of(path), &file::bytes(path, &WORDING)?)
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
    if let (Some(explain), Some(folder)) = (&mut procedure.value.explain, Path::new(name).parent()) {
        explain.model = folder.join(&explain.model);
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
    let source = file::source(name, bytes)?;
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

fn name_of(path: &Path) -> String {
    path.display().to_string()
}
