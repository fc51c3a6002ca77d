//! The id of a test, by which it is made once: contents of recording, procedure and limits, and the version of the program.

use crate::config::shipped;
use crate::output::{UNREAD_HASH, sha256, sha256_of_file, sha256_of_several};
use crate::record::RunRecord;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Version of the program.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// What a recording is tested by, by the hashes of its contents.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TestedBy {
    procedure: String,
    limits: Option<String>,
}

impl TestedBy {
    /// The contents of a procedure and its limits as they are now.
    pub fn now(procedure: &Path, limits: Option<&Path>) -> TestedBy {
        TestedBy {
            procedure: hash_of(&[procedure.to_owned()]),
            limits: limits.map(|l| hash_of(&[l.to_owned()])),
        }
    }

    /// Both and the version of the program, as one hash.
    pub fn digest(&self) -> String {
        sha256([&self.procedure, self.limits.as_deref().unwrap_or_default(), VERSION].join("\n").as_bytes())
    }

    /// The id of the test of a recording of this hash.
    pub fn test_of(&self, recording: &str) -> String {
        sha256([recording, &self.digest()].join("\n").as_bytes())
    }

    /// True where a result states these inputs and this program.
    pub fn made(&self, record: &RunRecord, inputs: &Value, recording: &str) -> bool {
        let states = |name: &str, hash: Option<&str>| inputs.get(name).and_then(Value::as_str) == hash;
        record.program.version == VERSION
            && states("recording", Some(recording))
            && states("procedure", Some(&self.procedure))
            && states("limits", self.limits.as_deref())
    }
}

/// The hash of files in their order, as results state their inputs.
pub fn hash_of(files: &[PathBuf]) -> String {
    let shipped = |path: &Path| shipped::find(path).map(|s| sha256(s.text.as_bytes()));
    sha256_of_several(files.iter().map(|path| {
        let hash = sha256_of_file(path).or_else(|| shipped(path));
        hash.unwrap_or_else(|| UNREAD_HASH.to_owned())
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_input_changes_the_id() {
        let folder = tempfile::tempdir().unwrap();
        let limits = folder.path().join("l.toml");
        std::fs::write(&limits, "a").unwrap();
        let by = TestedBy::now(Path::new("static-bias"), None);
        let id = by.test_of("1");
        assert_eq!(id, TestedBy::now(Path::new("static-bias"), None).test_of("1"));
        let with_limits = TestedBy::now(Path::new("static-bias"), Some(&limits));
        std::fs::write(&limits, "b").unwrap();
        let other_limits = TestedBy::now(Path::new("static-bias"), Some(&limits));
        let others = [by.test_of("2"), with_limits.test_of("1"), other_limits.test_of("1")];
        let ids: std::collections::BTreeSet<String> = others.into_iter().chain([id]).collect();
        assert_eq!(ids.len(), 4);
    }
}
