//! The signatures of a folder, one after the other.

use super::key::{self, Invalid, KeyError};
use super::role::Role;
use super::statement::{Previous, SIGN_OFF, STATEMENT_TYPE, SignOff, Statement, Subject};
use crate::i18n::{Note, io_reason, note};
use crate::output::{
    CHECKSUMS_FILE, Found, SIGNATURES_FOLDER, StagedFile, found_below, is_partial, read_below, sha256,
    sha256_below,
};
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::path::Path;

/// Ending of the file of a signature, behind the name of its statement.
const SIGNATURE_ENDING: &str = ".sig";

/// Ending of the file of a statement.
const STATEMENT_ENDING: &str = ".json";

/// Largest statement or signature that is read, bytes.
const MAX_BYTES: u64 = 64 << 20;

/// One statement with its signature.
#[derive(Debug, Clone)]
pub struct Link {
    /// File of the statement.
    pub name: String,
    /// Its statement; `None` where it cannot be read.
    pub statement: Option<Statement>,
    /// The key that signed it; `None` where the signature does not hold.
    pub key: Option<ssh_key::PublicKey>,
    /// Its faults.
    pub broken: Vec<Broken>,
    sha256: String,
}

/// A fault of a link.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Broken {
    /// It is no statement of this kind.
    NoStatement,
    /// Its signature is missing.
    Unsigned,
    /// Its signature does not hold, in the words of the library.
    Signature(String),
    /// Its signature was written otherwise than signatures are.
    Rewritten,
    /// A file is not what was signed.
    File(String),
    /// A file of the folder is not among those that were signed.
    Unsaid(String),
    /// It does not name the statement that stands before it.
    Previous,
}

impl Link {
    /// The fingerprint of its key.
    pub fn fingerprint(&self) -> Option<String> {
        self.key.as_ref().map(key::fingerprint)
    }

    /// Its role; `None` where nothing can be read.
    pub fn role(&self) -> Option<Role> {
        self.statement.as_ref().map(|s| s.predicate.role)
    }
}

/// The links of a folder in their order, each with what is wrong with it. `files` are the hashes of the files of the folder as
/// they are, by their names.
pub fn chain(folder: &Path, files: &BTreeMap<String, String>) -> Vec<Link> {
    let at = folder.join(SIGNATURES_FOLDER);
    let (statements, _) = contents(folder);
    let mut links: Vec<Link> = vec![];
    for name in statements {
        let bytes = read_below(&at, &name, MAX_BYTES).unwrap_or_default();
        let mut broken = vec![];
        let statement = statement(&bytes);
        let signature = read_below(&at, &format!("{name}{SIGNATURE_ENDING}"), MAX_BYTES).ok();
        let key = match signature.and_then(|bytes| String::from_utf8(bytes).ok()) {
            Some(signature) => match key::verify(&bytes, &signature) {
                Ok(key) => Some(key),
                Err(why) => {
                    broken.push(match why {
                        Invalid::Library(why) => Broken::Signature(why),
                        Invalid::Rewritten => Broken::Rewritten,
                    });
                    None
                }
            },
            None => {
                broken.push(Broken::Unsigned);
                None
            }
        };
        match &statement {
            None => broken.push(Broken::NoStatement),
            Some(statement) => {
                broken.extend(differing(statement, files));
                let before =
                    links.last().map(|l| Previous { name: l.name.clone(), sha256: l.sha256.clone() });
                if statement.predicate.previous != before {
                    broken.push(Broken::Previous);
                }
            }
        }
        links.push(Link { sha256: sha256(&bytes), name, statement, key, broken });
    }
    links
}

/// The content of the folder of signatures: the names of statements in their order, and everything that is neither a statement nor the
/// signature of one.
fn contents(folder: &Path) -> (Vec<String>, Vec<String>) {
    let found = found_below(&folder.join(SIGNATURES_FOLDER)).unwrap_or_default();
    let is_statement = |(name, kind): &&(String, Found)| {
        *kind == Found::File && name.ends_with(STATEMENT_ENDING) && !name.contains('/')
    };
    let statements: Vec<String> = found.iter().filter(is_statement).map(|(name, _)| name.clone()).collect();
    let own: BTreeSet<String> =
        statements.iter().flat_map(|name| [name.clone(), format!("{name}{SIGNATURE_ENDING}")]).collect();
    let others = found.into_iter().filter(|(name, kind)| *kind != Found::File || !own.contains(name));
    // What a killed process was writing goes with the next signature.
    let others = others.filter(|(name, kind)| *kind != Found::File || !is_partial(name));
    (statements, others.map(|(name, _)| name).collect())
}

/// The files of the signatures of a folder, by their names in the folder of signatures; a signature comes before its statement, as
/// it is written.
pub fn files(folder: &Path) -> Vec<String> {
    let (statements, _) = contents(folder);
    statements.into_iter().flat_map(|name| [format!("{name}{SIGNATURE_ENDING}"), name]).collect()
}

