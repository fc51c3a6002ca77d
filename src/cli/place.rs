//! Where results go, and how text reaches the user.

use super::{exit, stdout};
use crate::i18n::{Lang, Localize, Note, io_reason, note, visible, visible_lines};
use chrono::{DateTime, Utc};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Writes to standard output. What a file or its name holds cannot steer the terminal: all that the program says goes
/// through here or [`eprint_diagnostic`].
pub fn print(text: &str) {
    stdout::write(visible_lines(text).as_bytes());
}

/// Writes to standard error.
pub fn eprint_diagnostic(text: &str) {
    let _ = std::io::stderr().lock().write_all(visible_lines(text).as_bytes());
}

/// The exit code of a command that would end with `code`: where a part of its output could not be written, it did not succeed.
pub fn settled(code: u8, lang: Lang) -> u8 {
    let Some(failure) = stdout::failure() else { return code };
    let note = note!("system.stdout", reason = io_reason(&failure));
    eprint_diagnostic(&error(&note, lang));
    exit::ERROR
}

/// A path for the terminal, on one line.
pub fn shown(path: &Path) -> String {
    visible(&path.display().to_string()).into_owned()
}

/// A word of a command as a shell takes it, on one line.
pub fn for_shell(path: &str) -> String {
    if path.chars().all(|c| c.is_ascii_alphanumeric() || "./_-".contains(c)) {
        path.to_owned()
    } else {
        // The line stands in YAML as plain text, where a quote within is kept.
        format!("'{}'", visible(path).replace('\'', "'\\''"))
    }
}

/// The line of an error for the terminal.
pub fn error(note: &Note, lang: Lang) -> String {
    format!("{}: {}\n", note!("diagnostic.error").say(lang), note.say(lang))
}

/// The line of a warning for the terminal.
pub fn warning(note: &Note, lang: Lang) -> String {
    format!("{}: {}\n", note!("diagnostic.warning").say(lang), note.say(lang))
}

/// Where a result goes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum OutputPlace {
    /// The folder that the user named.
    Named(PathBuf),
    /// A name made by the program. If it is taken, the result goes to the next free name.
    Default(PathBuf),
}

impl OutputPlace {
    /// The folder named by the user, or else [`default_folder`].
    pub fn new(named: Option<&Path>, what: &str, serial: Option<&str>, now: DateTime<Utc>) -> OutputPlace {
        named.map_or_else(
            || OutputPlace::Default(default_folder(what, serial, now)),
            |path| OutputPlace::Named(path.to_owned()),
        )
    }

    /// The folder; a default one may get a number.
    pub fn path(&self) -> &Path {
        match self {
            OutputPlace::Named(path) | OutputPlace::Default(path) => path,
        }
    }
}

/// The default name of an output folder: what, which unit, when.
fn default_folder(what: &str, serial: Option<&str>, now: DateTime<Utc>) -> PathBuf {
    let clean = |text: &str| -> String {
        let safe: String =
            text.chars().map(|c| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '_' }).collect();
        safe.trim_matches('.').to_owned()
    };
    PathBuf::from(format!(
        "{}_{}_{}",
        clean(what),
        clean(serial.unwrap_or("no-serial")),
        now.format("%Y%m%dT%H%M%SZ")
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folder_names_are_safe_in_any_file_system() {
        let t = DateTime::from_timestamp(0, 0).unwrap();
        assert_eq!(
            default_folder("static-bias", Some("SN/42:а"), t),
            PathBuf::from("static-bias_SN_42_а_19700101T000000Z")
        );
        let odd = default_folder("static-bias", Some("../.."), t);
        assert_eq!(odd.components().count(), 1);
    }
}
