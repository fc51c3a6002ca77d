//! Means of runs, or of intervals without and with an influence.

use super::Evidence;
use serde::{Deserialize, Serialize};

/// One run or interval of one channel.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct IntervalMeanRecord {
    /// Channel.
    pub channel: String,
    /// Number, counted from 1.
    pub number: usize,
    /// Phase or file, where that tells it.
    pub name: String,
    /// Start of what was evaluated, s from the start of the recording.
    pub from_s: f64,
    /// Its end.
    pub to_s: f64,
    /// First row.
    pub row: u64,
    /// Level of the influence, in `level_unit`; absent for a run.
    pub level: Option<f64>,
    /// How it is known that the influence was at this level; absent for a run.
    pub evidence: Option<Evidence>,
    /// Unit of the level.
    pub level_unit: Option<String>,
    /// Axis that the influence acts along, where there are several.
    pub axis: Option<String>,
    /// True without the influence; absent for a run.
    pub without: Option<bool>,
    /// Mean temperature, degC.
    pub temperature_deg_c: Option<f64>,
    /// Bias of a run, Earth rate removed where the site tells it; of an interval, its mean against those without the
    /// influence, the drift taken out. deg/h.
    pub mean_deg_h: f64,
    /// Standard uncertainty from the identified noise, deg/h.
    pub standard_uncertainty_deg_h: f64,
    /// Degrees of freedom of it.
    pub degrees_of_freedom: f64,
    /// Lower end of the 95 % interval, deg/h.
    pub low_deg_h: f64,
    /// Upper end of the 95 % interval, deg/h.
    pub high_deg_h: f64,
}
