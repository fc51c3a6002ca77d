//! What stands beside the measured rows of a run: instruments, waivers, clauses, options.

use super::ConditionStatus;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// An instrument and its calibration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct InstrumentRecord {
    /// Name.
    pub name: String,
    /// Serial number.
    pub serial: Option<String>,
    /// Date until which its calibration holds, ISO 8601.
    pub calibration_due: Option<String>,
    /// State on the day of the test.
    pub status: ConditionStatus,
}

/// A waiver: who lets a row pass although it does not, why and when. Beside the verdict, never part of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WaiverRecord {
    /// Measurand or condition concerned.
    pub row: String,
    /// Who decided.
    pub by: String,
    /// Why.
    pub reason: String,
    /// When, ISO 8601 date.
    pub date: String,
}

/// A clause of the standard.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ClauseRecord {
    /// Clause, for example `12.11`.
    pub clause: String,
    /// Its title.
    pub title: String,
    /// `here`, `elsewhere`, `not_applicable`; `not_done` in place of `here` where the test could not be carried out,
    /// `partly` where not every phase of it could.
    pub status: String,
    /// Where or why.
    pub note: String,
}

/// An option that the analysis used.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OptionRecord {
    /// Name, dotted.
    pub name: String,
    /// Value as text with unit.
    pub value: String,
}
