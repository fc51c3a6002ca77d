//! Measured quantities of every kind of test. Adding one is one file and one line in the registry below.
//!
//! A [`Measurand`] says what it is and has its evaluation: a pure function of what its kind of test leaves behind
//! ([`crate::evidence`]). Whoever singles one out names its constant.

mod acceleration;
pub mod allan_minimum;
mod angle_random_walk_shift;
mod bias_repeatability;
mod correlated_noise;
mod cross_axis;
mod dead_zone;
mod descriptor;
mod earth_rate;
mod influence;
mod maximum_rate;
mod misalignment;
mod noise_density_ratio;
mod noise_in_band;
mod noise_terms;
mod polarity;
pub mod russian;
pub mod russian_prediction;
mod scale_factor;
mod scale_factor_changes;
mod scale_factor_over_temperature;
mod scale_factor_shape;
mod sine_response;
mod slope_readout;
mod spectral_line;
mod start_up;
pub mod static_bias;
mod table_harmonics;
mod temperature;
mod transfer;
mod vibration_rectification;
mod vibration_resonance;
mod warm_up;

pub use crate::evidence;
#[cfg(test)]
use crate::evidence::test_evidence;
use crate::rate_table::design::Extra;
pub use descriptor::{
    EARTH_RATE_OPTION, Evaluation, Measurand, OfKnownInput, OfSteps, Options, PowerModel, Stimulus, Test,
    TurnAxis,
};
pub use evidence::{ComparisonEvidence, Earth, GyroEvidence, KnownInputEvidence, TableEvidence};
pub use influence::PerLevel;

macro_rules! registry {
    ($($file:ident::$name:ident,)*) => {
        $(pub use $file::$name;)*

        /// Every measurand, in the order of reports.
        pub static MEASURANDS: &[&Measurand] = &[$(&$file::$name,)*];
    };
}

