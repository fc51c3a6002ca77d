//! Steps of a test on a rate table.

use serde::{Deserialize, Serialize};

/// One step of one channel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TableStepRecord {
    /// Channel.
    pub channel: String,
    /// Start of what was evaluated, s from the start of the recording.
    pub from_s: f64,
    /// Its end.
    pub to_s: f64,
    /// First row of the recording that was evaluated, counted from 1.
    pub row: u64,
    /// Rate of the table, deg/h, the Earth's rotation not counted.
    pub rate_deg_h: f64,
    /// Turns.
    pub turns: f64,
    /// Mean temperature, degC.
    pub temperature_deg_c: Option<f64>,
    /// Whether the rate was reached from below (1) or from above (-1); 0 where nothing came before.
    pub approach: i8,
    /// Cycle, counted from 1.
    pub cycle: usize,
    /// Mean output, deg/h.
    pub output_deg_h: f64,
    /// Output about the line, deg/h.
    pub residual_deg_h: f64,
    /// Its standard uncertainty, deg/h.
    pub standard_uncertainty_deg_h: f64,
    /// The residual in ppm of full scale.
    pub residual_ppm: f64,
}
