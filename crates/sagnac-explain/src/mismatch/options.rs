//! Decisions of a user about an explanation, and the progress of the work.

use crate::effect::Column;

/// Decisions of the user.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Probability at which a correct claim is called a mismatch.
    pub alpha: f64,
    /// Columns that are treated as if they had not been recorded.
    pub hide: Vec<Column>,
    /// Most effects that are added to the claim.
    pub max_effects: usize,
    /// Kinds of effects that are excluded from the search.
    pub without: Vec<&'static str>,
}

impl Options {
    /// True for an effect that the search considers.
    pub fn allows(&self, kind: &str) -> bool {
        !self.without.contains(&kind)
    }
}

impl Default for Options {
    fn default() -> Options {
        Options { alpha: 0.01, hide: vec![], max_effects: 3, without: vec![] }
    }
}

/// Progress of the work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Name of the step: a key of the locale tables.
    pub doing: &'static str,
    /// Steps of it that are done.
    pub done: u64,
    /// Steps of it in all.
    pub total: u64,
}
