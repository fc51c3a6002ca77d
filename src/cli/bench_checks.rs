//! The checks of benches that a run may rest on: a result that is named, or those of the store.

use super::place;
use super::run_args::RunArgs;
use crate::acceptance::bench::BenchCheck;
use crate::config::procedure::Procedure;
use crate::i18n::{Lang, Note};
use crate::moment;
use crate::output::{CHECKSUMS_FILE, Kind, SIGNATURES_FOLDER, sha256_below};
use crate::record::read;
use crate::store::address::address;
use crate::store::{Filter, Store, StoreError};
use crate::verify::{Folder, Signing, hashes, signatures, stated_hashes, verdict};
use std::path::Path;

/// The latest checks of a store that are looked at.
const MOST_CHECKS: usize = 100;

/// The checks that procedures which demand a released bench may rest on; `None` where none demands it, or where neither a result nor a
/// store is named.
///
/// # Errors
/// The diagnostic, in words: a folder without a result, or a store that cannot be read.
pub fn bench_checks<'p>(
    args: &RunArgs,
    procedures: impl Iterator<Item = &'p Procedure>,
    lang: Lang,
) -> Result<Option<Vec<BenchCheck>>, String> {
    let demanded = procedures.filter_map(|p| p.bench.as_ref()).filter(|b| b.released_within_s.is_some());
    let mut ids: Vec<&str> = demanded.map(|b| b.check.as_str()).collect();
    ids.sort_unstable();
    ids.dedup();
    if ids.is_empty() {
        return Ok(None);
    }
    if let Some(named) = &args.bench_check {
        return of_folder(named).map(|check| Some(vec![check])).map_err(|note| place::error(&note, lang));
    }
    let Some(path) = args.store.path(lang)? else { return Ok(None) };
    let say = |error: StoreError| place::error(&error.note(), lang);
    let store = Store::open_to_read(&path).map_err(say)?;
    let mut found = vec![];
    for id in ids {
        let filter = Filter { procedure: Some(id.to_owned()), ..Filter::default() };
        let attempts = store.attempts(&filter).map_err(say)?;
        let counting = attempts.iter().rev().filter(|a| a.superseded.is_none()).take(MOST_CHECKS);
        for attempt in counting {
            // One that cannot be read may have taken a release back: without it nothing is decided.
            let check = of_folder(&store.layout().result(&attempt.address));
            found.push(check.map_err(|note| place::error(&note, lang))?);
        }
    }
    Ok(Some(found))
}

/// The check in a folder, with what is wrong with its hashes, its signatures and its verdict.
fn of_folder(path: &Path) -> Result<BenchCheck, Note> {
    if !path.exists() {
        read::open(path).map_err(|e| e.note(path))?;
    }
    let folder = Folder::at(path)?;
    let file = folder.path.join(Kind::Result.record_file());
    let record = read::open(&file).map_err(|e| e.note(&file))?;
    let mut findings = hashes(&folder, SIGNATURES_FOLDER);
    findings.extend(signatures(&folder, Signing { signers: None, at: moment::now() }));
    findings.extend(verdict(&record));
    let fault = findings.iter().find(|f| f.differs()).map(|f| f.note().clone());
    let mut files = stated_hashes(&folder.path);
    files.extend(
        sha256_below(&folder.path, CHECKSUMS_FILE).ok().map(|hash| (CHECKSUMS_FILE.to_owned(), hash)),
    );
    Ok(BenchCheck { folder: folder.path.display().to_string(), address: address(&files), record, fault })
}
