//! The words of kinds, parameters, tests and stated values. Titles and formulas of effects stand in the catalogue.

/// How a kind is said in the sentence of the verdict.
#[derive(Debug, Clone, Copy)]
pub struct Saying {
    /// Kind.
    pub kind: &'static str,
    /// Key of the phrase; its places are parameters of the finding, and `claimed`.
    pub key: &'static str,
    /// The parameter that the claim states with another value, for kinds that correct a stated one.
    pub states: Option<&'static str>,
}

const fn adds(kind: &'static str, key: &'static str) -> Saying {
    Saying { kind, key, states: None }
}

const fn corrects(kind: &'static str, key: &'static str, parameter: &'static str) -> Saying {
    Saying { kind, key, states: Some(parameter) }
}

/// Every kind that has a name.
pub const SAYINGS: &[Saying] = &[
    corrects("temp_linear", "explain.saying.temp_linear", "coefficient_deg_h_per_degC"),
    adds("temp_polynomial", "explain.saying.temp_polynomial"),
    adds("temp_rate", "explain.saying.temp_rate"),
    adds("thermal_lag", "explain.saying.thermal_lag"),
    adds("temp_hysteresis", "explain.saying.temp_hysteresis"),
    adds("warmup_exponential", "explain.saying.warmup_exponential"),
    adds("rate_ramp", "explain.saying.rate_ramp"),
    adds("diurnal", "explain.saying.diurnal"),
    adds("unobserved_driver", "explain.saying.unobserved_driver"),
    corrects("excess_arw", "explain.saying.excess_arw", "N_deg_rt_h"),
    corrects("excess_flicker", "explain.saying.excess_flicker", "B_deg_h"),
    corrects("excess_rrw", "explain.saying.excess_rrw", "K_deg_h_rt_h"),
    adds("markov_short", "explain.saying.markov_short"),
    adds("markov_long", "explain.saying.markov_long"),
    adds("quasi_periodic", "explain.saying.quasi_periodic"),
    adds("line", "explain.saying.line"),
    adds("quantization", "explain.saying.quantization"),
    adds("bandwidth_filter", "explain.saying.bandwidth_filter"),
    adds("noise_variance_time", "explain.saying.noise_variance_time"),
    adds("noise_variance_rate", "explain.saying.noise_variance_rate"),
    adds("outlier_bursts", "explain.saying.outlier_bursts"),
    adds("random_telegraph", "explain.saying.random_telegraph"),
    adds("bias_step", "explain.saying.bias_step"),
    adds("heading_change", "explain.saying.heading_change"),
    adds("earth_rate_projection", "explain.saying.earth_rate_projection"),
    adds("table_harmonic", "explain.saying.table_harmonic"),
    adds("reset_ripple", "explain.saying.reset_ripple"),
    corrects("sf_error", "explain.saying.sf_error", "error_ppm"),
    adds("sf_asymmetry", "explain.saying.sf_asymmetry"),
    adds("sf_nonlinearity", "explain.saying.sf_nonlinearity"),
    adds("sf_temperature", "explain.saying.sf_temperature"),
    adds("dead_zone", "explain.saying.dead_zone"),
    adds("saturation", "explain.saying.saturation"),
    adds("cross_axis", "explain.saying.cross_axis"),
    adds("supply_sensitivity", "explain.saying.supply_sensitivity"),
    adds("column_product", "explain.saying.column_product"),
    adds("column_curve", "explain.saying.column_curve"),
    adds("drifting_line", "explain.saying.drifting_line"),
    adds("power_law_noise", "explain.saying.power_law_noise"),
    adds("repeated_samples", "explain.saying.repeated_samples"),
    adds("dropped_samples", "explain.saying.dropped_samples"),
    adds("time_offset", "explain.saying.time_offset"),
    adds("clock_drift", "explain.saying.clock_drift"),
];

