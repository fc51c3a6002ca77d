//! A unit beside the other units of its lot, where its store has enough of them.

use super::Message;
use serde::{Deserialize, Serialize};

/// How unlike the other units of its lot a unit is, as the store knew them when the result was made. It is no part of the verdict.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SiblingsRecord {
    /// Model of the units.
    pub model: String,
    /// Their lot.
    pub lot: String,
    /// Other units of the lot that it is held against.
    pub units: usize,
    /// What they are compared in.
    pub quantities: Vec<SiblingQuantity>,
    /// Probability that a unit of the population of the others is as far from them.
    pub p_value: f64,
    /// Rate of false alarms: the probability below which a unit is called unlike the others.
    pub false_alarm_rate: f64,
    /// Whether it is called unlike the others.
    pub unlike: bool,
    /// What must be known, in sentences; empty for a unit that is like the others.
    pub summary: Vec<Message>,
}

/// A quantity that a unit is compared in.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SiblingQuantity {
    /// Measurand, or `allan_deviation`.
    pub id: String,
    /// Channel.
    pub channel: String,
    /// Averaging time of an Allan deviation, s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tau_s: Option<f64>,
    /// Deviation from the middle of the other units, in their standard deviations.
    pub deviation: f64,
}
