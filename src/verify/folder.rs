//! The files of a folder against the hashes that it states.

use super::Finding;
use crate::i18n::{Note, io_reason};
use crate::output::{CHECKSUMS_FILE, Kind, read_checksums, sha256};
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
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
            None => Err(Note::new("result_error.no_result_in").with("path", folder.display().to_string())),
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

/// Computes the hash of every file of a folder anew. What `beside` names, such as signatures, is looked at elsewhere.
pub fn hashes(folder: &Folder, beside: &str) -> Vec<Finding> {
    let differs = |key: &'static str, name: &str| Finding::Differs(Note::new(key).with("name", name));
    let stated = fs::read_to_string(folder.path.join(CHECKSUMS_FILE));
    let stated = match stated {
        Ok(text) => match read_checksums(&text) {
            Some(stated) => stated,
            None => return vec![differs("verify.hashes_changed", CHECKSUMS_FILE)],
        },
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => {
            return vec![Finding::Differs("verify.no_hashes".into())];
        }
        Err(_) => return vec![differs("verify.hashes_changed", CHECKSUMS_FILE)],
    };
    let mut findings = vec![];
    for (name, hash) in &stated {
        match fs::read(folder.path.join(name)) {
            Ok(bytes) if sha256(&bytes) == *hash => {}
            Ok(_) => findings.push(differs("verify.changed", name)),
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => {
                findings.push(differs("verify.missing", name))
            }
            Err(e) => findings.push(Finding::Differs(
                Note::new("verify.unreadable").with("name", name.as_str()).with("reason", io_reason(&e)),
            )),
        }
    }
    let listing =
        fs::read(folder.record_file()).ok().and_then(|b| serde_json::from_slice::<Listing>(&b).ok());
    let listed = listing.map(|l| l.files).unwrap_or_default();
    // A lot lists its own files; the folders of its units have lists of their own.
    let own = |name: &&String| folder.kind != Kind::Lot || !name.contains('/');
    for name in stated.keys().filter(own).filter(|name| !listed.contains(*name)) {
        findings.push(differs("verify.unlisted", name));
    }
    for name in listed.iter().filter(|n| *n != CHECKSUMS_FILE && !stated.contains_key(*n)) {
        findings.push(differs("verify.no_hash_of", name));
    }
    for name in found(&folder.path, beside) {
        if name != CHECKSUMS_FILE && !stated.contains_key(&name) {
            findings.push(differs("verify.added", &name));
        }
    }
    if findings.is_empty() {
        findings.push(Finding::Agrees(Note::new("verify.hashes").with("n", stated.len())));
    }
    findings
}

/// The files of a folder by their names, without those below the folder `beside`.
fn found(root: &Path, beside: &str) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    let mut open = vec![(root.to_owned(), String::new())];
    while let Some((folder, before)) = open.pop() {
        for entry in fs::read_dir(&folder).into_iter().flatten().flatten() {
            let name = format!("{before}{}", entry.file_name().to_string_lossy());
            // A link to a folder is no folder.
            if entry.file_type().is_ok_and(|t| t.is_dir()) {
                if name != beside {
                    open.push((entry.path(), format!("{name}/")));
                }
            } else {
                names.insert(name);
            }
        }
    }
    names
}

/// The hashes of a folder by the names of its files, as stated; empty where it states none.
pub fn stated_hashes(folder: &Path) -> BTreeMap<String, String> {
    fs::read_to_string(folder.join(CHECKSUMS_FILE)).ok().and_then(|t| read_checksums(&t)).unwrap_or_default()
}
