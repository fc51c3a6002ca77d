//! What stands beside the measured rows of a run: instruments, waivers, clauses, options.

use super::ConditionStatus;
use crate::estimate::InputQuantity;
use crate::i18n::LocalText;
use serde::{Deserialize, Serialize};

/// An instrument and its calibration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct InstrumentRecord {
    /// Name.
    #[serde(flatten, with = "super::local::name")]
    #[cfg_attr(feature = "schema", schemars(with = "super::local::name::Members<String>"))]
    pub name: LocalText,
    /// Serial number.
    pub serial: Option<String>,
    /// Number of its calibration certificate.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub certificate: Option<String>,
    /// Date of the calibration, ISO 8601.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub calibrated: Option<String>,
    /// Component of uncertainty that its certificate states.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub component: Option<InputQuantity>,
    /// Date until which its calibration holds, ISO 8601.
    pub calibration_due: Option<String>,
    /// State on the day of the test.
    pub status: ConditionStatus,
}

/// A waiver: who lets a row pass although it does not, why and when. Beside the verdict, never part of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct WaiverRecord {
    /// Measurand or condition concerned.
    pub row: String,
    /// Who decided.
    #[serde(flatten, with = "super::local::by")]
    #[cfg_attr(feature = "schema", schemars(with = "super::local::by::Members<String>"))]
    pub by: LocalText,
    /// Why.
    #[serde(flatten, with = "super::local::reason")]
    #[cfg_attr(feature = "schema", schemars(with = "super::local::reason::Members<String>"))]
    pub reason: LocalText,
    /// When, ISO 8601 date.
    pub date: String,
}

/// A span that the procedure excludes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ExclusionRecord {
    /// Start, s from the start of the recording.
    pub from_s: f64,
    /// End, s from the start of the recording.
    pub to_s: f64,
    /// Why.
    #[serde(flatten, with = "super::local::reason")]
    #[cfg_attr(feature = "schema", schemars(with = "super::local::reason::Members<String>"))]
    pub reason: LocalText,
}

/// A clause of the standard.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ClauseRecord {
    /// Clause, for example `12.11`.
    #[serde(flatten, with = "super::local::clause")]
    #[cfg_attr(feature = "schema", schemars(with = "super::local::clause::Members<String>"))]
    pub clause: LocalText,
    /// Its title.
    #[serde(flatten, with = "super::local::title")]
    #[cfg_attr(feature = "schema", schemars(with = "super::local::title::Members<String>"))]
    pub title: LocalText,
    /// `here`, `elsewhere`, `not_applicable`; `not_done` in place of `here` where the test could not be carried out,
    /// `partly` where not every phase of it could.
    pub status: String,
    /// Where or why.
    #[serde(flatten, with = "super::local::note")]
    #[cfg_attr(feature = "schema", schemars(with = "super::local::note::Members<String>"))]
    pub note: LocalText,
    /// Ids of the measurands that deal with it, in a test of several phases.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rows: Vec<String>,
}

impl ClauseRecord {
    /// True where the test that states it deals with it.
    pub fn is_here(&self) -> bool {
        self.status == "here"
    }
}

/// An option that the analysis used.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct OptionRecord {
    /// Name, dotted.
    pub name: String,
    /// Value as text with unit.
    pub value: String,
}
