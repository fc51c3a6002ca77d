//! Results and statements in the folders of a store, which is all that the index has.

use super::entry::Entry;
use super::error::StoreError;
use super::finding::Finding;
use super::index::Index;
use super::layout::Layout;
use super::statement::{self, Statement};
use crate::output::Kind;
use crate::record::read;

/// Entry of the result at an address.
pub(super) fn entry_at(layout: &Layout, address: &str) -> Result<Entry, StoreError> {
    let path = layout.result(address).join(Kind::Result.record_file());
    let bytes = read::bytes(&path).map_err(|source| StoreError::Result { path: path.clone(), source })?;
    Entry::of_json(&bytes, &path)
}

/// The index of a store whose disk cannot be written.
///
/// # Errors
/// [`StoreError`] where a folder cannot be read.
pub(super) fn index_in_memory(layout: &Layout) -> Result<Index, StoreError> {
    let mut index = Index::in_memory(&layout.index())?;
    fill(&mut index, layout)?;
    Ok(index)
}

/// Results put into an index.
pub(super) struct Filled {
    /// Results.
    pub results: usize,
    /// Statements.
    pub statements: usize,
    /// Results left out.
    pub findings: Vec<Finding>,
}

/// Puts everything that the folders and statements tell into an empty index.
pub(super) fn fill(index: &mut Index, layout: &Layout) -> Result<Filled, StoreError> {
    let mut findings = vec![];
    let statements = statements(layout, &mut findings)?;
    let addresses = layout.addresses()?;
    let mut unreadable = vec![];
    let results = addresses.iter().filter_map(|address| match entry_at(layout, address) {
        Ok(entry) => Some(Ok::<(String, Entry), StoreError>((address.clone(), entry))),
        Err(why) => {
            unreadable.push(Finding::Unreadable { path: layout.result(address), why: why.to_string() });
            None
        }
    });
    let count = index.fill(results, &statements)?;
    findings.extend(unreadable);
    Ok(Filled { results: count, statements: statements.len(), findings })
}

/// The statements that are what they were; the others are findings.
pub(super) fn statements(
    layout: &Layout,
    findings: &mut Vec<Finding>,
) -> Result<Vec<(String, Statement)>, StoreError> {
    let mut sound = vec![];
    for stored in statement::all(layout)? {
        match stored.statement {
            Some(statement) if stored.hash == stored.found => sound.push((stored.hash, statement)),
            _ => findings.push(Finding::Statement(stored.path)),
        }
    }
    Ok(sound)
}
