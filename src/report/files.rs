//! Contents of the record files of explanations and of plans: findings, and facts that their pages show besides.

use crate::i18n::{LocalText, Note};
use crate::mismatch::joint::record::JointExplanation;
use crate::plan::Plan;
use crate::record::explanation::Explanation;
use serde::{Deserialize, Serialize};

/// Contents of `explain.json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExplainFile {
    /// The explanation.
    #[serde(flatten)]
    pub explanation: Explanation,
    /// Facts that its page shows besides.
    pub context: Context,
}

/// Where an explanation comes from and goes to.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Context {
    /// The recording, as named by the user.
    pub recording: String,
    /// The claim, as named by the user.
    pub claim: String,
    /// True when the claim was identified from a simulated recording.
    pub identified: bool,
    /// Description that the claim gives of itself.
    #[serde(flatten, with = "crate::record::local::description")]
    pub description: Option<LocalText>,
    /// RFC 3339.
    pub explained_at: String,
    /// True when `correction.csv` is written.
    pub correction: bool,
    /// Remarks on the recording.
    #[serde(with = "crate::record::message::notes")]
    pub notes: Vec<Note>,
}

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
