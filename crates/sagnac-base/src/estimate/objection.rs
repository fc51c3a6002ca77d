//! Contradictions of an estimate, found by checks.

use crate::message::Note;

/// What a contradicted estimate still tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Holds {
    /// Nothing: it neither passes nor fails.
    Nothing,
    /// That the quantity is not larger: it may pass and does not fail.
    UpperBound,
}

/// A contradiction between what was fitted to a record and that record.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Ids of the measurands that rest on what was contradicted.
    pub measurands: Vec<&'static str>,
    /// What their estimates still tell.
    pub holds: Holds,
    /// What was found, with its numbers.
    pub found: Note,
    /// What to do.
    pub advice: Note,
}

/// A finding of a check that shares no assumption with the fit. An estimate with an objection decides no more than what still
/// holds of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Objection {
    /// Id of the check; `criticism.<id>` is its name in the locale tables.
    pub check: &'static str,
    /// What it found.
    pub finding: Finding,
}
