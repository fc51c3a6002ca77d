//! Everything in a store read anew and set against everything else: folders against their addresses, statements against their names, copies
//! of recordings against their hashes, the index against all of these by content, and each record against the attempts that it names.

use super::address::address;
use super::error::StoreError;
use super::finding::{Finding, Part};
use super::folders::{index_in_memory, statements};
use super::index::{Attempt, Index, StatementRow};
use super::layout::{Layout, is_address, names};
use super::opened::{Store, leads_to};
use crate::output::{Found, NotRead, SIGNATURES_FOLDER, found_below, is_partial, sha256_below};
use crate::signing;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Counts of what was examined.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Verified {
    /// Results.
    pub results: usize,
    /// Statements.
    pub statements: usize,
    /// Faults found.
    pub findings: Vec<Finding>,
}

/// Reads everything that a store holds and names what does not fit.
///
/// # Errors
/// [`StoreError`] where the index or a folder cannot be read at all.
pub fn verify(store: &Store) -> Result<Verified, StoreError> {
    let layout = &store.layout;
    store.index.check()?;
    let mut findings = vec![];
    let statements = statements(layout, &mut findings)?.len();
    let there = layout.addresses()?;
    for expected in &there {
        findings.extend(of_folder(&layout.result(expected), expected));
    }
    findings.extend(strays(layout)?);
    findings.extend(recordings(layout)?);
    let fresh = index_in_memory(layout)?;
    findings.extend(index_against(&store.index, &fresh, &there)?);
    findings.extend(chains(&fresh, &there)?);
    findings.extend(circles(&fresh)?);
    Ok(Verified { results: there.len(), statements, findings })
}

/// The files of a result against its address. Its signatures stand beside what they sign.
fn of_folder(folder: &Path, expected: &str) -> Vec<Finding> {
    let unreadable = |why: String| vec![Finding::Unreadable { path: folder.to_owned(), why }];
    let found = match found_below(folder) {
        Ok(found) => found,
        Err(e) => return unreadable(e.to_string()),
    };
    let mut findings = vec![];
    let mut hashes = BTreeMap::new();
    let signatures = format!("{SIGNATURES_FOLDER}/");
    for (name, kind) in found.into_iter().filter(|(name, _)| !name.starts_with(&signatures)) {
        match (kind, sha256_below(folder, &name)) {
            (Found::File, Ok(hash)) => {
                hashes.insert(name, hash);
            }
            (Found::File, Err(NotRead::Io(e))) => return unreadable(e.to_string()),
            _ => findings.push(Finding::Stray(folder.join(name))),
        }
    }
    let found = address(&hashes);
    if found != expected {
        findings.push(Finding::Changed { path: folder.to_owned(), found });
    }
    let files = signing::files_of(folder, hashes.into_keys());
    let broken = signing::chain(folder, &files).into_iter().filter(|link| !link.broken.is_empty());
    findings.extend(broken.map(|l| Finding::Signature { path: folder.to_owned(), name: l.name }));
    findings.extend(signing::strays(folder).into_iter().map(|name| Finding::Stray(folder.join(name))));
    findings
}

/// Files in the folders of a store that are none of its own.
fn strays(layout: &Layout) -> Result<Vec<Finding>, StoreError> {
    let mut strays: Vec<PathBuf> = vec![];
    let mut look = |folder: &Path, is_own: &dyn Fn(&str) -> bool| -> Result<(), StoreError> {
        let others = names(folder)?.into_iter().filter(|name| !is_own(name) && !is_partial(name));
        strays.extend(others.map(|name| folder.join(name)));
        Ok(())
    };
    let is_group = |name: &str| name.len() == 2;
    look(&layout.results(), &is_group)?;
    for group in names(&layout.results())?.iter().filter(|name| is_group(name)) {
        let of_group = |name: &str| is_address(name) && name.starts_with(group.as_str());
        look(&layout.results().join(group), &of_group)?;
    }
    look(&layout.statements(), &|name| name.strip_suffix(".json").is_some_and(is_address))?;
    look(&layout.recordings(), &is_address)?;
    Ok(strays.into_iter().map(Finding::Stray).collect())
}

