//! Results of studies as files: one JSON file a study, whose cases are kept as they finish.

use crate::study::{Row, Study};
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::process::Command;
use std::{fs, io};

/// What one build gave in one study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Results {
    /// Id of the study.
    pub study: String,
    /// Last commit that changed the code; with `+` where the code had changes that no commit holds.
    pub commit: String,
    /// Command that gives the same numbers again.
    pub command: String,
    /// Records of each case.
    pub records: u64,
    /// First seed.
    pub seed: u64,
    /// Finished cases.
    pub cases: Vec<CaseResult>,
}

/// Rows of a finished case.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CaseResult {
    /// Name of the case.
    pub name: String,
    /// Time that it took, in s; absent where it was not kept.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub elapsed_s: Option<f64>,
    /// Its rows.
    pub rows: Vec<Row>,
}

impl Results {
    /// No case yet.
    pub fn new(study: &Study, commit: &str, records: u64, seed: u64) -> Results {
        Results {
            study: study.id.to_owned(),
            commit: commit.to_owned(),
            command: format!("cargo xtask validate {} --records {records} --seed {seed}", study.id),
            records,
            seed,
            cases: vec![],
        }
    }

    /// Reads a file; absent where there is none.
    ///
    /// # Errors
    /// If the file cannot be read, or holds no results.
    pub fn read(path: &Path) -> io::Result<Option<Results>> {
        match fs::read_to_string(path) {
            Ok(text) => Ok(Some(serde_json::from_str(&text)?)),
            Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(e) => Err(e),
        }
    }

    /// Writes the file, whole or not at all.
    ///
    /// # Errors
    /// If the folder or the file cannot be written.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder)?;
        }
        let partial = path.with_extension("json.part");
        fs::write(&partial, serde_json::to_string_pretty(self)? + "\n")?;
        fs::rename(partial, path)
    }
}

/// Last commit that changed the code that studies measure; commits of documents and results do not count. Ends in `+` where
/// the code has changes that no commit holds.
///
/// # Errors
/// If git cannot be run in `root`.
pub fn code_commit(root: &Path) -> io::Result<String> {
    const CODE: [&str; 6] = ["src", "crates", "studies", "locale", "Cargo.toml", "Cargo.lock"];
    let git = |arguments: &[&str]| -> io::Result<String> {
        let there = CODE.iter().filter(|path| root.join(path).exists());
        let done = Command::new("git").current_dir(root).args(arguments).arg("--").args(there).output()?;
        if !done.status.success() {
            return Err(io::Error::other(String::from_utf8_lossy(&done.stderr).into_owned()));
        }
        Ok(String::from_utf8_lossy(&done.stdout).trim().to_owned())
    };
    let commit = git(&["log", "-1", "--format=%h"])?;
    let changed = !git(&["status", "--porcelain"])?.is_empty();
    Ok(if changed { commit + "+" } else { commit })
}
