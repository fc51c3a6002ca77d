//! The figures of a result against those that its recording gives when the test is run anew, in a process of its own.

use super::finding::Finding;
use super::folder::{Folder, run_of};
use super::pages::languages;
use super::parts;
use crate::executable;
use crate::i18n::note;
use crate::output::{
    Kind, LIMITS_FILE, PROCEDURE_FILE, found_below, read_below, sha256_below, sha256_of_file,
};
use crate::record::read::MAX_BYTES;
use crate::record::{LotUnit, RunKind, RunRecord};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Sources that a result is recomputed from.
#[derive(Debug, Clone, Copy)]
pub struct Anew<'a> {
    /// The recordings: of a result its own, of a lot those of its units.
    pub recording: &'a [PathBuf],
    /// The procedure; the copy in the folder without one.
    pub procedure: Option<&'a Path>,
    /// The limits; the copy in the folder without any.
    pub limits: Option<&'a Path>,
    /// Templates that the pages and drawings were made with.
    pub templates: Option<&'a Path>,
    /// Further options that the result was made with.
    pub options: &'a [String],
}

/// Members of a record that do not follow from recording and procedure, or are compared apart: who tested and when, what a store knew,
/// where files lay.
const UNCOMPARED_MEMBERS: [&str; 10] = [
    "format",
    "program",
    "session",
    "attempt",
    "siblings",
    "inputs",
    "files",
    "procedure",
    "unit_under_test",
    "explained",
];

/// Members that no option changes unless it changes the procedure.
const DECISIVE_MEMBERS: [&str; 2] = ["verdict", "measurands"];

/// Computes a result, or every unit of a lot, from its recording anew and compares what was measured, with tables and figures.
pub fn anew(folder: &Folder, how: Anew<'_>) -> Vec<Finding> {
    match folder.kind {
        Kind::Result => match run_of(folder) {
            Some(run) => of_result(folder, &run, how),
            None => vec![Finding::Undone("verify.not_computed".into())],
        },
        Kind::Lot => of_lot(folder, how),
        _ => vec![Finding::Undone("verify.not_computed".into())],
    }
}

fn of_lot(folder: &Folder, how: Anew<'_>) -> Vec<Finding> {
    let lot = match parts::record(folder) {
        Ok(lot) => lot,
        Err(note) => return vec![Finding::Undone(note)],
    };
    let hashes: Vec<Option<String>> = how.recording.iter().map(|path| sha256_of_file(path)).collect();
    let each = |unit: &LotUnit| {
        let named = how.recording.iter().zip(&hashes).find(|(path, hash)| is_of(unit, path, hash.as_deref()));
        let at = parts::folder_of(folder, unit);
        let found = match (named, at.and_then(|at| run_of(&at).map(|run| (at, run)))) {
            (Some((recording, _)), Some((at, run))) => {
                of_result(&at, &run, Anew { recording: std::slice::from_ref(recording), ..how })
            }
            (None, _) => vec![Finding::Undone("verify.no_recording_of_unit".into())],
            (_, None) => vec![Finding::Undone("verify.not_computed".into())],
        };
        found.into_iter().map(|finding| parts::below(&unit.folder, finding)).collect::<Vec<_>>()
    };
    lot.units.iter().flat_map(each).collect()
}

/// True for the recording of a unit: the file that was read, or a manifest of the same name.
fn is_of(unit: &LotUnit, path: &Path, hash: Option<&str>) -> bool {
    match unit.files.as_slice() {
        [one] if hash == Some(one.sha256.as_str()) => true,
        _ => Path::new(&unit.recording).file_name().is_some_and(|name| path.file_name() == Some(name)),
    }
}

fn of_result(folder: &Folder, run: &RunRecord, how: Anew<'_>) -> Vec<Finding> {
    if how.procedure.is_none() && runs_programs(folder) {
        return vec![Finding::Undone("verify.own_program".into())];
    }
    let stated: Value = read_below(&folder.path, folder.kind.record_file(), MAX_BYTES as u64)
        .ok()
        .and_then(|bytes| serde_json::from_slice(&bytes).ok())
        .unwrap_or_default();
    let (Ok(scratch), Ok(program)) = (tempfile::tempdir(), executable::path()) else {
        return vec![Finding::Undone("verify.no_scratch".into())];
    };
    let out = scratch.path().join("anew");
    let mut command = Command::new(program);
    arguments(&mut command, folder, run, &stated, how);
    command.arg("--out").arg(&out).arg("--quiet").args(how.options);
    let ran = command.output();
    let made = std::fs::read(out.join(Kind::Result.record_file())).ok();
    let made: Option<Value> = made.and_then(|bytes| serde_json::from_slice(&bytes).ok());
    let Some(made) = made else {
        let said = ran.map(|o| String::from_utf8_lossy(&o.stderr).trim().to_owned()).unwrap_or_default();
        return vec![Finding::Undone(note!("verify.cannot_compute", reason = said))];
    };
    compare(&stated, &made, || files(folder, &out))
}

