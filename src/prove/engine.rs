//! The engine in a process of its own: an empty folder, the files that are shown, and what it writes.

use super::confined;
use crate::i18n::{Note, note};
use crate::output::{Kind, sha256};
use crate::report::{ExplanationResults, Results, StoredResults};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Name of the claim among the files of a proof.
pub const CLAIM_FILE: &str = "model.toml";

/// Name of the recording as the engine sees it.
pub(super) const RECORDING_FILE: &str = "recording.csv";

/// Folder of the explanation.
const EXPLANATION_FOLDER: &str = "said";

/// An empty folder for the engine.
pub(super) struct Room {
    folder: TempDir,
    /// SHA-256 of the files that are shown, by their names.
    shown: BTreeMap<String, String>,
}

/// What the engine said.
pub(super) struct Said {
    /// The explanation.
    pub results: ExplanationResults,
    /// SHA-256 of its record.
    sha256: String,
}

impl Said {
    /// The hash of its record, by its name.
    pub fn hashes(&self) -> BTreeMap<String, String> {
        BTreeMap::from([(Kind::Explanation.record_file().to_owned(), self.sha256.clone())])
    }
}

impl Room {
    /// A new one.
    ///
    /// # Errors
    /// A note where no folder can be made.
    pub fn new() -> Result<Room, Note> {
        let folder = tempfile::tempdir().map_err(|_| note!("prove.error.no_room"))?;
        Ok(Room { folder, shown: BTreeMap::new() })
    }

    /// Writes a file that is shown.
    ///
    /// # Errors
    /// A note where it cannot be written.
    pub fn put(&mut self, name: &str, text: &str) -> Result<(), Note> {
        std::fs::write(self.at(name), text).map_err(|_| note!("prove.error.no_room"))?;
        self.shown.insert(name.to_owned(), sha256(text.as_bytes()));
        Ok(())
    }

    /// SHA-256 of the files that are shown, by their names.
    pub fn shown(&self) -> BTreeMap<String, String> {
        self.shown.clone()
    }

    fn at(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Takes a file away.
    ///
    /// # Errors
    /// A note where it cannot be removed.
    pub fn remove(&mut self, name: &str) -> Result<(), Note> {
        self.shown.remove(name);
        std::fs::remove_file(self.at(name)).map_err(|_| "prove.error.no_room".into())
    }

    /// Identifies the claim from `claim.csv`; gives the text of its model, and whether the process was confined.
    ///
    /// # Errors
    /// A note with what the engine said.
    pub fn identify(&self, program: &Path) -> Result<(String, bool), Note> {
        let kept = self.run(program, &["model", "claim.csv", "--out", CLAIM_FILE, "--quiet"])?;
        let text = std::fs::read_to_string(self.at(CLAIM_FILE));
        Ok((text.map_err(|_| note!("prove.error.no_room"))?, kept))
    }

    /// Explains `recording.csv`; gives what was said, and whether the process was confined.
    ///
    /// # Errors
    /// A note with what the engine said.
    pub fn explain(&self, program: &Path) -> Result<(Said, bool), Note> {
        let args = ["explain", RECORDING_FILE, "--model", CLAIM_FILE, "--out", EXPLANATION_FOLDER, "--quiet"];
        let kept = self.run(program, &args)?;
        let folder = self.at(EXPLANATION_FOLDER);
        let bytes = std::fs::read(folder.join(Kind::Explanation.record_file())).unwrap_or_default();
        match StoredResults::open(&folder)?.results {
            Results::Explanation(results) => Ok((Said { results: *results, sha256: sha256(&bytes) }, kept)),
            _ => Err("prove.error.no_room".into()),
        }
    }

    fn run(&self, program: &Path, args: &[&str]) -> Result<bool, Note> {
        let refused = |reason: String| note!("prove.error.engine", reason);
        let (output, kept) =
            confined::run(self.folder.path(), program, args).map_err(|e| refused(e.to_string()))?;
        // 0, 1 and 3 are verdicts.
        match output.status.code() {
            Some(0 | 1 | 3) => Ok(kept),
            _ => Err(refused(String::from_utf8_lossy(&output.stderr).trim().to_owned())),
        }
    }
}