registry! {
    static_bias::STATIC_BIAS,
    earth_rate::EARTH_RATE_COMPONENT,
    noise_terms::ANGLE_RANDOM_WALK,
    noise_terms::ANGLE_RANDOM_WALK_WHITE,
    noise_terms::BIAS_INSTABILITY,
    allan_minimum::BIAS_INSTABILITY_MINIMUM,
    allan_minimum::BIAS_INSTABILITY_MINIMUM_SCALED,
    noise_terms::RATE_RANDOM_WALK,
    noise_terms::RATE_RAMP,
    noise_terms::QUANTIZATION,
    slope_readout::ANGLE_RANDOM_WALK_READOUT,
    slope_readout::RATE_RANDOM_WALK_READOUT,
    slope_readout::RATE_RAMP_READOUT,
    slope_readout::QUANTIZATION_READOUT,
    russian::RUSSIAN_DRIFT_100S,
    russian::RUSSIAN_DRIFT_100S_3SIGMA,
    russian::RUSSIAN_SIGMA_10S,
    russian::RUSSIAN_ARW_10S,
    spectral_line::LINE_FREQUENCY,
    spectral_line::LINE_AMPLITUDE,
    noise_in_band::OUTPUT_NOISE_RMS,
    noise_in_band::RATE_NOISE_DENSITY,
    noise_in_band::SPECTRAL_MASK,
    correlated_noise::MARKOV_SIGMA,
    correlated_noise::MARKOV_CORRELATION_TIME,
    correlated_noise::QUASI_PERIODIC_AMPLITUDE,
    correlated_noise::QUASI_PERIODIC_FREQUENCY,
    correlated_noise::QUASI_PERIODIC_COHERENCE_TIME,
    russian_prediction::RUSSIAN_DRIFT_100S_PREDICTED,
    russian_prediction::RATIO_RUSSIAN_TO_ALLAN_BIAS,
    russian_prediction::RATIO_RUSSIAN_TO_ALLAN_ARW,
    temperature::BIAS_TEMPERATURE_SENSITIVITY,
    temperature::BIAS_TEMPERATURE_SENSITIVITY_MAX,
    temperature::BIAS_TEMPERATURE_RATE_SENSITIVITY,
    temperature::THERMAL_LAG,
    temperature::THERMAL_HYSTERESIS,
    temperature::BIAS_OVER_TEMPERATURE_PEAK_TO_PEAK,
    temperature::BIAS_OVER_TEMPERATURE_RMS,
    temperature::BIAS_OVER_TEMPERATURE_3SIGMA,
    temperature::BIAS_LOOP_WIDTH,
    temperature::BIAS_RESIDUAL_RMS,
    temperature::RAMP_RATE,
    warm_up::TURN_ON_TRANSIENT,
    warm_up::WARM_UP_TIME,
    temperature::ANGLE_RANDOM_WALK_AT_TEMPERATURE,
    scale_factor::SCALE_FACTOR,
    scale_factor::SCALE_FACTOR_ERROR,
    scale_factor_shape::SCALE_FACTOR_NONLINEARITY,
    scale_factor_shape::SCALE_FACTOR_NONLINEARITY_OF_RATE,
    scale_factor::SCALE_FACTOR_BIAS,
    scale_factor_shape::SCALE_FACTOR_RESIDUAL,
    scale_factor_shape::SCALE_FACTOR_ODD,
    scale_factor_shape::SCALE_FACTOR_EVEN,
    scale_factor_shape::SCALE_FACTOR_ASYMMETRY,
    scale_factor_changes::SCALE_FACTOR_REPEATABILITY,
    scale_factor_changes::SCALE_FACTOR_HYSTERESIS,
    scale_factor_changes::SCALE_FACTOR_TEMPERATURE_SENSITIVITY,
    scale_factor_over_temperature::SF_OVER_TEMPERATURE_PEAK_TO_PEAK,
    scale_factor_over_temperature::SF_TEMPERATURE_HYSTERESIS,
    sine_response::SINE_RESPONSE,
    polarity::POLARITY,
    maximum_rate::MAXIMUM_RATE,
    maximum_rate::SATURATION_LEVEL,
    maximum_rate::OVERLOAD_RECOVERY,
    misalignment::MISALIGNMENT_X,
    misalignment::MISALIGNMENT_Y,
    misalignment::MISALIGNMENT_X_TEMPERATURE_SENSITIVITY,
    misalignment::MISALIGNMENT_Y_TEMPERATURE_SENSITIVITY,
    cross_axis::CROSS_AXIS,
    dead_zone::DEAD_ZONE,
    dead_zone::DEAD_ZONE_NOISE,
    dead_zone::THRESHOLD,
    dead_zone::RESOLUTION,
    table_harmonics::TABLE_HARMONIC_1,
    table_harmonics::TABLE_HARMONIC_2,
    acceleration::G_SENSITIVITY_I,
    acceleration::G_SENSITIVITY_O,
    acceleration::G_SENSITIVITY_S,
    acceleration::G2_SENSITIVITY_II,
    acceleration::G2_SENSITIVITY_OO,
    acceleration::G2_SENSITIVITY_IO,
    acceleration::G2_SENSITIVITY_IS,
    acceleration::G2_SENSITIVITY_OS,
    transfer::BANDWIDTH_3DB,
    transfer::BANDWIDTH_3DB_MODEL,
    transfer::BANDWIDTH_PHASE_90,
    transfer::LATENCY,
    transfer::RESONANCE_PEAK,
    transfer::RESPONSE_FLATNESS,
    start_up::TIME_TO_FIRST_SAMPLE,
    start_up::TIME_TO_VALID_DATA,
    start_up::POWER_STEADY,
    start_up::POWER_PEAK,
    start_up::INRUSH_CURRENT,
    influence::MAGNETIC_SENSITIVITY,
    influence::SUPPLY_SENSITIVITY,
    influence::VIBRATION_SENSITIVITY,
    influence::INFLUENCE_SENSITIVITY,
    influence::INFLUENCE_SENSITIVITY_QUADRATIC,
    influence::BIAS_SHIFT,
    influence::SCALE_FACTOR_INFLUENCE_SENSITIVITY,
    influence::SCALE_FACTOR_INFLUENCE_SENSITIVITY_QUADRATIC,
    influence::SCALE_FACTOR_SHIFT,
    angle_random_walk_shift::ANGLE_RANDOM_WALK_SHIFT,
    noise_density_ratio::NOISE_DENSITY_RATIO,
    vibration_rectification::VIBRATION_RECTIFICATION_IN_BAND,
    vibration_resonance::VIBRATION_RESONANCE_FREQUENCY,
    vibration_resonance::VIBRATION_RESONANCE_QUALITY,
    vibration_resonance::VIBRATION_RESONANCE_RESPONSE,
    bias_repeatability::BIAS_REPEATABILITY,
    bias_repeatability::BIAS_REPEATABILITY_PEAK_TO_PEAK,
    bias_repeatability::BIAS_REPEATABILITY_TREND,
    bias_repeatability::BIAS_REPEATABILITY_TEMPERATURE,
}

/// The measurand of an id.
pub fn find(id: &str) -> Option<&'static Measurand> {
    MEASURANDS.iter().copied().find(|m| m.id == id)
}