/// Names of parameters.
pub const PARAMETERS: &[(&str, &str)] = &[
    ("rms_deg_h", "explain.parameter.rms"),
    ("coefficient_deg_h_per_degC", "explain.parameter.temperature_coefficient"),
    ("coefficient_deg_h_per_degC_per_min", "explain.parameter.temperature_rate_coefficient"),
    ("coefficient_ppm_per_degC", "explain.parameter.scale_factor_temperature_coefficient"),
    ("coefficient_deg_h_per_V", "explain.parameter.supply_coefficient"),
    ("time_constant_s", "explain.parameter.time_constant"),
    ("loop_width_deg_h", "explain.parameter.loop_width"),
    ("amplitude_deg_h", "explain.parameter.amplitude"),
    ("amplitude_rms_deg_h", "explain.parameter.amplitude_rms"),
    ("slope_deg_h_per_h", "explain.parameter.slope"),
    ("period_s", "explain.parameter.period"),
    ("period_arcsec", "explain.parameter.angle_period"),
    ("N_deg_rt_h", "explain.parameter.arw"),
    ("B_deg_h", "explain.parameter.flicker"),
    ("K_deg_h_rt_h", "explain.parameter.rrw"),
    ("correlation_time_s", "explain.parameter.correlation_time"),
    ("sigma_deg_h", "explain.parameter.sigma"),
    ("frequency_hz", "explain.parameter.frequency"),
    ("phase_deg", "explain.parameter.phase"),
    ("coherence_time_s", "explain.parameter.coherence_time"),
    ("lsb_arcsec", "explain.parameter.lsb"),
    ("cutoff_hz", "explain.parameter.cutoff"),
    ("ratio", "explain.parameter.ratio"),
    ("count", "explain.parameter.count"),
    ("mean_dwell_s", "explain.parameter.mean_dwell"),
    ("step_deg_h", "explain.parameter.step"),
    ("time_s", "explain.parameter.instant"),
    ("order", "explain.parameter.order"),
    ("error_ppm", "explain.parameter.scale_factor_error"),
    ("asymmetry_ppm", "explain.parameter.asymmetry"),
    ("cubic_ppm_at_max", "explain.parameter.cubic"),
    ("half_width_deg_h", "explain.parameter.half_width"),
    ("limit_deg_s", "explain.parameter.limit"),
    ("misalignment_mrad", "explain.parameter.misalignment"),
    ("missing_rows", "explain.parameter.missing_rows"),
    ("repeated_share", "explain.parameter.repeated_share"),
    ("lag_s", "explain.parameter.lag"),
    ("drift_ppm", "explain.parameter.drift"),
];

/// Parameters that have a direction, whose plus is worth printing.
pub const SIGNED: &[&str] = &[
    "coefficient_deg_h_per_degC_per_min",
    "coefficient_ppm_per_degC",
    "coefficient_deg_h_per_V",
    "slope_deg_h_per_h",
    "step_deg_h",
    "error_ppm",
    "asymmetry_ppm",
    "cubic_ppm_at_max",
    "misalignment_mrad",
    "lag_s",
    "drift_ppm",
];

/// Names of values that a claim states, by the last part of their key.
pub const STATED: &[(&str, &str)] = &[
    ("N_deg_rt_h", "explain.parameter.arw"),
    ("B_deg_h", "explain.parameter.flicker"),
    ("K_deg_h_rt_h", "explain.parameter.rrw"),
    ("value_deg_h", "explain.stated.bias"),
    ("bias_deg_h", "explain.stated.bias"),
    ("coefficient_deg_h_per_degC", "explain.parameter.temperature_coefficient"),
    ("error_ppm", "explain.stated.scale_factor_error"),
];

/// Names of the tests.
pub const TESTS: &[(&str, &str)] = &[
    ("spectrum", "explain.test.spectrum"),
    ("line", "explain.test.line"),
    ("level", "explain.test.level"),
    ("local_power", "explain.test.local_power"),
    ("comb", "explain.test.comb"),
    ("lag", "explain.test.lag"),
    ("tile", "explain.test.tile"),
    ("tails", "explain.test.tails"),
    ("skewness", "explain.test.skewness"),
    ("column_mean", "explain.test.column_mean"),
    ("size", "explain.test.size"),
    ("product", "explain.test.product"),
    ("repeats", "explain.test.repeats"),
];

/// Where a mismatch shows, its unit, and the phrase with a `{place}`.
pub const DOMAINS: &[(&str, &str, &str)] = &[
    ("time", "s", "explain.where.time"),
    ("frequency", "Hz", "explain.where.frequency"),
    ("lag", "s", "explain.where.lag"),
    ("temperature", "degC", "explain.where.temperature"),
    ("temperature_rate", "degC/min", "explain.where.temperature_rate"),
    ("input_rate", "deg/s", "explain.where.input_rate"),
    ("outer_rate", "deg/s", "explain.where.outer_rate"),
    ("angle", "deg", "explain.where.angle"),
    ("amplitude", "deg/h", "explain.where.amplitude"),
    ("timestamps", "s", "explain.where.timestamps"),
    ("supply", "V", "explain.where.supply"),
];

/// Headings of the views.
pub const VIEWS: &[(&str, &str)] = &[
    ("time", "explain.view.time"),
    ("frequency", "explain.view.frequency"),
    ("lag", "explain.view.lag"),
    ("temperature", "explain.view.temperature"),
    ("temperature_rate", "explain.view.temperature_rate"),
    ("input_rate", "explain.view.input_rate"),
    ("outer_rate", "explain.view.outer_rate"),
    ("angle", "explain.view.angle"),
    ("amplitude", "explain.view.amplitude"),
    ("timestamps", "explain.view.timestamps"),
    ("supply", "explain.view.supply"),
];

/// The key that a table has for an id.
pub fn key(table: &[(&'static str, &'static str)], id: &str) -> Option<&'static str> {
    table.iter().find(|(known, _)| *known == id).map(|(_, key)| *key)
}
