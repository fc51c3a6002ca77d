//! Where everything stands in the folder of a store.
//!
//! ```text
//! store.json            what the folder is
//! results/ab/abcd.../   result folders by their address, in folders of their first two digits
//! statements/           corrections and moved recordings, each a file named by its hash
//! recordings/           copies of recordings, where they are kept
//! pending/              addresses of results that the index may lack yet
//! attempts/             numbers of attempts that are being made
//! index.sqlite          the index: made anew from the rest by `store rebuild`
//! lock                  held by who uses the index, and alone by who replaces it
//! turn.lock             held by who decides something that another must not decide meanwhile
//! ```

use super::error::{StoreError, io};
use crate::output::{STORE_MARKER, is_partial};
use std::fs;
use std::path::{Path, PathBuf};

/// Version of the format of a store.
pub const STORE_FORMAT: &str = "store/1";

/// The paths of a store.
#[derive(Debug, Clone)]
pub struct Layout {
    root: PathBuf,
}

impl Layout {
    /// The paths below a folder.
    pub fn at(root: &Path) -> Layout {
        Layout { root: root.to_owned() }
    }

    /// The folder of the store.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// The file that says what the folder is.
    pub fn marker(&self) -> PathBuf {
        self.root.join(STORE_MARKER)
    }

    /// All result folders.
    pub fn results(&self) -> PathBuf {
        self.root.join("results")
    }

    /// The folder of a result.
    pub fn result(&self, address: &str) -> PathBuf {
        self.results().join(address.get(..2).unwrap_or("00")).join(address)
    }

    /// All statements.
    pub fn statements(&self) -> PathBuf {
        self.root.join("statements")
    }

    /// All copies of recordings.
    pub fn recordings(&self) -> PathBuf {
        self.root.join("recordings")
    }

    /// The addresses that the index may lack.
    pub fn pending(&self) -> PathBuf {
        self.root.join("pending")
    }

    /// The numbers of attempts that are being made.
    pub fn attempts(&self) -> PathBuf {
        self.root.join("attempts")
    }

    /// The index.
    pub fn index(&self) -> PathBuf {
        self.root.join("index.sqlite")
    }

    /// Locked part of the store.
    pub fn lock(&self) -> PathBuf {
        self.root.join("lock")
    }

    /// What is locked by who decides something that another must not decide meanwhile.
    pub fn turn(&self) -> PathBuf {
        self.root.join("turn.lock")
    }

    /// The names of the copies of a recording, but for what killed processes left of others.
    ///
    /// # Errors
    /// [`StoreError::Io`] where the folder cannot be read.
    pub fn copies(&self, sha256: &str) -> Result<Vec<String>, StoreError> {
        let all = names(&self.recordings().join(sha256))?;
        Ok(all.into_iter().filter(|name| !is_partial(name)).collect())
    }

    /// The addresses of all result folders, in ascending order.
    ///
    /// # Errors
    /// [`StoreError::Io`] where a folder cannot be read.
    pub fn addresses(&self) -> Result<Vec<String>, StoreError> {
        let mut found = vec![];
        for group in names(&self.results())?.into_iter().filter(|n| n.len() == 2) {
            found.extend(names(&self.results().join(group))?.into_iter().filter(|n| is_address(n)));
        }
        found.sort();
        Ok(found)
    }
}

/// True for 64 hexadecimal digits in lower case.
pub fn is_address(name: &str) -> bool {
    name.len() == 64 && name.bytes().all(|b| b.is_ascii_digit() || (b'a'..=b'f').contains(&b))
}

/// The names in a folder; none where it is missing.
pub(super) fn names(folder: &Path) -> Result<Vec<String>, StoreError> {
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(vec![]),
        Err(e) => return Err(io("output_error.look_into", folder)(e)),
    };
    let mut names = vec![];
    for entry in entries {
        let entry = entry.map_err(io("output_error.look_into", folder))?;
        names.push(entry.file_name().to_string_lossy().into_owned());
    }
    names.sort();
    Ok(names)
}
