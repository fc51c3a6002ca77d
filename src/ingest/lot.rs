//! A lot: recordings that are units of their own, each with its serial number.

use super::serial::{SerialPattern, plain, stem};
use super::{ReadOptions, RecordingError, Source, each_of, open_recording};
use crate::config::manifest;
use crate::i18n::{Note, note};
use crate::record::SerialSource;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Most recordings that a message names.
const MAX_NAMED_RECORDINGS: usize = 4;
/// Longest name of a folder, in characters.
const MAX_FOLDER_CHARACTERS: usize = 80;
/// Names that the folder of a lot has for other things, in lower case.
const RESERVED_NAMES: [&str; 7] =
    ["index.html", "index.md", "index.pdf", "index.csv", "index.json", "junit.xml", "sha256sums"];

/// A recording that is a unit of its own.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Member {
    /// The recording as named: a file or a manifest.
    pub recording: PathBuf,
    /// Serial number of the unit.
    pub serial: String,
    /// Where the serial number was taken from.
    pub serial_from: SerialSource,
    /// Name for the folder of its result, safe in any file system; no two of a lot are alike.
    pub folder: String,
}

/// Why the units of a lot cannot be identified.
#[derive(Debug, Clone, PartialEq)]
pub enum LotError {
    /// A name or pattern stands for no file.
    Recording(RecordingError),
    /// A serial number cannot be identified, or is that of several recordings.
    Serial {
        /// The problems, one note for each serial number or file.
        notes: Vec<Note>,
        /// What to do.
        help: Note,
    },
}

/// The units of a lot in the order of what was named; files of a pattern in their order.
///
/// The serial number is the part of the file name that `pattern` selects. Without a pattern it is what the manifest or the
/// recording states, else the file name without its ending. A recording that cannot be opened is a unit too: what is
/// wrong with it is found when it is tested.
///
/// # Errors
/// [`LotError`] where a file is missing, the pattern does not fit, or two recordings have one serial number.
pub fn members(
    named: &[PathBuf],
    options: &ReadOptions,
    pattern: Option<&SerialPattern>,
) -> Result<Vec<Member>, LotError> {
    let mut recordings = vec![];
    for path in named {
        recordings.extend(each_of(path).map_err(|e| LotError::Recording(e.into()))?);
    }
    // A name that is no file is a slip of the pen; a damaged file is found when it is tested.
    if let Some(missing) = recordings.iter().find(|r| !r.exists()) {
        open_recording(std::slice::from_ref(missing), options).map_err(LotError::Recording)?;
    }
    let (mut members, mut wrong) = (vec![], vec![]);
    for recording in recordings {
        match pattern.map(|p| p.serial_of(&recording)) {
            Some(Err(note)) => wrong.push(note),
            Some(Ok(serial)) => members.push(member(recording, serial, SerialSource::Pattern)),
            None => {
                let (serial, serial_from) = stated(&recording, options);
                members.push(member(recording, serial, serial_from));
            }
        }
    }
    if !wrong.is_empty() {
        return Err(LotError::Serial { notes: wrong, help: note!("lot.help.pattern") });
    }
    let twice = repeated(&members);
    if !twice.is_empty() {
        return Err(LotError::Serial { notes: twice, help: note!("lot.help.duplicate") });
    }
    name_folders(&mut members);
    Ok(members)
}

fn member(recording: PathBuf, serial: String, serial_from: SerialSource) -> Member {
    Member { recording, serial, serial_from, folder: String::new() }
}

/// The serial number that a recording states, or else the name of its file.
fn stated(recording: &Path, options: &ReadOptions) -> (String, SerialSource) {
    let opened = open_recording(&[recording.to_owned()], options).ok();
    let of_manifest = || {
        // A manifest whose files cannot be opened states its number all the same.
        let loaded = manifest::is_manifest(recording).then(|| manifest::load(recording).ok()).flatten();
        loaded.and_then(|m| m.serial).map(|s| s.trim().to_owned()).filter(|s| !s.is_empty())
    };
    if let Some(serial) = of_manifest() {
        return (serial, SerialSource::Manifest);
    }
    match opened.and_then(|o| stated_serial(&o.source)) {
        Some(serial) => (serial, SerialSource::Recording),
        None => (stem(recording), SerialSource::FileName),
    }
}

