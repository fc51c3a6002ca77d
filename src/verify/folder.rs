//! The files of a folder against the hashes that it states, and the texts that a test was made by against those in its record.

use super::finding::Finding;
use crate::i18n::{Note, io_reason, note};
use crate::output::{
    CHECKSUMS_FILE, Found, Kind, LIMITS_FILE, NotRead, PROCEDURE_FILE, found_below, read_below,
    read_checksums, sha256, sha256_below,
};
use crate::record::read::{self, MAX_BYTES};
use crate::record::{ProcedureRecord, RunKind, RunRecord};
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// A folder of results.
#[derive(Debug, Clone)]
pub struct Folder {
    /// Where it is.
    pub path: PathBuf,
    /// What it holds.
    pub kind: Kind,
}

impl Folder {
    /// The folder that a path stands for: itself, or that of the record it names.
    ///
    /// # Errors
    /// A note where there is no record of this program.
    pub fn at(path: &Path) -> Result<Folder, Note> {
        let folder = if path.is_dir() {
            path.to_owned()
        } else {
            path.parent().map(Path::to_owned).unwrap_or_default()
        };
        let folder = if folder.as_os_str().is_empty() { PathBuf::from(".") } else { folder };
        let kind = Kind::ALL.into_iter().find(|k| folder.join(k.record_file()).is_file());
        match kind {
            Some(kind) => Ok(Folder { path: folder, kind }),
            None => Err(note!("result_error.no_result_in", path = folder.display().to_string())),
        }
    }

    /// The record of the folder.
    pub fn record_file(&self) -> PathBuf {
        self.path.join(self.kind.record_file())
    }
}

/// What a record lists.
#[derive(Deserialize)]
struct Listing {
    #[serde(default)]
    files: BTreeSet<String>,
}

/// Computes the hash of every file of a folder anew. What stands below folders named `beside`, that of the signatures, is looked at
/// elsewhere.
pub fn hashes(folder: &Folder, beside: &str) -> Vec<Finding> {
    let differs = |key: &'static str, name: &str| Finding::Differs(Note::new(key).with("name", name));
    let stated = match read_below(&folder.path, CHECKSUMS_FILE, MAX_BYTES as u64) {
        Ok(bytes) => match std::str::from_utf8(&bytes).ok().and_then(read_checksums) {
            Some(stated) => stated,
            None => return vec![differs("verify.hashes_changed", CHECKSUMS_FILE)],
        },
        Err(NotRead::Missing) => return vec![Finding::Differs("verify.no_hashes".into())],
        Err(why) => return vec![not_read(CHECKSUMS_FILE, &why)],
    };
    let mut findings = vec![];
    for (name, hash) in &stated {
        match sha256_below(&folder.path, name) {
            Ok(found) if found == *hash => {}
            Ok(_) => findings.push(differs("verify.changed", name)),
            Err(why) => findings.push(not_read(name, &why)),
        }
    }
    let listing = read_below(&folder.path, folder.kind.record_file(), MAX_BYTES as u64).ok();
    let listing = listing.and_then(|b| serde_json::from_slice::<Listing>(&b).ok());
    let listed = listing.map(|l| l.files).unwrap_or_default();
    // A lot lists its own files; the folders of its units have lists of their own.
    let own = |name: &&String| folder.kind != Kind::Lot || !name.contains('/');
    for name in stated.keys().filter(own).filter(|name| !listed.contains(*name)) {
        findings.push(differs("verify.unlisted", name));
    }
    for name in listed.iter().filter(|n| *n != CHECKSUMS_FILE && !stated.contains_key(*n)) {
        findings.push(differs("verify.no_hash_of", name));
    }
    findings.extend(added(folder, beside, &stated));
    if findings.is_empty() {
        findings.push(Finding::Agrees(note!("verify.hashes", n = stated.len())));
    }
    findings
}

