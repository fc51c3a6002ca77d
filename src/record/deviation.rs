//! Points of the Allan family.

use serde::{Deserialize, Serialize};

/// A deviation at one averaging time. `sigma_tau.csv` holds every point; here are octaves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DeviationRecord {
    /// Channel.
    pub channel: String,
    /// `oadev`, `mdev`, `hdev`, `totdev`.
    pub estimator: String,
    /// Averaging time, s.
    pub tau_s: f64,
    /// Deviation, deg/h.
    pub deviation_deg_h: f64,
    /// Lower end of its 95 % interval, deg/h.
    pub low_deg_h: Option<f64>,
    /// Upper end, deg/h.
    pub high_deg_h: Option<f64>,
    /// Equivalent degrees of freedom.
    pub edf: f64,
}
