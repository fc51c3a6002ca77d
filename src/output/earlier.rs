//! An earlier result in the place where a new one is to go.

use super::error::{OutputError, io};
use super::kind::{Kind, MAX_RECORD_BYTES};
use crate::i18n::{Arg, Note, note};
use sagnac_ingest::{open_file, read_file};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::Read;
use std::path::Path;

/// An earlier result that lists everything in its folder.
#[derive(Debug)]
pub(super) struct Earlier {
    kind: Kind,
    record: Value,
    made: Option<String>,
    /// Its inputs.
    pub(super) inputs: BTreeMap<String, String>,
    files: BTreeSet<String>,
}

impl Earlier {
    /// The earlier result in a folder; `None` where the folder is empty.
    ///
    /// # Errors
    /// [`OutputError::InTheWay`] for what is no folder of this kind, does not list its files, or holds what it does
    /// not list.
    pub(super) fn at(target: &Path, kind: Kind) -> Result<Option<Earlier>, OutputError> {
        let in_the_way = |why: Note| Err(OutputError::InTheWay { path: target.to_owned(), why });
        let found = target.symlink_metadata().map_err(io("output_error.look_at", target))?.file_type();
        if !found.is_dir() {
            let why = if found.is_symlink() { "output_error.why.link" } else { "output_error.why.file" };
            return in_the_way(why.into());
        }
        if fs::read_dir(target).map_err(io("output_error.look_into", target))?.next().is_none() {
            return Ok(None);
        }
        if !is_of(target, kind) {
            return in_the_way(kind.foreign().into());
        }
        let Some(earlier) = Earlier::read(target, kind) else {
            return in_the_way("output_error.why.unlisted".into());
        };
        let listed = |name: &str| earlier.files.contains(name);
        let holder = |name: &str| earlier.files.iter().any(|f| f.starts_with(&format!("{name}/")));
        match foreign(target, "", &listed, &holder).map_err(io("output_error.look_into", target))? {
            Some(name) => in_the_way(note!("output_error.why.holds", name)),
            None => Ok(Some(earlier)),
        }
    }

    fn read(folder: &Path, kind: Kind) -> Option<Earlier> {
        let path = folder.join(kind.record_file());
        let record: Value = serde_json::from_slice(&read_file(&path, MAX_RECORD_BYTES).ok()?).ok()?;
        let text = |v: &Value| v.as_str().map(str::to_owned);
        let files = record.get("files")?.as_array()?.iter().map(text).collect::<Option<_>>()?;
        let inputs = record.get("inputs")?.as_object()?;
        let inputs = inputs.iter().map(|(k, v)| Some((k.clone(), text(v)?))).collect::<Option<_>>()?;
        let stated = record.pointer("/session/evaluated_at").or(record.get("compared_at")).and_then(text);
        let modified = || {
            let at: chrono::DateTime<chrono::Utc> = path.metadata().ok()?.modified().ok()?.into();
            Some(at.to_rfc3339_opts(chrono::SecondsFormat::Secs, true))
        };
        Some(Earlier { kind, made: stated.or_else(modified), record, inputs, files })
    }

    /// Description of the result: verdict, unit, moment.
    pub(super) fn what(&self) -> Note {
        let text = |at: &str| self.record.pointer(at).and_then(Value::as_str).map(str::to_owned);
        let made = self.made.clone().unwrap_or_else(|| "–".to_owned());
        let note = |key| Note::new(key).with("made", made.as_str());
        let described = note(self.kind.description());
        match self.kind {
            Kind::Result => {
                let verdict = text("/verdict").unwrap_or_default();
                let result = match text("/unit_under_test/serial") {
                    Some(serial) => described.with("serial", serial),
                    None => note("output_error.what.result_of_no_unit"),
                };
                result.with("verdict", Arg::key("verdict", &verdict))
            }
            Kind::Lot => {
                let units = self.record.get("units").and_then(Value::as_array).map_or(0, Vec::len);
                described.with("n", units)
            }
            Kind::Explanation | Kind::Joint => {
                described.with("verdict", text("/verdict").unwrap_or_default())
            }
            Kind::Comparison | Kind::Plan | Kind::DataSheet | Kind::Proof | Kind::Day | Kind::Rehearsal => {
                described
            }
        }
    }

    /// The names of the inputs that differ.
    pub(super) fn differing(&self, others: &BTreeMap<String, String>) -> Vec<String> {
        let names: BTreeSet<&String> = self.inputs.keys().chain(others.keys()).collect();
        names.into_iter().filter(|n| self.inputs.get(*n) != others.get(*n)).cloned().collect()
    }
}

/// True when a folder holds the file that tells its kind.
pub(super) fn is_of(folder: &Path, kind: Kind) -> bool {
    starts_with_format(&folder.join(kind.record_file()), kind.start())
}

/// True for a JSON file that begins so, spaces aside.
pub(super) fn starts_with_format(file: &Path, start: &str) -> bool {
    let mut head = vec![];
    let read = open_file(file).and_then(|f| f.take(64).read_to_end(&mut head));
    let head: String = String::from_utf8_lossy(&head).split_whitespace().collect();
    read.is_ok() && head.starts_with(start)
}

/// The first entry below a folder that is neither a listed file nor a folder for such.
fn foreign(
    folder: &Path,
    before: &str,
    listed: &dyn Fn(&str) -> bool,
    holder: &dyn Fn(&str) -> bool,
) -> std::io::Result<Option<String>> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = format!("{before}{}", entry.file_name().to_string_lossy());
        // A link to a folder is no folder.
        if entry.file_type()?.is_dir() {
            if !holder(&name) {
                return Ok(Some(name));
            }
            if let Some(found) = foreign(&entry.path(), &format!("{name}/"), listed, holder)? {
                return Ok(Some(found));
            }
        } else if !listed(&name) {
            return Ok(Some(name));
        }
    }
    Ok(None)
}

/// Removes an earlier result that stands aside: the files that it lists, and the folders that are empty then.
pub(super) fn remove(folder: &Path, earlier: Option<&Earlier>) -> Result<(), OutputError> {
    fn below(folder: &Path, before: &str, earlier: &Earlier) -> std::io::Result<()> {
        for entry in fs::read_dir(folder)? {
            let entry = entry?;
            let name = format!("{before}{}", entry.file_name().to_string_lossy());
            if entry.file_type()?.is_dir() {
                below(&entry.path(), &format!("{name}/"), earlier)?;
            } else if earlier.files.contains(&name) {
                fs::remove_file(entry.path())?;
            }
        }
        fs::remove_dir(folder)
    }
    match earlier {
        Some(earlier) => below(folder, "", earlier),
        None => fs::remove_dir(folder),
    }
    .map_err(io("output_error.remove", folder))
}
