//! Nothing is written into a store but by the store: a result or a table that replaced one of its files would be lost to it.

use super::error::OutputError;
use super::{parent, starts_with_format};
use crate::i18n::note;
use std::path::{Component, Path, PathBuf};

/// The file that says that a folder is a store.
pub const STORE_MARKER: &str = "store.json";

/// How that file begins, without spaces.
const MARKER_START: &str = "{\"format\":\"store/";

/// Refuses a place inside a store, also one that is reached through links.
///
/// # Errors
/// [`OutputError::InTheWay`].
pub fn outside_stores(target: &Path) -> Result<(), OutputError> {
    let place = resolved(parent(target));
    match place.ancestors().find(|folder| starts_with_format(&folder.join(STORE_MARKER), MARKER_START)) {
        Some(store) => Err(OutputError::InTheWay {
            path: target.to_owned(),
            why: note!("output_error.why.store", store = store.display().to_string()),
        }),
        None => Ok(()),
    }
}

/// Where a folder is or will be: links are followed as far as it is there, and `..` leads back out of what is still to be made.
fn resolved(folder: &Path) -> PathBuf {
    let mut at = std::env::current_dir().unwrap_or_default();
    for part in folder.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => {
                at.pop();
            }
            Component::Prefix(_) | Component::RootDir | Component::Normal(_) => {
                at.push(part);
                at = at.canonicalize().unwrap_or(at);
            }
        }
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_in_a_store_is_refused_however_it_is_named() {
        let dir = tempfile::tempdir().unwrap();
        let store = dir.path().join("store");
        std::fs::create_dir_all(store.join("results")).unwrap();
        let round = dir.path().join("new/../store/x/y");
        let inside = [store.join("x"), store.join("results/new/x"), store.join("index.sqlite"), round];
        for place in &inside {
            outside_stores(place).unwrap();
        }
        std::fs::write(store.join(STORE_MARKER), "{\n  \"format\": \"store/1\"\n}").unwrap();
        for place in &inside {
            assert!(outside_stores(place).is_err(), "{}", place.display());
        }
        outside_stores(&dir.path().join("beside/x")).unwrap();
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(store.join("results"), dir.path().join("link")).unwrap();
            assert!(outside_stores(&dir.path().join("link/x")).is_err());
        }
    }
}