/// What a folder holds and does not state.
fn added(folder: &Folder, beside: &str, stated: &BTreeMap<String, String>) -> Vec<Finding> {
    let found = match found_below(&folder.path) {
        Ok(found) => found,
        Err(e) => return vec![not_read(".", &NotRead::Io(e))],
    };
    // The signatures of a unit of a lot belong to the unit.
    let is_beside = |name: &str| {
        let of_unit = name.split_once('/').filter(|_| folder.kind == Kind::Lot).map_or("", |(_, rest)| rest);
        [name, of_unit].iter().any(|n| n.split('/').next() == Some(beside))
    };
    let others = found.into_iter().filter(|(name, kind)| match kind {
        // What is stated and is no file was named where its hash was to be computed.
        _ if name == CHECKSUMS_FILE || is_beside(name) => false,
        _ => !stated.contains_key(name),
    });
    others
        .map(|(name, kind)| {
            let key = match kind {
                Found::File => "verify.added",
                Found::EmptyFolder => "verify.empty_folder",
                Found::Link => "verify.link_in_place",
                Found::Special => "verify.no_file",
            };
            Finding::Differs(Note::new(key).with("name", name))
        })
        .collect()
}

/// Why a file that is stated was not read.
fn not_read(name: &str, why: &NotRead) -> Finding {
    let key = match why {
        NotRead::Outside => "verify.outside",
        NotRead::Missing => "verify.missing",
        NotRead::Link => "verify.link_in_place",
        NotRead::NoFile => "verify.no_file",
        NotRead::TooLarge => "verify.too_large",
        NotRead::Io(e) => {
            let note = note!("verify.unreadable", name, reason = io_reason(e));
            return Finding::Differs(note);
        }
    };
    Finding::Differs(Note::new(key).with("name", name))
}

/// The hashes of a folder by the names of its files, as stated; empty where it states none.
pub fn stated_hashes(folder: &Path) -> BTreeMap<String, String> {
    let bytes = read_below(folder, CHECKSUMS_FILE, MAX_BYTES as u64).unwrap_or_default();
    std::str::from_utf8(&bytes).ok().and_then(read_checksums).unwrap_or_default()
}

/// The copies of procedure and limits, also those of phases.
pub(super) fn texts(folder: &Path, run: &RunRecord) -> Vec<Finding> {
    if run.kind != RunKind::Run {
        return vec![];
    }
    // A procedure of several phases names the files of these, which have folders of their own.
    let own = run.procedure.iter().filter(|_| run.phases.is_empty()).map(|p| (String::new(), p));
    let phases =
        run.phases.iter().filter_map(|p| Some((format!("{}/", p.folder.as_ref()?), p.procedure.as_ref()?)));
    own.chain(phases).flat_map(|(below, procedure)| copies_of(folder, &below, procedure)).collect()
}

fn copies_of(folder: &Path, below: &str, procedure: &ProcedureRecord) -> Vec<Finding> {
    let limits = procedure.limits.as_ref().map(|l| (LIMITS_FILE, &l.sha256));
    let each = |(name, stated): (&str, &String)| {
        let name = format!("{below}{name}");
        let note = |key: &'static str| Note::new(key).with("name", name.as_str());
        match read_below(folder, &name, MAX_BYTES as u64) {
            Ok(bytes) if sha256(&bytes) == *stated => None,
            Ok(_) => Some(Finding::Differs(note("verify.not_that_text"))),
            // Earlier versions kept no copies, and did not state which signatures are asked for.
            Err(NotRead::Missing) if procedure.signatures.is_none() => {
                Some(Finding::Undone(note("verify.no_text")))
            }
            Err(NotRead::Missing) => Some(Finding::Differs(note("verify.missing"))),
            // Named where the hashes were computed.
            Err(_) => None,
        }
    };
    std::iter::once((PROCEDURE_FILE, &procedure.sha256)).chain(limits).filter_map(each).collect()
}

/// The record of a run or an analysis that a folder holds.
pub fn run_of(folder: &Folder) -> Option<RunRecord> {
    match folder.kind {
        Kind::Result => read::open(&folder.record_file()).ok(),
        _ => None,
    }
}
