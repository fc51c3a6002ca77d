//! The order of a proof.

use crate::config::proof::ProofFile;
use std::path::Path;

/// The order of a proof.
#[derive(Debug, Clone, Copy)]
pub struct ProofOrder<'a> {
    /// The proof file.
    pub proof: &'a ProofFile,
    /// Its path, as named.
    pub path: &'a str,
    /// Its SHA-256.
    pub sha256: &'a str,
    /// Folder of the recordings.
    pub data: &'a Path,
    /// The program that is the engine.
    pub program: &'a Path,
    /// When it is proved, RFC 3339.
    pub proved_at: &'a str,
}
