//! Every measurand by id: its unit, the test that gives it, whether this version gives it.
//!
//! The ids and units are the contract of `result.json`.

/// The test that gives a measurand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Test {
    /// Rate at rest at constant temperature.
    Static,
    /// Rate at rest over temperature.
    Temperature,
    /// Rate about the input axis given by a table.
    RateTable,
    /// Rate at rest over an influence other than temperature, or over switching on and off.
    Influence,
}

impl Test {
    /// Id of the test; `test.<id>` is its name in the locale tables.
    pub fn id(self) -> &'static str {
        match self {
            Test::Static => "static",
            Test::Temperature => "temperature",
            Test::RateTable => "rate_table",
            Test::Influence => "influence",
        }
    }
}

/// One measurand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MeasurandId {
    /// Id in procedures, limits and results.
    pub id: &'static str,
    /// Unit in results; limits and references are converted to it. Empty: as recorded.
    pub unit: &'static str,
    /// Test that gives it.
    pub test: Test,
    /// True when this version gives it.
    pub available: bool,
    /// True when it can be negative, so that a limit on its magnitude makes sense.
    pub signed: bool,
    /// Options that a procedure may set for it.
    pub options: &'static [&'static str],
    /// What it is, in one line.
    pub doc: &'static str,
}

const fn given(
    id: &'static str,
    unit: &'static str,
    options: &'static [&'static str],
    doc: &'static str,
) -> MeasurandId {
    MeasurandId { id, unit, test: Test::Static, available: true, signed: false, options, doc }
}

const fn signed(mut m: MeasurandId) -> MeasurandId {
    m.signed = true;
    m
}

const fn over_temperature(id: &'static str, unit: &'static str, doc: &'static str) -> MeasurandId {
    MeasurandId { id, unit, test: Test::Temperature, available: true, signed: false, options: &[], doc }
}

const fn influence(id: &'static str, unit: &'static str, doc: &'static str) -> MeasurandId {
    MeasurandId { id, unit, test: Test::Influence, available: true, signed: false, options: &[], doc }
}

const fn table(id: &'static str, unit: &'static str, doc: &'static str) -> MeasurandId {
    MeasurandId { id, unit, test: Test::RateTable, available: true, signed: false, options: &[], doc }
}

