//! Why an output could not be written.

use crate::i18n::{Arg, Lang, Localize, Note, io_reason, note};
use std::fmt;
use std::path::{Path, PathBuf};

/// Why an output folder could not be written.
#[derive(Debug)]
pub enum OutputError {
    /// The operating system refused.
    Io {
        /// What failed: a key of the locale tables.
        action: &'static str,
        /// On which path.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// Something that is no earlier result stands in the way.
    InTheWay {
        /// Where.
        path: PathBuf,
        /// The problem.
        why: Note,
    },
    /// The target is `..`, the root or the like.
    NoName(PathBuf),
    /// A file that no result folder holds.
    Unforeseen(String),
    /// A result of other inputs stands there, and nobody asked to replace it.
    Other {
        /// Where.
        path: PathBuf,
        /// Description of the earlier result.
        what: Note,
        /// The inputs that differ.
        differ: Vec<String>,
    },
    /// A file that is read lies where the result would go.
    InputInside {
        /// The folder.
        path: PathBuf,
        /// The file.
        input: PathBuf,
    },
    /// The record cannot be written as JSON.
    Unwritable(String),
}

impl OutputError {
    /// The error as a note.
    pub fn note(&self) -> Note {
        let at = |path: &Path| path.display().to_string();
        match self {
            OutputError::Io { action, path, source } => {
                Note::new(*action).with("path", at(path)).with("reason", io_reason(source))
            }
            OutputError::InTheWay { path, why } => {
                note!("output_error.in_the_way", path = at(path), why = why.clone())
            }
            OutputError::NoName(path) => note!("output_error.no_name", path = at(path)),
            OutputError::Unforeseen(name) => note!("output_error.unforeseen", name = name.as_str()),
            OutputError::Other { path, what, differ } => {
                let differ = differ.iter().map(|d| Arg::Key(format!("output_error.input.{d}"))).collect();
                note!(
                    "output_error.other",
                    path = at(path),
                    what = what.clone(),
                    differ = Arg::Several(differ, ", ".into())
                )
            }
            OutputError::InputInside { path, input } => {
                note!("output_error.input_inside", path = at(path), input = at(input))
            }
            OutputError::Unwritable(reason) => note!("system.other", reason = reason.as_str()),
        }
    }
}

impl fmt::Display for OutputError {
    /// In English.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.note().say(Lang::En))
    }
}

impl std::error::Error for OutputError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            OutputError::Io { source, .. } => Some(source),
            _ => None,
        }
    }
}

/// The error of an action on a path.
pub(super) fn io(action: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> OutputError + use<> {
    let path = path.to_owned();
    move |source| OutputError::Io { action, path, source }
}