/// True where a procedure of the folder runs a program: nobody who only checks a folder runs what came with it.
fn runs_programs(folder: &Folder) -> bool {
    let has_programs = |name: &str| {
        let bytes = read_below(&folder.path, name, MAX_BYTES as u64).unwrap_or_default();
        let table: Option<toml::Table> = toml::from_str(&String::from_utf8_lossy(&bytes)).ok();
        table.is_some_and(|table| table.contains_key("program"))
    };
    let found = found_below(&folder.path).unwrap_or_default();
    found.iter().any(|(name, _)| name.ends_with(".toml") && has_programs(name))
}

/// The arguments that the result was made with, as far as its folder tells them.
fn arguments(command: &mut Command, folder: &Folder, run: &RunRecord, stated: &Value, how: Anew<'_>) {
    match run.kind {
        RunKind::Run => {
            let procedure = how.procedure.map_or_else(|| folder.path.join(PROCEDURE_FILE), Path::to_owned);
            // The settings of the user may name a store, which must not keep this check as another attempt.
            command.arg("run").arg(procedure).args(how.recording).arg("--no-store");
            let copy = folder.path.join(LIMITS_FILE);
            let had_limits = run.procedure.as_ref().is_some_and(|p| p.limits.is_some());
            let copy = (had_limits && copy.is_file()).then_some(copy);
            if let Some(limits) = how.limits.map(Path::to_owned).or(copy) {
                command.arg("--limits").arg(limits);
            }
            // A bench is named by its station where the procedure does not name it, and was released by a check.
            if let Some(bench) = &run.bench {
                if let Some(station) = &run.session.station {
                    command.args(["--station", station]);
                }
                let check = bench.check.as_ref().map(|c| c.folder.as_str()).filter(|c| Path::new(c).is_dir());
                command.args(check.into_iter().flat_map(|folder| ["--bench-check", folder]));
            }
            // A number that only the recording states is an input no more than any other column of it.
            if let Some(serial) = stated.pointer("/inputs/unit").and_then(Value::as_str) {
                command.args(["--serial", serial]);
            }
        }
        RunKind::Analyze => {
            command.arg("analyze").args(how.recording);
        }
    }
    if how.recording.len() > 1 {
        command.arg("--join");
    }
    if let Some(templates) = how.templates {
        command.arg("--templates").arg(templates);
    }
    if let Some(lang) = languages(folder).first() {
        command.args(["--lang", lang.code()]);
    }
}

/// What two records of the same test say of the same recording; `files` compares what stands beside them.
fn compare(stated: &Value, made: &Value, files: impl FnOnce() -> Vec<String>) -> Vec<Finding> {
    let hashes = |record: &Value| -> Vec<String> {
        let files = record["recording"].as_array().cloned().unwrap_or_default();
        files.iter().map(|f| f["sha256"].as_str().unwrap_or_default().to_owned()).collect()
    };
    if hashes(stated) != hashes(made) {
        return vec![Finding::Differs("verify.other_recording".into())];
    }
    if hashes(made).is_empty() {
        return vec![Finding::Undone("verify.nothing_read".into())];
    }
    let mut findings = vec![];
    let unlike = other_inputs(stated, made);
    if !unlike.is_empty() {
        findings.push(Finding::Undone(note!("verify.other_inputs", names = unlike.join(", "))));
    }
    let version = |record: &Value| record["program"]["version"].as_str().unwrap_or_default().to_owned();
    let (written, this) = (version(stated), version(made));
    let n = stated["measurands"].as_array().map_or(0, Vec::len);
    let mut differing = fields(stated, made);
    differing.extend(files());
    // Other options give other tables and figures; what was measured and decided is another matter.
    if !findings.is_empty() && !differing.iter().any(|name| DECISIVE_MEMBERS.contains(&name.as_str())) {
        return findings;
    }
    findings.push(match (differing.is_empty(), written == this) {
        (true, _) => Finding::Agrees(note!("verify.computed", n)),
        (false, true) => Finding::Differs(note!("verify.computed_differs", names = differing.join(", "))),
        (false, false) => Finding::Undone(note!("verify.computed_by_other", written, this)),
    });
    findings
}

