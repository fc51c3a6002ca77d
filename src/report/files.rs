//! What the record files of a plan and of recordings that are explained together hold: what was found, and what their
//! pages show besides.

use crate::i18n::Note;
use crate::mismatch::joint::record::JointExplanation;
use crate::plan::Plan;
use serde::{Deserialize, Serialize};

/// What `plan.json` holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlanFile {
    /// The plan.
    #[serde(flatten)]
    pub plan: Plan,
    /// What its page shows besides.
    #[serde(default)]
    pub context: PlanContext,
}

/// Where a plan comes from.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct PlanContext {
    /// The explanation or the recording, as named by the user.
    pub explained: String,
    /// The model, as named by the user.
    pub model: String,
    /// RFC 3339.
    pub planned_at: String,
    /// What must be known of the plan.
    #[serde(with = "crate::record::message::notes")]
    pub notes: Vec<Note>,
}

/// What `joint.json` holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JointFile {
    /// The findings.
    #[serde(flatten)]
    pub explanation: JointExplanation,
    /// What its page shows besides.
    #[serde(default)]
    pub context: JointContext,
}

/// Where a joint explanation comes from.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct JointContext {
    /// The claim, as named by the user.
    pub claim: String,
    /// RFC 3339.
    pub explained_at: String,
    /// What must be known of the recordings.
    #[serde(with = "crate::record::message::notes")]
    pub notes: Vec<Note>,
}
