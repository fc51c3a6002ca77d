//! Kinds that no data of a record can tell apart (section 10.1 of the domain reference), fixed before any result.
//!
//! Members of a class count as one name. What an effect outside the catalogue may be called besides `unknown` stands
//! here as well.

use super::scenario::Scenario;

/// When a class holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// Whatever the recording is.
    Always,
    /// The gyro keeps one heading.
    OneHeading,
    /// Heading is all that varies.
    Headings,
}

/// Class of section 10.1, members, when.
pub const CLASSES: &[(&str, &[&str], When)] = &[
    ("E1", &["markov_long", "random_telegraph"], When::Always),
    ("E2", &["temp_rate", "thermal_lag"], When::Always),
    ("E8", &["heading_change", "bias_step"], When::OneHeading),
    ("E8", &["earth_rate_projection", "table_harmonic"], When::Headings),
    ("E9", &["noise_variance_time", "outlier_bursts"], When::Always),
    ("E10", &["markov_short", "bandwidth_filter"], When::Always),
];

/// What an effect of no catalogue may be called besides `unknown`: a kind whose definition covers it.
pub const SUBSTITUTES: &[(&str, &[&str])] = &[
    ("am_line", &["quasi_periodic"]),
    ("chirp", &["quasi_periodic"]),
    ("glitch_train", &[]),
    ("heavy_tails", &["outlier_bursts"]),
    ("half_power_noise", &["excess_flicker"]),
    ("band_modulated_noise", &["quasi_periodic"]),
    ("temperature_supply_product", &["unobserved_driver"]),
    ("staircase_drift", &["unobserved_driver"]),
    ("drifting_sawtooth", &["unobserved_driver"]),
    ("one_sided_spikes", &["outlier_bursts"]),
    ("burst_in_band", &[]),
    ("echo", &[]),
    ("rectified_walk", &["excess_rrw", "unobserved_driver"]),
    ("intermittent_line", &["quasi_periodic"]),
    ("skewed_noise", &[]),
    ("reversing_line", &["quasi_periodic"]),
];

/// What an effect of the catalogue may be called besides `unknown` and its class when it is taken out of the catalogue: a
/// kind that holds it as a special case, or whose course or spectrum cannot be told from it over a record.
pub const REPLACEMENTS: &[(&str, &[&str])] = &[
    ("temp_linear", &["temp_polynomial", "thermal_lag", "unobserved_driver"]),
    ("temp_polynomial", &["unobserved_driver"]),
    ("temp_rate", &["thermal_lag", "temp_hysteresis", "unobserved_driver"]),
    ("thermal_lag", &["temp_rate", "temp_hysteresis", "unobserved_driver"]),
    ("temp_hysteresis", &["thermal_lag", "temp_rate", "unobserved_driver"]),
    ("warmup_exponential", &["unobserved_driver"]),
    ("rate_ramp", &["unobserved_driver", "excess_rrw", "warmup_exponential"]),
    ("diurnal", &["line", "unobserved_driver", "quasi_periodic"]),
    ("unobserved_driver", &["excess_rrw", "markov_long"]),
    ("excess_flicker", &["markov_long", "excess_rrw"]),
    ("excess_rrw", &["unobserved_driver", "excess_flicker", "markov_long"]),
    ("markov_long", &["excess_flicker", "excess_rrw", "unobserved_driver"]),
    ("quasi_periodic", &["line"]),
    ("line", &["quasi_periodic", "diurnal"]),
    ("noise_variance_rate", &["noise_variance_time"]),
    ("reset_ripple", &["line", "quasi_periodic"]),
    ("sf_asymmetry", &["sf_nonlinearity"]),
    ("saturation", &["sf_nonlinearity"]),
    ("sf_temperature", &["unobserved_driver"]),
    ("supply_sensitivity", &["unobserved_driver"]),
    ("time_offset", &["clock_drift"]),
    ("clock_drift", &["time_offset"]),
    ("earth_rate_projection", &["table_harmonic"]),
    ("table_harmonic", &["earth_rate_projection", "reset_ripple"]),
    ("bias_step", &["heading_change"]),
    ("heading_change", &["bias_step"]),
];

/// Names that count for an effect that was taken out of the catalogue, in a scenario.
pub fn replacements(kind: &str, scenario: Scenario) -> Vec<&'static str> {
    let mut out = same_class(kind, scenario);
    if let Some((_, allowed)) = REPLACEMENTS.iter().find(|(name, _)| *name == kind) {
        out.extend(*allowed);
    }
    out
}

/// Kinds that count as `kind` in a scenario, itself among them.
pub fn same_class(kind: &str, scenario: Scenario) -> Vec<&'static str> {
    let holds = |when: When| match when {
        When::Always => true,
        When::OneHeading => scenario != Scenario::Headings,
        When::Headings => scenario == Scenario::Headings,
    };
    let mut out: Vec<&'static str> = CLASSES
        .iter()
        .filter(|(_, members, when)| members.contains(&kind) && holds(*when))
        .flat_map(|(_, members, _)| members.iter().copied())
        .filter(|member| *member != kind)
        .collect();
    if let Some((_, allowed)) = SUBSTITUTES.iter().find(|(name, _)| *name == kind) {
        out.extend(*allowed);
    }
    out
}
