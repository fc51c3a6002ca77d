//! The result of several recordings together, as `joint.json` has it.

use crate::mismatch::finding::{MismatchVerdict, ParameterValue};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Format of `joint.json`.
pub const JOINT_FORMAT: &str = "explain-joint/1";

/// Several recordings against one claim.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JointExplanation {
    /// [`JOINT_FORMAT`]
    pub format: String,
    /// The case that the claim names.
    pub case: String,
    /// What it comes to over all recordings.
    pub verdict: MismatchVerdict,
    /// Probability of calling a correct claim a mismatch, over all recordings together.
    pub alpha: f64,
    /// Effects that the recordings share with the same parameters, the one that explains most first.
    pub shared: Vec<SharedEffect>,
    /// Effects that the recordings show with parameters of their own, so that one law does not hold for all.
    pub unlike: Vec<SharedEffect>,
    /// The recordings, in the order in which they were given.
    pub recordings: Vec<JointRecording>,
}

/// An effect, fitted to all recordings with one set of parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SharedEffect {
    /// Kind of the contract, or `unknown` for an effect that the format has no kind for.
    pub kind: String,
    /// Effect of the catalogue, where its id is not the kind.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effect: Option<String>,
    /// Recorded column that it follows, for a kind that any column can drive.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub column: Option<String>,
    /// Parameters by name.
    pub parameters: BTreeMap<String, ParameterValue>,
    /// Gain of log-likelihood over all recordings, nats.
    pub gain: f64,
    /// BIC without it less BIC with it, over all rows.
    pub delta_bic: f64,
    /// Probability of such a gain without it, everything that was looked at counted.
    pub p_value: f64,
    /// Probability of coefficients that differ so much between the recordings while the true ones are equal.
    pub agreement_p_value: f64,
    /// Gain in each recording of the law fitted to the others, summed, nats.
    pub predicted_gain: f64,
    /// Each recording that has what it needs.
    pub of: Vec<SharedIn>,
}

/// A shared effect in one recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SharedIn {
    /// The recording, by its place among `recordings`, counted from 1.
    pub recording: usize,
    /// Gain of log-likelihood by the shared law, nats.
    pub gain: f64,
    /// Gain by the law as the other recordings alone have it, nats.
    pub predicted_gain: f64,
    /// The coefficient as this recording alone has it, for a law of one coefficient.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub alone: Option<ParameterValue>,
}

/// A recording, alone and with the others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JointRecording {
    /// Its name.
    pub name: String,
    /// Folder of its own explanation beside the claim with the shared effects.
    pub folder: String,
    /// What it says without the others.
    pub alone: Brief,
    /// What it says beside the claim with the shared effects.
    pub together: Brief,
}

/// An explanation in short.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Brief {
    /// Its verdict.
    pub verdict: MismatchVerdict,
    /// Ids of its effects, the principal one first.
    pub effects: Vec<String>,
    /// Probability of so large a mismatch under a correct claim.
    pub p_value: f64,
}
