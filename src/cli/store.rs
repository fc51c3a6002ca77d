//! `sagnac store`: a store of results, made, looked after and exchanged with others.

use super::{exit, place};
use crate::i18n::{Lang, Localize, Note, note};
use crate::ingest::io_reason;
use crate::ingest::result_table::{TableResult, results_in, tables_at};
use crate::moment;
use crate::output::Kind;
use crate::store::{self, Filter, RecordingSearch, Store, StoreError, result_folders};
use chrono::SecondsFormat;
use clap::{Args, Subcommand};
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub struct StoreVerbArgs {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    /// Make a store in an empty folder
    Init {
        /// Folder of the store
        #[arg(value_name = "STORE")]
        store: PathBuf,
        /// Several machines will use the store: locks in place of memory that its users share
        #[arg(long)]
        shared_disk: bool,
    },
    /// Add results that were made elsewhere: folders, or tables of an archive; and find recordings that have moved
    Import {
        /// Folder of the store
        #[arg(value_name = "STORE")]
        store: PathBuf,
        /// Result folders, Parquet tables of results, or folders that hold some
        #[arg(required = true, value_name = "DIR")]
        folders: Vec<PathBuf>,
        /// Folders in which recordings are looked for by their hashes
        #[arg(long, value_name = "DIR")]
        recordings: Vec<PathBuf>,
    },
    /// Write a table of all measurands (Parquet), one row each
    Export {
        /// Folder of the store
        #[arg(value_name = "STORE")]
        store: PathBuf,
        /// File to write
        #[arg(long, value_name = "FILE")]
        out: PathBuf,
        /// Replace the file if it exists
        #[arg(long)]
        force: bool,
    },
    /// State that a result counts in place of another, and why; both stay in the store
    Supersede {
        /// Folder of the store
        #[arg(value_name = "STORE")]
        store: PathBuf,
        /// Address of the result that does not count any more, or its beginning
        #[arg(value_name = "ADDRESS")]
        superseded: String,
        /// Address of the result that counts in its place, or its beginning
        #[arg(long, value_name = "ADDRESS")]
        by: String,
        /// Reason
        #[arg(long, value_name = "TEXT")]
        reason: String,
        /// Name of the operator
        #[arg(long, value_name = "NAME")]
        operator: Option<String>,
    },
    /// Move copies of recordings out of the store; results stay
    Prune {
        /// Folder of the store
        #[arg(value_name = "STORE")]
        store: PathBuf,
        /// Folder that the copies are moved to
        #[arg(long, value_name = "DIR")]
        to: PathBuf,
        /// Leave the copies of results that were evaluated on this day or later
        #[arg(long, value_name = "DATE")]
        before: Option<String>,
    },
    /// Rebuild the index from the result folders
    Rebuild {
        /// Folder of the store
        #[arg(value_name = "STORE")]
        store: PathBuf,
    },
    /// Read everything anew: hashes, index, recordings, signatures, chains of attempts
    Verify {
        /// Folder of the store
        #[arg(value_name = "STORE")]
        store: PathBuf,
    },
}

pub fn main(args: &StoreVerbArgs, lang: Lang) -> Result<u8, String> {
    let say = |e: StoreError| place::error(&e.note(), lang);
    match &args.what {
        What::Init { store, shared_disk } => {
            for note in store::init(store, *shared_disk).map_err(say)? {
                place::eprint_diagnostic(&place::warning(&note, lang));
            }
            done(&note!("store.made", store = place::shown(store)), lang)
        }
        What::Import { store, folders, recordings } => import(store, folders, recordings, lang),
        What::Export { store, out, force } => {
            let opened = open_to_read(store, lang)?;
            let rows = store::export(&opened, &Filter::default(), out, *force).map_err(say)?;
            done(&note!("store.exported", n = rows, file = place::shown(out)), lang)
        }
        What::Supersede { store, superseded, by, reason, operator } => {
            let mut opened = said(Store::open(store), lang)?;
            let operator = operator.as_deref().unwrap_or_default();
            opened.supersede(superseded, by, reason, operator, now()).map_err(say)?;
            done(&"store.superseded".into(), lang)
        }
        What::Prune { store, to, before } => {
            let mut opened = said(Store::open(store), lang)?;
            let moved = opened.prune(to, before.as_deref(), &now()).map_err(say)?;
            done(&note!("store.pruned", n = moved, folder = place::shown(to)), lang)
        }
        What::Rebuild { store } => {
            let rebuilt = store::rebuild(store).map_err(say)?;
            let note = note!("store.rebuilt", n = rebuilt.results);
            found(&rebuilt.findings, &note.with("statements", rebuilt.statements), lang)
        }
        What::Verify { store } => {
            let opened = said(Store::open_to_verify(store), lang)?;
            let verified = store::verify(&opened).map_err(say)?;
            let note = note!("store.verified", n = verified.results);
            let note = note.with("statements", verified.statements).with("wrong", verified.findings.len());
            found(&verified.findings, &note, lang)
        }
    }
}

