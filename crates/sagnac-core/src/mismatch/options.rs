//! What a user decides about an explanation, and how far the work is.

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
    /// Effects that are not thought of, by their kinds.
    pub without: Vec<&'static str>,
}

impl Options {
    /// Whether an effect is thought of.
    pub fn allows(&self, kind: &str) -> bool {
        !self.without.contains(&kind)
    }
}

impl Default for Options {
    fn default() -> Options {
        Options { alpha: 0.01, hide: vec![], max_effects: 3, without: vec![] }
    }
}

/// How far the work is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// What is being done: a key of the locale tables.
    pub doing: &'static str,
    /// Steps of it that are done.
    pub done: u64,
    /// Steps of it in all.
    pub total: u64,
}