/// The measurand that a name other than its id stands for: a symbol such as `N`, an abbreviation such as `ARW`.
pub fn called(name: &str) -> Option<&'static Measurand> {
    let plain = name.trim().to_lowercase().replace(['-', ' '], "_");
    MEASURANDS.iter().copied().find(|m| m.other_names.contains(&plain.as_str()))
}

/// The measurands whose ids hold a word, such as `hysteresis`.
pub fn with_word(word: &str) -> Vec<&'static Measurand> {
    let plain = word.trim().to_lowercase();
    MEASURANDS.iter().copied().filter(|m| m.id.split('_').any(|part| part == plain)).collect()
}

/// Terms that the model of the response to a rate table has to hold beside the rate, for the measurands that are wanted.
pub fn table_extras(wanted: &dyn Fn(&Measurand) -> bool) -> Vec<Extra> {
    let steps = MEASURANDS.iter().filter(|m| wanted(m)).filter_map(|m| m.by_steps());
    steps.flat_map(|s| s.extras).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::criticism;
    use crate::units::Unit;

    #[test]
    fn ids_are_unique_and_units_are_units() {
        for (i, m) in MEASURANDS.iter().enumerate() {
            assert!(m.unit.is_empty() || Unit::parse(m.unit).is_ok(), "{} {}", m.id, m.unit);
            assert_eq!(m.unit.is_empty(), !m.recorded_in.is_empty(), "{}", m.id);
            assert!(m.recorded_in.iter().all(|u| Unit::parse(u).is_ok()), "{} {:?}", m.id, m.recorded_in);
            assert!(MEASURANDS[..i].iter().all(|other| other.id != m.id), "{}", m.id);
            assert!(!m.doc.is_empty());
            for name in m.other_names {
                assert_eq!(called(name), Some(*m), "`{name}` stands for two");
                assert!(find(name).is_none(), "`{name}` is an id");
            }
            let on_table = m.test() == Test::RateTable;
            assert_eq!(on_table, m.by_steps().is_some() || m.by_known_input().is_some(), "{}", m.id);
        }
    }

    #[test]
    fn what_checks_contradict_are_measurands() {
        let ids = criticism::NOISE_MEASURANDS.iter().chain(&criticism::SLOW_NOISE);
        assert!(ids.clone().all(|id| find(id).is_some()), "{:?}", ids.collect::<Vec<_>>());
    }

    #[test]
    fn symbols_and_abbreviations_stand_for_ids() {
        for (name, id) in [
            ("arw", "angle_random_walk"),
            ("ARW", "angle_random_walk"),
            ("N", "angle_random_walk"),
            ("rrw", "rate_random_walk"),
            ("K", "rate_random_walk"),
            ("bi", "bias_instability"),
            ("b", "bias_instability"),
            ("bias", "static_bias"),
            ("sf", "scale_factor"),
            ("Bias stability", "bias_instability"),
        ] {
            assert_eq!(called(name).map(|m| m.id), Some(id), "{name}");
        }
        assert_eq!(called("angle"), None);
        let hysteresis: Vec<&str> = with_word("Hysteresis").iter().map(|m| m.id).collect();
        assert_eq!(
            hysteresis,
            ["thermal_hysteresis", "scale_factor_hysteresis", "sf_temperature_hysteresis"]
        );
    }

    #[test]
    fn units_are_those_of_the_result_contract() {
        for (id, unit) in [
            ("static_bias", "deg/h"),
            ("angle_random_walk", "deg/sqrt(h)"),
            ("rate_random_walk", "deg/h/sqrt(h)"),
            ("rate_ramp", "deg/h/h"),
            ("quantization", "arcsec"),
            ("russian_arw_10s", "deg/sqrt(h)"),
            ("bias_temperature_rate_sensitivity", "deg/h/(degC/min)"),
            ("scale_factor_temperature_sensitivity", "ppm/degC"),
            ("vibration_sensitivity", "deg/h/g^2"),
            ("line_frequency", "Hz"),
        ] {
            assert_eq!(find(id).unwrap().unit, unit);
        }
    }

    #[test]
    fn the_model_of_a_table_holds_what_the_measurands_wanted_need() {
        assert!(table_extras(&|_| false).is_empty());
        assert_eq!(table_extras(&|m| m.id == "table_harmonic_2"), [Extra::Cosine(2), Extra::Sine(2)]);
        let two = table_extras(&|m| m.id == "scale_factor_hysteresis" || m.id == "table_harmonic_1");
        assert_eq!(two, [Extra::Approach, Extra::Cosine(1), Extra::Sine(1)]);
        assert!(find("none").is_none() && with_word("none").is_empty());
    }
}