fn now() -> String {
    moment::now().to_rfc3339_opts(SecondsFormat::Secs, true)
}

/// Opens a store to ask it, and says what must be known of it.
///
/// # Errors
/// The diagnostic, in words.
pub fn open_to_read(path: &Path, lang: Lang) -> Result<Store, String> {
    said(Store::open_to_read(path), lang)
}

/// A store that was opened, with what must be known of it said.
fn said(opened: Result<Store, StoreError>, lang: Lang) -> Result<Store, String> {
    let store = opened.map_err(|e| place::error(&e.note(), lang))?;
    for note in store.notes() {
        place::eprint_diagnostic(&place::warning(note, lang));
    }
    Ok(store)
}

fn done(note: &Note, lang: Lang) -> Result<u8, String> {
    place::print(&format!("{}\n", note.say(lang)));
    Ok(exit::PASS)
}

/// Says what was found to be wrong, then how much was looked at; what is wrong is a failure.
fn found(findings: &[store::Finding], note: &Note, lang: Lang) -> Result<u8, String> {
    for finding in findings {
        place::eprint_diagnostic(&place::error(&finding.note(), lang));
    }
    done(note, lang)?;
    Ok(if findings.is_empty() { exit::PASS } else { exit::FAIL })
}

/// What came of an import.
#[derive(Default)]
struct Tally {
    new: usize,
    known: usize,
    refused: usize,
    /// Results without files that they list, with the names of these.
    incomplete: Vec<(PathBuf, Vec<String>)>,
}

impl Tally {
    fn add(&mut self, store: &mut Store, folder: &Path, lang: Lang) -> Result<(), String> {
        let added = match store.add(folder) {
            Ok(added) => added,
            // A folder that is no result is left out; a store that cannot be written ends the import.
            Err(
                e @ (StoreError::Result { .. }
                | StoreError::NoTest(_)
                | StoreError::NoFile(_)
                | StoreError::Contradicted { .. }
                | StoreError::OtherSignatures(_)),
            ) => {
                self.refuse(&e.note(), lang);
                return Ok(());
            }
            Err(e) => return Err(place::error(&e.note(), lang)),
        };
        if !added.missing.is_empty() {
            self.incomplete.push((folder.to_owned(), added.missing));
        }
        *if added.new { &mut self.new } else { &mut self.known } += 1;
        Ok(())
    }

    /// Adds the results of a table: each becomes a folder with its record alone.
    fn add_table(&mut self, store: &mut Store, table: &Path, lang: Lang) -> Result<(), String> {
        let say = |note: &Note| place::error(note, lang);
        for row in results_in(table).map_err(|note| say(&note))? {
            let TableResult { name, record } = row.map_err(|note| say(&note))?;
            let Some(record) = record else {
                self.refuse(&note!("result_table.no_result", recording = name), lang);
                continue;
            };
            let folder = tempfile::tempdir();
            let folder = folder.and_then(|folder| {
                std::fs::write(folder.path().join(Kind::Result.record_file()), record)?;
                Ok(folder)
            });
            let folder = folder.map_err(|e| say(&note!("store.no_scratch", reason = io_reason(&e))))?;
            self.add(store, folder.path(), lang)?;
        }
        Ok(())
    }

    fn refuse(&mut self, note: &Note, lang: Lang) {
        place::eprint_diagnostic(&place::warning(note, lang));
        self.refused += 1;
    }
}

fn import(store: &Path, folders: &[PathBuf], recordings: &[PathBuf], lang: Lang) -> Result<u8, String> {
    let say = |e: StoreError| place::error(&e.note(), lang);
    let mut opened = said(Store::open(store), lang)?;
    let mut tally = Tally::default();
    for named in folders {
        let is_table = !named.is_dir() && !tables_at(named).is_empty();
        let results = if is_table { vec![] } else { result_folders(named).map_err(say)? };
        let tables = if results.is_empty() { tables_at(named) } else { vec![] };
        if results.is_empty() && tables.is_empty() {
            let note = note!("result_error.no_result_in", path = place::shown(named));
            return Err(place::error(&note, lang));
        }
        for folder in results {
            tally.add(&mut opened, &folder, lang)?;
        }
        for table in tables {
            tally.add_table(&mut opened, &table, lang)?;
        }
    }
    let Tally { new, known, refused, incomplete } = tally;
    let note = note!("store.imported", new, known, refused);
    done(&note, lang)?;
    if let Some((folder, names)) = incomplete.first() {
        let files: usize = incomplete.iter().map(|(_, names)| names.len()).sum();
        let note = note!("store.files_missing", results = incomplete.len(), files);
        let note = note.with("path", place::shown(folder)).with("names", names.join(", "));
        place::eprint_diagnostic(&place::warning(&note, lang));
    }
    if !recordings.is_empty() {
        let RecordingSearch { found, in_place, missing } =
            opened.find_recordings(recordings, &now()).map_err(say)?;
        let note = note!("store.recordings", found, in_place);
        done(&note.with("missing", missing), lang)?;
    }
    Ok(if refused > 0 { exit::FAIL } else { exit::PASS })
}
