//! Programs of the user that give rows of their own: what a procedure states of them.

use super::contained_files;
use super::external::is_sha256;
use super::reader::{Reader, meant, shorten};
use super::section::Section;
use super::spec::Kind;
use super::table::Table;
use crate::i18n::note;
use crate::measurand;
use crate::output::sha256_of_file;
use crate::units::Unit;
use sagnac_core::spelling::nearest;
use std::path::{Path, PathBuf};

/// A program of the user that gives quantities of its own from the channels of the recording, by the protocol `measurand/1`. Each
/// has a row of its own, and limits by [[derived_limit]].
#[derive(Table)]
#[table("program")]
pub(crate) struct ProgramKeys {
    /// Id of the program in notes and diagnostics.
    #[key(id, required, example = "drift")]
    pub id: Option<String>,
    /// Command line, word by word; no shell reads it. The first word that is a file beside the procedure is the program.
    #[key(required, kind = Kind::Command, example = ["python3", "drift.py"])]
    pub command: Vec<String>,
    /// SHA-256 of that file. Another file is not run.
    #[key(required, example = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855")]
    pub sha256: Option<String>,
    /// Version, as the report states it.
    #[key(required, example = "1.2")]
    pub version: Option<String>,
    /// Longest run; the program is ended then.
    #[key(quantity = "s", above = 0, max = 86400, default = "60 s", example = "60 s")]
    pub timeout_s: f64,
    /// Channels that are handed over. Default: every channel but time stamps and counters.
    #[key(example = ["rate", "temperature"])]
    pub channels: Vec<String>,
    /// Folders besides its own that it may read, by absolute paths, such as that of an interpreter outside `/usr`.
    #[key(example = ["/opt/analysis"])]
    pub reads: Vec<String>,
    /// Quantities that it gives, one table each.
    #[key(name = "returns", required)]
    pub returns: Vec<ReturnKeys>,
    #[key(section)]
    pub section: Section,
}

/// A quantity that a program gives.
#[derive(Table)]
#[table("program.returns")]
pub(crate) struct ReturnKeys {
    /// Id of the quantity in results and limits; no id of a measurand.
    #[key(id, required, example = "day_drift")]
    pub id: Option<String>,
    /// Unit of the row.
    #[key(required, example = "deg/h")]
    pub unit: Option<Unit>,
    #[key(section)]
    pub section: Section,
}

/// A program of the user.
#[derive(Debug, Clone, PartialEq)]
pub struct ProgramSpec {
    /// Id in notes.
    pub id: String,
    /// Command line.
    pub command: Vec<String>,
    /// Which word of it is the program, and its file; `None` where it is not beside the procedure.
    pub file: Option<(usize, PathBuf)>,
    /// SHA-256 that the file must have, hexadecimal, lower case.
    pub sha256: String,
    /// Version.
    pub version: String,
    /// Longest run, s.
    pub timeout_s: f64,
    /// Channels that are handed over; empty: all that measure something.
    pub channels: Vec<String>,
    /// Folders besides its own that it may read.
    pub reads: Vec<PathBuf>,
    /// Ids of its quantities, with their units.
    pub returns: Vec<(String, Unit)>,
}

/// What else a procedure has that programs refer to or must not repeat.
pub(crate) struct Beside<'a> {
    /// Ids of the channels.
    pub channels: Vec<&'a str>,
    /// Ids of results of other tests.
    pub externals: Vec<&'a str>,
    /// Folder of the procedure; without it, no file is looked for.
    pub folder: Option<&'a Path>,
}

/// Reads the programs of a procedure.
pub(crate) fn read(
    tables: Vec<ProgramKeys>,
    beside: &Beside<'_>,
    reader: &mut Reader<'_>,
) -> Vec<ProgramSpec> {
    let mut found: Vec<ProgramSpec> = vec![];
    for keys in tables {
        let returns = returned(&keys.returns, &found, beside, reader);
        let ProgramKeys {
            id: Some(id), sha256: Some(sha256), version: Some(version), command, section, ..
        } = keys
        else {
            continue;
        };
        if found.iter().any(|p| p.id == id) {
            reader.error(&section.span_of("id"), note!("program.second", id = id.as_str()), None);
        }
        if !is_sha256(&sha256) {
            let message = note!("external.sha256", given = shorten(&sha256));
            reader.error(&section.span_of("sha256"), message, None);
        }
        for channel in keys.channels.iter().filter(|c| !beside.channels.contains(&c.as_str())) {
            let help = nearest(channel, beside.channels.iter().copied()).map(meant);
            let message = note!("program.no_channel", channel = shorten(channel));
            reader.error(&section.span_of("channels"), message, help);
        }
        if let Some(folder) = keys.reads.iter().find(|folder| !Path::new(folder).is_absolute()) {
            let message = note!("program.relative", path = shorten(folder));
            reader.error(&section.span_of("reads"), message, None);
        }
        let sha256 = sha256.to_lowercase();
        let file = beside.folder.and_then(|folder| file(&command, folder, &section, reader));
        if let Some((_, path)) = &file
            && let Some(own) = sha256_of_file(path).filter(|own| *own != sha256)
        {
            let message = note!("program.other_file", path = shown(path), found = own);
            reader.warning(&section.span_of("sha256"), message, Some("program.help.other_file".into()));
        }
        found.push(ProgramSpec {
            id,
            command,
            file,
            sha256,
            version,
            timeout_s: keys.timeout_s,
            channels: keys.channels,
            reads: keys.reads.iter().map(PathBuf::from).collect(),
            returns,
        });
    }
    found
}

/// The quantities of a program, where none is one of another origin.
fn returned(
    keys: &[ReturnKeys],
    earlier: &[ProgramSpec],
    beside: &Beside<'_>,
    reader: &mut Reader<'_>,
) -> Vec<(String, Unit)> {
    let mut returns: Vec<(String, Unit)> = vec![];
    for ReturnKeys { id, unit, section } in keys {
        let (Some(id), Some(unit)) = (id, unit) else { continue };
        let at = section.span_of("id");
        let own = || returns.iter().chain(earlier.iter().flat_map(|p| &p.returns));
        if measurand::find(id).is_some() || measurand::called(id).is_some() {
            reader.error(&at, note!("program.of_standard", id = id.as_str()), None);
        } else if own().any(|(other, _)| other == id) || beside.externals.contains(&id.as_str()) {
            reader.error(&at, note!("program.twice", id = id.as_str()), None);
        } else {
            returns.push((id.clone(), unit.clone()));
        }
    }
    returns
}

/// The first word of a command that is a file in the folder of the procedure.
fn file(
    command: &[String],
    folder: &Path,
    section: &Section,
    reader: &mut Reader<'_>,
) -> Option<(usize, PathBuf)> {
    let at = section.span_of("command");
    let is_file = |word: &String| {
        !Path::new(word).is_absolute() && !word.is_empty() && contained_files::joined(folder, word).is_file()
    };
    let Some(place) = command.iter().position(is_file) else {
        // Copies of a procedure beside a result stand without it, and are read all the same.
        reader.warning(&at, "program.no_file", Some("program.help.no_file".into()));
        return None;
    };
    let found = contained_files::file(command.get(place)?, folder, &at, reader)?;
    Some((place, found.canonical))
}

/// The name of a file, without its folder.
fn shown(path: &Path) -> String {
    path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned())
}
