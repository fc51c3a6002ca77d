//! Phases of a test of several.

use super::Message;
use super::{ConditionRecord, FigureRecord, Integrity, MeasurandRecord, ProcedureRecord, RecordingFile};
use crate::estimate::Verdict;
use crate::i18n::LocalText;
use serde::{Deserialize, Serialize};

/// One phase: what its own `result.json` says, in short.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PhaseRecord {
    /// Id.
    pub id: String,
    /// Title.
    #[serde(flatten, with = "super::local::title")]
    #[cfg_attr(feature = "schema", schemars(with = "super::local::title::Members<String>"))]
    pub title: LocalText,
    /// Folder with its own report and result, relative to this result; absent when it was not recorded.
    pub folder: Option<String>,
    /// Its procedure.
    pub procedure: Option<ProcedureRecord>,
    /// The files that were read.
    pub recording: Vec<RecordingFile>,
    /// Verdict of the phase.
    pub verdict: Verdict,
    /// Why.
    pub summary: Vec<Message>,
    /// Its conditions.
    pub conditions: Vec<ConditionRecord>,
    /// Faults of its recording.
    pub integrity: Integrity,
    /// Its measured quantities.
    pub measurands: Vec<MeasurandRecord>,
    /// Its figures.
    pub figures: Vec<FigureRecord>,
}
