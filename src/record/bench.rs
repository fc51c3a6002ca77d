//! The bench of a test: what a check of it released, or which check a test rests on.

use crate::estimate::Verdict;
use serde::{Deserialize, Serialize};

/// The bench of a test.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(!default))]
pub struct BenchRecord {
    /// Name or serial number, by the procedure or else the station of the run; `null` where neither states it.
    pub name: Option<String>,
    /// Of a check of the bench: for how long a pass releases it, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub releases_for_s: Option<f64>,
    /// Of a check that passed: until when the bench is released, RFC 3339, UTC.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub released_until: Option<String>,
    /// Of a test that demands a released bench: longest time from the end of the check to the beginning of the recording, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub released_within_s: Option<f64>,
    /// The check that decided whether the bench was released, where one was found.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub check: Option<BenchCheckRecord>,
}

/// A check of a bench that a test rests on.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(!default))]
pub struct BenchCheckRecord {
    /// Folder of its result.
    pub folder: String,
    /// Address of the folder: SHA-256 of the list of its files.
    pub address: String,
    /// SHA-256 of its procedure.
    pub procedure_sha256: String,
    /// Its verdict.
    pub verdict: Verdict,
    /// When it ended, RFC 3339, UTC.
    pub ended_at: Option<String>,
    /// True where its recording declares the date, false where it is the time of its evaluation.
    pub is_dated: bool,
}
