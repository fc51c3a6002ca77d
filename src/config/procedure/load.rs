//! From a file to a checked value with its identity.

use super::diagnostics::{Problems, SourceText};
use super::limits::LimitsFile;
use super::model::{Loaded, Procedure};
use super::parse;
use crate::config::contained_files;
use crate::config::text_file::{self, Wording};
use crate::output::sha256;
use std::path::Path;
use std::sync::Arc;

/// Messages for a file that cannot be read at all.
const READ_MESSAGES: Wording = Wording { unreadable: "check.unreadable", folder: "check.is_folder" };

/// Reads a procedure; the files that it names must be there.
///
/// # Errors
/// Every problem of the file, each with its place; a file that cannot be read is one problem without a place.
pub fn load(path: &Path) -> Result<Loaded<Procedure>, Problems> {
    let folder = contained_files::folder_of(path);
    loaded(&name_of(path), &text_file::bytes(path, &READ_MESSAGES)?, |source| {
        parse::procedure(source, Some(folder))
    })
}

/// Reads a limits file.
///
/// # Errors
/// As [`load`].
pub fn load_limits(path: &Path) -> Result<Loaded<LimitsFile>, Problems> {
    parse_limits(&name_of(path), &text_file::bytes(path, &READ_MESSAGES)?)
}

/// Reads a procedure from the bytes of a file; `name` stands in diagnostics and results. Whether the files that it names
/// are there is not asked.
///
/// # Errors
/// Every problem of the text.
pub fn parse_procedure(name: &str, bytes: &[u8]) -> Result<Loaded<Procedure>, Problems> {
    loaded(name, bytes, |source| parse::procedure(source, None))
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
    parse: impl Fn(&SourceText) -> (Option<T>, Problems),
) -> Result<Loaded<T>, Problems> {
    let source = text_file::source(name, bytes)?;
    match parse(&source) {
        (Some(value), warnings) => Ok(Loaded {
            value,
            path: name.to_owned(),
            sha256: sha256(bytes),
            source: Arc::new(source),
            warnings: warnings.list,
        }),
        (None, problems) => Err(problems),
    }
}

fn name_of(path: &Path) -> String {
    path.display().to_string()
}
