//! Measurands that rest on one thing together: a check that contradicts it names them all.

/// Measurands of slow noise at rest.
pub(crate) const SLOW_NOISE: [&str; 4] =
    ["bias_instability", "rate_random_walk", "rate_random_walk_readout", "rate_ramp"];

/// Fast noise that follows from a fit of the noise model.
pub(super) const NOISE_OF_FIT: [&str; 3] = ["angle_random_walk", "angle_random_walk_white", "quantization"];

/// Every measurand of a gyro at rest that follows from the noise of the record.
pub(crate) const NOISE_MEASURANDS: [&str; 17] = [
    "angle_random_walk",
    "angle_random_walk_white",
    "angle_random_walk_readout",
    "bias_instability",
    "bias_instability_minimum",
    "bias_instability_minimum_scaled",
    "rate_random_walk",
    "rate_random_walk_readout",
    "rate_ramp",
    "rate_ramp_readout",
    "quantization",
    "quantization_readout",
    "russian_drift_100s",
    "russian_drift_100s_3sigma",
    "russian_sigma_10s",
    "russian_arw_10s",
    "russian_drift_100s_predicted",
];