/// The entries among the signatures of a folder that are none, by their names in the folder.
pub fn strays(folder: &Path) -> Vec<String> {
    contents(folder).1.into_iter().map(|name| format!("{SIGNATURES_FOLDER}/{name}")).collect()
}

/// True for a signature without its statement, which a process that is killed between the two leaves behind.
pub fn is_leftover(stray: &str, statements: usize) -> bool {
    let beginning = format!("{SIGNATURES_FOLDER}/{:02}-", statements + 1);
    let ending = format!("{STATEMENT_ENDING}{SIGNATURE_ENDING}");
    stray
        .strip_prefix(&beginning)
        .and_then(|rest| rest.strip_suffix(&ending))
        .is_some_and(|role| Role::of(role).is_some())
}

fn statement(bytes: &[u8]) -> Option<Statement> {
    let statement: Statement = serde_json::from_slice(bytes).ok()?;
    let known = statement.statement_type == STATEMENT_TYPE && statement.predicate_type == SIGN_OFF;
    known.then_some(statement)
}

/// The files that differ from what a statement says of them, and those that it says nothing of.
fn differing(statement: &Statement, files: &BTreeMap<String, String>) -> Vec<Broken> {
    let signed: BTreeMap<&str, Option<&String>> =
        statement.subject.iter().map(|s| (s.name.as_str(), s.digest.get("sha256"))).collect();
    let changed = signed.iter().filter(|(name, hash)| files.get(**name) != **hash);
    let changed = changed.map(|(name, _)| Broken::File((*name).to_owned()));
    let unsaid = files.keys().filter(|name| !signed.contains_key(name.as_str()));
    changed.chain(unsaid.map(|name| Broken::Unsaid(name.clone()))).collect()
}

/// Holds the folder for one who signs it, so that two do not take the same place in the chain. Where the file system has no locks,
/// nothing is held.
pub fn hold(folder: &Path) -> Option<File> {
    let file = File::open(folder).ok()?;
    file.lock().ok().map(|()| file)
}

/// Signs the files of a folder that is held; gives the name of the statement. `about` says what is signed, without the statement
/// before it, which is filled in.
///
/// # Errors
/// A note where the key or the disk refuses.
pub fn sign(
    folder: &Path,
    files: &BTreeMap<String, String>,
    key: &Path,
    about: SignOff,
) -> Result<String, Note> {
    let links = chain(folder, files);
    let previous = links.last().map(|l| Previous { name: l.name.clone(), sha256: l.sha256.clone() });
    let name = format!("{:02}-{}{STATEMENT_ENDING}", links.len() + 1, about.role.id());
    let subject = files.iter().map(|(name, hash)| Subject {
        name: name.clone(),
        digest: BTreeMap::from([("sha256".to_owned(), hash.clone())]),
    });
    let statement = Statement {
        statement_type: STATEMENT_TYPE.to_owned(),
        subject: subject.collect(),
        predicate_type: SIGN_OFF.to_owned(),
        predicate: SignOff { previous, ..about },
    };
    let mut bytes =
        serde_json::to_vec_pretty(&statement).map_err(|e| note!("system.other", reason = e.to_string()))?;
    bytes.push(b'\n');
    let shown = key.display().to_string();
    let signature = key::sign(key, &bytes).map_err(|e| {
        let name = match e {
            KeyError::File(_) | KeyError::Unreadable(_) => "signing.key_unreadable",
            KeyError::Kind(_) => "signing.key_kind",
            KeyError::Agent(_) => "signing.agent",
        };
        Note::new(name).with("path", shown).with("reason", e.reason())
    })?;
    let at = folder.join(SIGNATURES_FOLDER);
    fs::create_dir_all(&at).map_err(|e| {
        let note = note!("output_error.create_folder", path = at.display().to_string());
        note.with("reason", io_reason(&e))
    })?;
    // What a killed process left of a signature at this place in the chain was never one.
    for stray in strays(folder).iter().filter(|stray| is_leftover(stray, links.len())) {
        let _ = fs::remove_file(folder.join(stray));
    }
    // The statement comes last: a signature without one is none.
    for (name, bytes) in
        [(format!("{name}{SIGNATURE_ENDING}"), signature.into_bytes()), (name.clone(), bytes)]
    {
        let staged = StagedFile::within_store(&at.join(&name)).map_err(|e| e.note())?;
        staged.publish_with(&bytes).map_err(|e| e.note())?;
    }
    Ok(name)
}

/// The hashes of the files of a folder as they are, by the names that it states, that of the list among them. What is no ordinary
/// file inside the folder has none.
pub fn files_of(folder: &Path, stated: impl Iterator<Item = String>) -> BTreeMap<String, String> {
    stated
        .chain(std::iter::once(CHECKSUMS_FILE.to_owned()))
        .filter_map(|name| Some((sha256_below(folder, &name).ok()?, name)))
        .map(|(hash, name)| (name, hash))
        .collect()
}
