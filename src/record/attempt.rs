//! Which test of a unit a result is, where its store knows of earlier ones.

use super::Message;
use crate::estimate::Verdict;
use serde::{Deserialize, Serialize};

/// Which test of the unit by the procedure this is, as the store knew when it was made.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(!default))]
pub struct AttemptRecord {
    /// Number of the attempt, from 1.
    pub number: u64,
    /// The earlier attempts, the first one first.
    pub earlier: Vec<EarlierAttempt>,
    /// What must be known of them, in sentences; empty for a first attempt.
    pub summary: Vec<Message>,
}

/// An earlier test of the unit by the procedure.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(!default))]
pub struct EarlierAttempt {
    /// Number of the attempt.
    pub number: u64,
    /// Address of its result in the store.
    pub result: String,
    /// When it was evaluated, RFC 3339.
    pub evaluated_at: String,
    /// Its verdict.
    pub verdict: Verdict,
    /// Ids of what it failed on: measurands, conditions, kinds of faults.
    pub reasons: Vec<String>,
    /// Revision of its procedure.
    pub revision: String,
    /// SHA-256 of its limits; empty without.
    pub limits_sha256: String,
    /// True when another result counts in its place.
    pub superseded: bool,
}