/// Copies of recordings that are not those that were evaluated.
fn recordings(layout: &Layout) -> Result<Vec<Finding>, StoreError> {
    let mut findings = vec![];
    for hash in names(&layout.recordings())?.into_iter().filter(|name| is_address(name)) {
        let folder = layout.recordings().join(&hash);
        for name in layout.copies(&hash)? {
            if sha256_below(&folder, &name).ok().as_ref() != Some(&hash) {
                findings.push(Finding::Recording(folder.join(name)));
            }
        }
    }
    Ok(findings)
}

/// The index against one that was made anew from the folders.
fn index_against(index: &Index, fresh: &Index, there: &[String]) -> Result<Vec<Finding>, StoreError> {
    let mut findings = vec![];
    if index.definitions()? != fresh.definitions()? {
        findings.push(Finding::Tables);
    }
    let (stored_keys, made_keys) = (index.keys()?, fresh.keys()?);
    for address in there {
        match (index.at(address)?, fresh.at(address)?) {
            (Some(stored), Some(made)) => {
                let mut parts = differing(&stored, &made);
                if stored_keys.get(address) != made_keys.get(address) && !parts.contains(&Part::Place) {
                    parts.push(Part::Place);
                }
                if !parts.is_empty() {
                    findings.push(Finding::IndexDiffers { address: address.clone(), parts });
                }
            }
            (None, Some(_)) => findings.push(Finding::NotIndexed(address.clone())),
            (Some(_), None) => findings.push(Finding::NoFolder(address.clone())),
            // An unreadable folder was named where it was examined.
            (None, None) => {}
        }
    }
    let there: BTreeSet<&String> = there.iter().collect();
    findings.extend(stored_keys.keys().filter(|a| !there.contains(a)).cloned().map(Finding::NoFolder));
    let (stored, made) = (index.statements()?, fresh.statements()?);
    let differs = |of: &[StatementRow], other: &[StatementRow], finding: fn(String) -> Finding| {
        let lacking = of.iter().filter(|row| !other.contains(row));
        lacking.map(|(hash, _)| finding(hash.clone())).collect::<Vec<_>>()
    };
    findings.extend(differs(&stored, &made, Finding::NoStatement));
    findings.extend(differs(&made, &stored, Finding::StatementNotIndexed));
    Ok(findings)
}

/// The parts of a result in which an index differs from its folder.
fn differing(stored: &Attempt, made: &Attempt) -> Vec<Part> {
    let (a, b) = (&stored.entry, &made.entry);
    [
        (Part::Unit, a.unit == b.unit),
        (Part::Test, a.test == b.test && a.result_sha256 == b.result_sha256),
        (Part::Verdict, a.verdict == b.verdict && a.reasons == b.reasons),
        (Part::Values, a.measurands == b.measurands),
        (Part::Recordings, a.recordings == b.recordings),
        (Part::Place, stored.number == made.number && stored.missing == made.missing),
        (Part::Correction, stored.superseded == made.superseded),
    ]
    .into_iter()
    .filter_map(|(part, same)| (!same).then_some(part))
    .collect()
}

/// Attempts that a record names as earlier ones, and that the store does not hold: removed, or never brought here.
fn chains(fresh: &Index, there: &[String]) -> Result<Vec<Finding>, StoreError> {
    let mut findings = vec![];
    for address in there {
        let missing = fresh.at(address)?.map(|attempt| attempt.missing).unwrap_or_default();
        findings.extend(
            missing.into_iter().map(|missing| Finding::NoAttempt { address: address.clone(), missing }),
        );
    }
    Ok(findings)
}

/// Corrections that lead round in a circle, so that none of its results counts, and those of results that the store does not
/// hold.
fn circles(fresh: &Index) -> Result<Vec<Finding>, StoreError> {
    let corrections = fresh.corrections()?;
    let mut findings = vec![];
    for (superseded, by) in &corrections {
        if leads_to(&corrections, by, superseded) {
            findings.push(Finding::Circle(superseded.clone()));
        }
        for address in [superseded, by] {
            if fresh.at(address)?.is_none() {
                findings.push(Finding::CorrectsNothing(address.clone()));
            }
        }
    }
    Ok(findings)
}
