//! The index made anew.

use super::database::{database_files, remove_database};
use super::error::{StoreError, io};
use super::finding::Finding;
use super::folders::{Filled, fill};
use super::index::{Age, Index};
use super::layout::Layout;
use super::lock::{self, Sharing};
use super::marker::marker;
use crate::i18n::Note;
use crate::output::sync_folder;
use std::fs;
use std::path::Path;

/// Sources of an index.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rebuilt {
    /// Results.
    pub results: usize,
    /// Statements.
    pub statements: usize,
    /// Results left out.
    pub findings: Vec<Finding>,
}

/// Makes the index of a store anew from its folders and statements. The earlier one stays until the new one is whole.
///
/// # Errors
/// [`StoreError`] where the store is in use for too long, or the disk refuses.
pub fn rebuild(path: &Path) -> Result<Rebuilt, StoreError> {
    let layout = Layout::at(path);
    let shared_disk = marker(&layout)?.shared_disk || lock::is_shared_disk(path);
    let _lock = lock::take(&layout.lock(), Sharing::Alone)?;
    let Filled { results, statements, findings } = make_anew(&layout, shared_disk)?;
    Ok(Rebuilt { results, statements, findings })
}

/// Makes an index anew that is missing or of an earlier version, for who has the store alone; says so. Another may have done it
/// meanwhile.
pub(super) fn make_current(layout: &Layout, shared_disk: bool) -> Result<Option<Note>, StoreError> {
    let key = match Index::open(&layout.index(), shared_disk) {
        Ok(index) => match index.age()? {
            Age::Current => return Ok(None),
            Age::Earlier(found) => {
                index.back_up(found)?;
                "store.index_of_earlier"
            }
        },
        Err(StoreError::NoIndex(_)) => "store.index_missing",
        Err(e) => return Err(e),
    };
    let filled = make_anew(layout, shared_disk)?;
    Ok(Some(Note::new(key).with("path", layout.root().display().to_string()).with("n", filled.results)))
}

/// Makes the index anew, for who has the store alone.
fn make_anew(layout: &Layout, shared_disk: bool) -> Result<Filled, StoreError> {
    let (new, place) = (layout.index().with_extension("sqlite.new"), layout.index());
    remove_database(&new)?;
    let mut index = Index::create(&new, shared_disk)?;
    let filled = fill(&mut index, layout)?;
    index.close()?;
    // What the earlier index left in its log must not be taken for that of the new one. The earlier one stays whole until the new
    // one is in its place; one that is damaged goes before, since a missing index is made anew by whoever opens the store next.
    let settled = Index::open(&place, shared_disk).and_then(Index::settle);
    let has_log = database_files(&place).iter().skip(1).any(|file| file.exists());
    if settled.is_err() || has_log {
        remove_database(&place)?;
    }
    fs::rename(&new, &place).map_err(io("output_error.put_in_place", &place))?;
    sync_folder(layout.root())?;
    Ok(filled)
}