/// The names of the inputs in which two records differ.
fn other_inputs(stated: &Value, made: &Value) -> Vec<String> {
    let inputs = |record: &Value| -> BTreeMap<String, String> {
        serde_json::from_value(record["inputs"].clone()).unwrap_or_default()
    };
    let (own, other) = (inputs(stated), inputs(made));
    let names: BTreeSet<&String> = own.keys().chain(other.keys()).collect();
    names.into_iter().filter(|name| own.get(*name) != other.get(*name)).cloned().collect()
}

/// The fields in which two records differ, wherever their recordings lay.
fn fields(stated: &Value, made: &Value) -> Vec<String> {
    let (mut stated, mut made) = (stated.clone(), made.clone());
    let serial = |record: &Value| record.pointer("/unit_under_test/serial").cloned().unwrap_or_default();
    let other_serial = serial(&stated) != serial(&made);
    let paths = |record: &Value| -> Vec<String> {
        let files = record["recording"].as_array().cloned().unwrap_or_default();
        files.iter().filter_map(|f| f["path"].as_str().map(str::to_owned)).collect()
    };
    let moved: Vec<(String, String)> = paths(&made).into_iter().zip(paths(&stated)).collect();
    for record in [&mut stated, &mut made] {
        without_places(record);
    }
    rename(&mut made, &moved);
    let keys: BTreeSet<&String> =
        [&stated, &made].into_iter().filter_map(Value::as_object).flat_map(|o| o.keys()).collect();
    let differ =
        |key: &&String| !UNCOMPARED_MEMBERS.contains(&key.as_str()) && stated.get(*key) != made.get(*key);
    let mut names: Vec<String> = keys.into_iter().filter(differ).cloned().collect();
    names.extend(other_serial.then(|| "unit_under_test".to_owned()));
    names
}

/// Leaves out where limits and procedures were read from: copies stand elsewhere.
fn without_places(record: &mut Value) {
    let mut parts = vec![record];
    while let Some(part) = parts.pop() {
        for row in part["measurands"].as_array_mut().into_iter().flatten() {
            if let Some(limit) = row["limit"].as_object_mut() {
                limit.remove("source");
            }
        }
        let Some(fields) = part.as_object_mut() else { continue };
        if let Some(phases) = fields.get_mut("phases").and_then(Value::as_array_mut) {
            for phase in phases {
                if let Some(phase) = phase.as_object_mut() {
                    phase.remove("procedure");
                }
                parts.push(phase);
            }
        }
    }
}

/// Writes the paths of one record in place of those of the other, wherever a text quotes them.
fn rename(value: &mut Value, moved: &[(String, String)]) {
    match value {
        Value::String(text) => {
            for (made, stated) in moved.iter().filter(|(made, stated)| made != stated && !made.is_empty()) {
                *text = text.replace(made.as_str(), stated);
            }
        }
        Value::Array(items) => items.iter_mut().for_each(|item| rename(item, moved)),
        Value::Object(fields) => fields.values_mut().for_each(|field| rename(field, moved)),
        _ => {}
    }
}

/// Tables, drawings and the data of figures that differ between a folder and one that was made anew, or that only one of them has.
fn files(folder: &Folder, made: &Path) -> Vec<String> {
    let is_data = |name: &str| {
        let last = name.rsplit('/').next().unwrap_or(name);
        Kind::Result.is_table(last) || Kind::Explanation.is_table(last) || name.contains("figures/")
    };
    let of = |root: &Path| -> BTreeSet<String> {
        let found = found_below(root).unwrap_or_default();
        found.into_iter().map(|(name, _)| name).filter(|name| is_data(name)).collect()
    };
    let (own, other) = (of(&folder.path), of(made));
    let hash = |root: &Path, name: &str| sha256_below(root, name).ok();
    let differs = |name: &&String| {
        // A form that was not chosen is not there.
        own.contains(*name) && hash(&folder.path, name) != hash(made, name)
    };
    own.union(&other).filter(differs).cloned().collect()
}