/// The serial number that a recording states in its header or metadata; `None` where it states none, or several.
pub fn stated_serial(source: &Source) -> Option<String> {
    stated_serial_of(&[source])
}

/// As [`stated_serial`], of several recordings of one unit.
pub fn stated_serial_of(sources: &[&Source]) -> Option<String> {
    let numbers: Vec<&str> = sources.iter().flat_map(|s| s.stated_serials()).collect();
    let different: BTreeSet<String> = numbers.iter().map(|s| plain(s)).filter(|s| !s.is_empty()).collect();
    let stated = numbers.iter().find(|s| !plain(s).is_empty()).filter(|_| different.len() == 1)?;
    Some(stated.trim().to_owned())
}

/// What tells one serial number from another.
fn identity(serial: &str) -> String {
    let plain = plain(serial);
    if plain.is_empty() { serial.trim().to_lowercase() } else { plain }
}

/// A note for each serial number that several recordings have.
fn repeated(members: &[Member]) -> Vec<Note> {
    let mut by_number: BTreeMap<String, Vec<&Member>> = BTreeMap::new();
    for member in members {
        by_number.entry(identity(&member.serial)).or_default().push(member);
    }
    let several = by_number.values().filter(|m| m.len() > 1);
    several
        .map(|m| {
            let written: BTreeSet<&str> = m.iter().map(|m| m.serial.as_str()).collect();
            let named: Vec<String> =
                m.iter().take(MAX_NAMED_RECORDINGS).map(|m| m.recording.display().to_string()).collect();
            let key = if m.len() > MAX_NAMED_RECORDINGS { "lot.duplicate_more" } else { "lot.duplicate" };
            Note::new(key)
                .with("serial", written.into_iter().collect::<Vec<_>>().join(", "))
                .with("n", m.len())
                .with("recordings", named.join(", "))
        })
        .collect()
}

/// A name for the folder of a unit, safe in any file system.
pub fn folder_name(serial: &str) -> String {
    let safe = |c: char| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '_' };
    let name: String = serial.chars().map(safe).take(MAX_FOLDER_CHARACTERS).collect();
    let name = name.trim_matches('.');
    if name.is_empty() { "unit".to_owned() } else { name.to_owned() }
}

/// Gives each unit a folder of its own.
fn name_folders(members: &mut [Member]) {
    let mut taken: BTreeSet<String> = RESERVED_NAMES.iter().map(|name| (*name).to_owned()).collect();
    for member in members {
        let name = folder_name(&member.serial);
        // Some file systems do not tell upper from lower case.
        let numbered = (2..).map(|n| format!("{name}_{n}"));
        let free = std::iter::once(name.clone()).chain(numbered).find(|n| taken.insert(n.to_lowercase()));
        member.folder = free.unwrap_or_default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(serials: &[&str]) -> Vec<Member> {
        serials
            .iter()
            .map(|s| member(PathBuf::from(format!("{s}.csv")), (*s).to_owned(), SerialSource::FileName))
            .collect()
    }

    #[test]
    fn folders_are_safe_and_no_two_are_alike() {
        let mut members = of(&["a/b", "A_B", "..", "index.json", "", "блок 7"]);
        name_folders(&mut members);
        let folders: Vec<&str> = members.iter().map(|m| m.folder.as_str()).collect();
        assert_eq!(folders, ["a_b", "A_B_2", "unit", "index.json_2", "unit_2", "блок_7"]);
    }

    #[test]
    fn a_number_written_in_two_ways_is_one_number() {
        let notes = repeated(&of(&["SN-0043", "44", "43", "№"]));
        assert_eq!(notes.len(), 1);
        assert_eq!(notes[0].args["serial"], "43, SN-0043".into());
        assert!(repeated(&of(&["1", "2", "-", "№"])).is_empty());
    }
}
