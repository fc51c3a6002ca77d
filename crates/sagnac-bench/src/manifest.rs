//! The manifest by which a recording is read: the parts of the unit, and those of the other devices beside it.

use crate::parts::{Parts, write_whole};
use std::fmt::Write as _;
use std::io::Result;
use std::path::Path;

/// File of the manifest.
pub const MANIFEST_FILE: &str = "recording.toml";

/// Writes it anew, with the devices beside the unit of which there are parts.
///
/// # Errors
/// A disk that is full or gone.
pub(crate) fn write(folder: &Path, serial: Option<&str>, unit: &Parts, others: &[&Parts]) -> Result<()> {
    write_whole(folder, MANIFEST_FILE, text(serial, unit, others).as_bytes())
}

fn text(serial: Option<&str>, unit: &Parts, others: &[&Parts]) -> String {
    let mut text = "format = \"manifest/1\"\n".to_owned();
    // Writing to a text cannot fail.
    if let Some(serial) = serial {
        let _ = writeln!(text, "serial = {}", quoted(serial));
    }
    let _ = writeln!(text, "files = {}", quoted(&unit.pattern()));
    for parts in others {
        let _ = writeln!(text, "\n[[source]]\nfiles = {}\ntime_offset = \"0 s\"", quoted(&parts.pattern()));
    }
    text
}

/// A text as TOML.
fn quoted(text: &str) -> String {
    let mut out = "\"".to_owned();
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            // Writing to a text cannot fail.
            c if c.is_control() => drop(write!(out, "\\u{:04X}", u32::from(c))),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_quoted() {
        assert_eq!(quoted("SN \"7\"\\\n"), r#""SN \"7\"\\\u000A""#);
    }
}