/// Every measurand, in the order of reports.
#[rustfmt::skip]
pub const MEASURANDS: &[MeasurandId] = &[
    signed(given("static_bias", "deg/h", &["earth_rate"], "mean rate at rest, Earth rate removed")),
    signed(given("earth_rate_component", "deg/h", &[], "Earth rate along the input axis, from the site")),
    given("angle_random_walk", "deg/sqrt(h)", &[], "N of the joint noise fit: white noise with every process that is white where it is read"),
    given("angle_random_walk_white", "deg/sqrt(h)", &[], "the part of N that is white noise at every averaging time"),
    given("bias_instability", "deg/h", &[], "flicker coefficient B of the joint noise fit"),
    given("bias_instability_minimum", "deg/h", &[], "minimum of the overlapping Allan deviation over octaves up to a fifth of the record"),
    given("bias_instability_minimum_scaled", "deg/h", &[], "that minimum divided by 0.664"),
    given("rate_random_walk", "deg/h/sqrt(h)", &[], "K of the joint noise fit"),
    given("rate_ramp", "deg/h/h", &[], "R of the joint noise fit"),
    given("quantization", "arcsec", &[], "Q of the joint noise fit"),
    given("angle_random_walk_readout", "deg/sqrt(h)", &[], "N at 1 h on a line of slope -1/2 through the Allan deviation"),
    given("rate_random_walk_readout", "deg/h/sqrt(h)", &[], "K at 3 h on a line of slope +1/2 through the Allan deviation"),
    given("rate_ramp_readout", "deg/h/h", &[], "R at sqrt(2) h on a line of slope +1 through the Allan deviation"),
    given("quantization_readout", "arcsec", &[], "Q at sqrt(3) s on a line of slope -1 through the Allan deviation"),
    given("russian_drift_100s", "deg/h", &[], "standard deviation of consecutive 100-s means, one sigma"),
    given("russian_drift_100s_3sigma", "deg/h", &[], "three times the standard deviation of consecutive 100-s means"),
    given("russian_sigma_10s", "deg/h", &[], "standard deviation of consecutive 10-s means"),
    given("russian_arw_10s", "deg/sqrt(h)", &[], "angle random walk from 10-s means: sqrt(10) sigma / 60"),
    given("line_frequency", "Hz", &[], "frequency of the strongest spectral line"),
    given("line_amplitude", "deg/h", &[], "amplitude of the strongest spectral line"),
    given("markov_sigma", "deg/h", &[], "standard deviation of exponentially correlated noise"),
    given("markov_correlation_time", "s", &[], "its correlation time"),
    given("quasi_periodic_amplitude", "deg/h", &[], "rms of a narrow-band disturbance"),
    given("quasi_periodic_frequency", "Hz", &[], "its centre frequency"),
    given("quasi_periodic_coherence_time", "s", &[], "its coherence time"),
    given("russian_drift_100s_predicted", "deg/h", &[], "what the identified noise predicts for 100-s means"),
    given("ratio_russian_to_allan_bias", "1", &[], "Russian 100-s drift over the Allan minimum"),
    given("ratio_russian_to_allan_arw", "1", &[], "Russian 10-s angle random walk over N"),
    signed(over_temperature("bias_temperature_sensitivity", "deg/h/degC", "slope of bias over temperature")),
    signed(over_temperature("bias_temperature_sensitivity_max", "deg/h/degC", "steepest local slope")),
    signed(over_temperature("bias_temperature_rate_sensitivity", "deg/h/(degC/min)", "bias per rate of temperature (Shupe)")),
    over_temperature("thermal_lag", "s", "delay between temperature sensor and coil"),
    signed(over_temperature("thermal_hysteresis", "deg/h", "largest gap between the heating and the cooling branch that no rate of temperature explains")),
    over_temperature("bias_over_temperature_peak_to_peak", "deg/h", "range of bias over temperature"),
    over_temperature("bias_over_temperature_rms", "deg/h", "rms of bias about its mean over temperature (one sigma)"),
    over_temperature("bias_over_temperature_3sigma", "deg/h", "three times that rms"),
    signed(over_temperature("bias_loop_width", "deg/h", "largest gap between heating and cooling at the rate of the ramps, whatever its cause")),
    over_temperature("bias_residual_rms", "deg/h", "rms left after the temperature model"),
    signed(over_temperature("ramp_rate", "degC/h", "rate of a temperature ramp")),
    signed(over_temperature("turn_on_transient", "deg/h", "bias at switching on, less its final value")),
    over_temperature("warm_up_time", "s", "time after switching on until the bias stays in its band"),
    over_temperature("angle_random_walk_at_temperature", "deg/sqrt(h)", "N in one temperature zone"),
    signed(table("scale_factor", "", "output per input")),
    signed(table("scale_factor_error", "ppm", "deviation from the nominal scale factor")),
    table("scale_factor_nonlinearity", "ppm", "largest residual of full scale"),
    table("scale_factor_nonlinearity_of_rate", "ppm", "largest residual of the rate itself"),
    signed(table("scale_factor_bias", "deg/h", "output at rest by the line through all rates")),
    table("scale_factor_residual", "ppm", "rms of the residuals of full scale"),
    signed(table("scale_factor_odd", "ppm", "cubic term at full scale")),
    signed(table("scale_factor_even", "ppm", "quadratic term at full scale")),
    signed(table("scale_factor_asymmetry", "ppm", "difference between positive and negative rates")),
    table("scale_factor_repeatability", "ppm", "spread between repeated runs"),
    signed(table("scale_factor_hysteresis", "ppm", "difference between rates reached from below and above")),
    signed(table("scale_factor_temperature_sensitivity", "ppm/degC", "change of scale factor with temperature")),
    table("sine_response", "s", "phase per rate of an open-loop response"),
    signed(table("misalignment_x", "mrad", "tilt of the input axis about the first reference axis")),
    signed(table("misalignment_y", "mrad", "tilt of the input axis about the second reference axis")),
    signed(table("cross_axis", "1", "output of one axis per rate about another")),
    table("dead_zone", "deg/h", "half width of the zone without response"),
    table("dead_zone_noise", "deg/h", "standard deviation of the rate noise inside the loop, which rounds the dead zone off"),
    table("threshold", "deg/h", "smallest rate that is shown"),
    table("resolution", "deg/h", "smallest change of rate that is shown"),
    table("table_harmonic_1", "deg/h", "error once per revolution"),
    table("table_harmonic_2", "deg/h", "error twice per revolution"),
    signed(influence("magnetic_sensitivity", "deg/h/mT", "bias per magnetic field")),
    signed(influence("supply_sensitivity", "deg/h/V", "bias per supply voltage")),
    signed(influence("vibration_sensitivity", "deg/h/g^2", "bias per vibration power")),
    signed(influence("bias_shift", "deg/h", "change of the bias at one level of an influence")),
    signed(influence("angle_random_walk_shift", "deg/sqrt(h)", "change of N at one level of an influence")),
    influence("bias_repeatability", "deg/h", "standard deviation of the bias between switchings-on, noise taken out"),
    influence("bias_repeatability_peak_to_peak", "deg/h", "largest less smallest bias of the switchings-on"),
    signed(influence("bias_repeatability_trend", "deg/h", "change from the first to the last switching-on by the line through all")),
    signed(influence("bias_repeatability_temperature", "deg/h/degC", "change of the bias with the temperature of the switchings-on")),
];

/// The measurand of an id.
pub fn find(id: &str) -> Option<&'static MeasurandId> {
    MEASURANDS.iter().find(|m| m.id == id)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Unit;

    #[test]
    fn ids_are_unique_and_units_are_units() {
        for (i, m) in MEASURANDS.iter().enumerate() {
            assert!(m.unit.is_empty() || Unit::parse(m.unit).is_ok(), "{} {}", m.id, m.unit);
            assert!(MEASURANDS[..i].iter().all(|other| other.id != m.id), "{}", m.id);
            assert!(!m.doc.is_empty());
        }
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
}
