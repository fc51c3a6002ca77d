//! Inputs of a result, so that it takes the place of none made from something else.

use super::place::{self, OutputPlace};
use crate::config::manifest::Manifest;
use crate::config::shipped;
use crate::i18n::{Lang, Localize, Note, note};
use crate::ingest::lot::stated_serial_of;
use crate::ingest::unit_data::UnitData;
use crate::ingest::{ReadOptions, Source, files_read};
use crate::output::{Kind, Order, StagedFolder, UNREAD_HASH, sha256, sha256_of_file, sha256_of_several};
use crate::record::UnitUnderTest;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Debug;
use std::path::{Path, PathBuf};

/// The inputs of one call of the program.
pub struct Inputs(Order);

impl Inputs {
    /// None yet.
    pub fn new(force: bool) -> Inputs {
        Inputs(Order { force, ..Order::default() })
    }

    /// Those of an earlier result, which is made anew.
    #[must_use]
    pub fn of_result(mut self, inputs: BTreeMap<String, String>) -> Inputs {
        self.0.inputs = inputs;
        self
    }

    /// The recording, whatever files it is of.
    #[must_use]
    pub fn recording(self, named: &[PathBuf], options: &ReadOptions) -> Inputs {
        self.files("recording", &files_read(named, options))
    }

    /// The recording of a result that lists the hash of the file as it was read: it identifies a recording of one file, so that a long
    /// one is not read twice. Of several, some may not be read.
    #[must_use]
    pub fn recording_as_read(mut self, named: &[PathBuf], options: &ReadOptions) -> Inputs {
        let files = files_read(named, options);
        if !matches!(files.as_slice(), [one] if one.is_file()) {
            return self.files("recording", &files);
        }
        self.0.read.extend_from_slice(&files);
        self.0.files.insert("recording".to_owned(), files);
        self
    }

    /// A file, identified by its hash.
    #[must_use]
    pub fn file(self, name: &str, path: Option<&Path>) -> Inputs {
        let files: Vec<PathBuf> = path.map(Path::to_owned).into_iter().collect();
        self.files(name, &files)
    }

    /// Files in their order, identified by their hashes.
    #[must_use]
    pub fn files(mut self, name: &str, paths: &[PathBuf]) -> Inputs {
        if paths.is_empty() {
            return self;
        }
        self.0.inputs.insert(name.to_owned(), sha256_of_several(paths.iter().map(|p| hash(p))));
        self.0.read.extend_from_slice(paths);
        self
    }

    /// A folder that is read and decides nothing in the result.
    #[must_use]
    pub fn beside(mut self, path: Option<&Path>) -> Inputs {
        self.0.read.extend(path.map(Path::to_owned));
        self
    }

    /// A text as it is.
    #[must_use]
    pub fn text(mut self, name: &str, text: Option<&str>) -> Inputs {
        if let Some(text) = text {
            self.0.inputs.insert(name.to_owned(), text.trim().to_owned());
        }
        self
    }

    /// Whatever else decides, by the hash of its form.
    #[must_use]
    pub fn options(mut self, options: &dyn Debug) -> Inputs {
        self.0.inputs.insert("options".to_owned(), sha256(format!("{options:?}").as_bytes()));
        self
    }

    /// What identifies the inputs, by their names.
    pub fn identities(mut self) -> BTreeMap<String, String> {
        self.0.identify_files(&BTreeMap::new());
        self.0.inputs
    }

    /// The recordings of a lot, identified by what identifies each; the files are read.
    #[must_use]
    pub fn lot(mut self, units: &[BTreeMap<String, String>], read: Vec<PathBuf>) -> Inputs {
        let identities: Vec<&str> = units
            .iter()
            .flat_map(|u| ["recording", "unit"].map(|n| u.get(n).map_or("", String::as_str)))
            .collect();
        self.0.inputs.insert("recording".to_owned(), sha256(identities.join("\n").as_bytes()));
        self.0.read.extend(read);
        self
    }

    /// Begins the folder.
    ///
    /// # Errors
    /// The complaint, in words.
    pub fn begin(mut self, out: &OutputPlace, kind: Kind, lang: Lang) -> Result<StagedFolder, String> {
        self.0.fresh = matches!(out, OutputPlace::Default(_));
        StagedFolder::begin(out.path(), kind, self.0).map_err(|e| place::error(&e.note(), lang))
    }
}

/// The serial number of a unit.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Serial {
    /// The number; `None` where nothing states it.
    pub number: Option<String>,
    /// True when only the recording states it.
    pub of_recording: bool,
}

impl Serial {
    /// The number that the user gave, or else the manifest, or else the recording.
    ///
    /// # Errors
    /// As [`serial`].
    pub fn of(given: Option<&str>, manifest: Option<&Manifest>, sources: &[&Source]) -> Result<Serial, Note> {
        let number = serial(given, manifest)?.filter(|n| !n.trim().is_empty());
        if number.is_some() {
            return Ok(Serial { number, of_recording: false });
        }
        let stated = stated_serial_of(sources);
        Ok(Serial { of_recording: stated.is_some(), number: stated })
    }
}

/// A unit with what the manifest, and else the table of units, knows of it.
pub fn completed(mut unit: UnitUnderTest, manifest: Option<&Manifest>, units: &UnitData) -> UnitUnderTest {
    if let Some(manifest) = manifest {
        unit.fill(&manifest.unit);
    }
    if let Some(known) = unit.serial.as_deref().and_then(|serial| units.of(serial)) {
        unit.fill(known);
    }
    unit
}

/// The serial number given; the manifest's where none is. Two that differ are an error: this is another unit's recording.
pub fn serial(given: Option<&str>, manifest: Option<&Manifest>) -> Result<Option<String>, Note> {
    let stated = manifest.and_then(|m| m.serial.as_deref());
    match (given, stated) {
        (Some(given), Some(stated)) if given.trim() != stated.trim() => {
            let path = manifest.map(|m| m.path.display().to_string()).unwrap_or_default();
            Err(note!("manifest.serial", path, stated, given))
        }
        _ => Ok(given.or(stated).map(str::to_owned)),
    }
}

/// Puts a folder in its place, and says which result of other inputs it replaced.
///
/// # Errors
/// The complaint, in words.
pub fn publish(folder: StagedFolder, record: impl Serialize, lang: Lang) -> Result<PathBuf, String> {
    let replaced = folder.replaces();
    let place = folder.publish(record).map_err(|e| place::error(&e.note(), lang))?;
    if let Some(note) = replaced {
        place::eprint_diagnostic(&format!("{}\n", note.say(lang)));
    }
    Ok(place)
}

/// SHA-256 of a file, or of one that the program holds. What is neither, or cannot be read, has none.
fn hash(path: &Path) -> String {
    let shipped = || shipped::find(path).map(|s| sha256(s.text.as_bytes()));
    sha256_of_file(path).or_else(shipped).unwrap_or_else(|| UNREAD_HASH.to_owned())
}
