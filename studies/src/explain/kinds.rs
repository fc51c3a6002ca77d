//! The table of kinds of effects, with the scenarios that show them.

use super::draw::Draw;
use super::effect::Effect;
use super::scenario::Scenario;
use super::setting::Setting;
use super::{angular, faults, rates, slow, stochastic, unknowns, unknowns_more};

/// Makes an effect of size `amplitude` (1: a first guess); the same stream gives the same shape at any size.
pub type Make = fn(&mut Draw, &Setting, f64) -> Effect;

/// A kind of effect, the scenarios it needs, and its maker.
pub struct Kind {
    /// Id of the kind.
    pub name: &'static str,
    /// Scenarios that show it.
    pub scenarios: &'static [Scenario],
    /// Makes it.
    pub make: Make,
    /// Smallest and largest amplitude that makes sense.
    pub bounds: (f64, f64),
}

const fn kind(name: &'static str, scenarios: &'static [Scenario], make: Make) -> Kind {
    Kind { name, scenarios, make, bounds: (1e-9, 1e9) }
}

const fn bounded(name: &'static str, scenarios: &'static [Scenario], make: Make, bounds: (f64, f64)) -> Kind {
    Kind { name, scenarios, make, bounds }
}

use Scenario::{
    Combined, Cycles, Days, Fixed, Headings, Outer, Rates, RatesThermal, Revolutions, Slow, Static, Supply,
    Thermal,
};

/// Scenarios in which nothing is known to happen, and some in which things do.
const QUIET: &[Scenario] = &[Static, Static, Static, Thermal, Rates, Supply, Headings];
/// Scenarios in which the claimed mean does not change quickly.
const STILL: &[Scenario] = &[Static, Static, Thermal, Supply];

/// All kinds of section 3 of the contract but `unknown`.
pub const KINDS: &[Kind] = &[
    kind("temp_linear", &[Thermal, Cycles, Combined], slow::temp_linear),
    kind("temp_polynomial", &[Thermal, Cycles, Combined], slow::temp_polynomial),
    kind("temp_rate", &[Thermal, Cycles, Combined], slow::temp_rate),
    kind("thermal_lag", &[Thermal, Cycles], slow::thermal_lag),
    kind("temp_hysteresis", &[Cycles], slow::temp_hysteresis),
    kind("warmup_exponential", &[Static, Static, Supply], slow::warmup),
    kind("rate_ramp", &[Static, Static, Supply, Headings], slow::rate_ramp),
    kind("diurnal", &[Days], slow::diurnal),
    kind("unobserved_driver", &[Static, Static, Supply], slow::unobserved_driver),
    bounded("excess_arw", QUIET, stochastic::excess_arw, (1e-3, 1e3)),
    bounded("excess_flicker", &[Static, Static, Static, Supply], stochastic::excess_flicker, (1e-3, 1e6)),
    bounded("excess_rrw", &[Static, Static, Static, Supply], stochastic::excess_rrw, (1e-3, 1e7)),
    bounded("markov_short", QUIET, stochastic::markov_short, (1e-3, 1e3)),
    bounded("markov_long", STILL, stochastic::markov_long, (1e-3, 1e4)),
    bounded("quasi_periodic", QUIET, stochastic::quasi_periodic, (1e-3, 1e4)),
    kind("line", QUIET, stochastic::line),
    bounded("quantization", QUIET, faults::quantization, (0.02, 10.0)),
    bounded("bandwidth_filter", STILL, stochastic::bandwidth_filter, (1.0, 50.0)),
    bounded("noise_variance_time", QUIET, stochastic::noise_variance_time, (1e-3, 50.0)),
    bounded("noise_variance_rate", &[Rates, RatesThermal], stochastic::noise_variance_rate, (1e-3, 50.0)),
    bounded("outlier_bursts", QUIET, faults::outlier_bursts, (0.5, 50.0)),
    kind("random_telegraph", STILL, slow::random_telegraph),
    kind("bias_step", &[Static, Static, Thermal, Supply], slow::bias_step),
    kind("heading_change", &[Fixed, Headings], angular::heading_change),
    bounded("earth_rate_projection", &[Headings], angular::earth_rate_projection, (1e-9, 1e5)),
    kind("table_harmonic", &[Revolutions], angular::table_harmonic),
    kind("reset_ripple", &[Slow], angular::reset_ripple),
    kind("sf_error", &[Rates, RatesThermal], rates::sf_error),
    kind("sf_asymmetry", &[Rates, RatesThermal], rates::sf_asymmetry),
    kind("sf_nonlinearity", &[Rates, RatesThermal], rates::sf_nonlinearity),
    kind("sf_temperature", &[RatesThermal], rates::sf_temperature),
    bounded("dead_zone", &[Slow], rates::dead_zone, (0.03, 10.0)),
    bounded("saturation", &[Rates], rates::saturation, (1e-3, 10.0)),
    kind("cross_axis", &[Outer], rates::cross_axis),
    kind("supply_sensitivity", &[Supply, Combined], slow::supply_sensitivity),
    bounded("dropped_samples", QUIET, faults::dropped_samples, (1.0, 1.0)),
    bounded("time_offset", &[Rates, RatesThermal], rates::time_offset, (1e-7, 30.0)),
    bounded("clock_drift", &[Rates, RatesThermal], rates::clock_drift, (1e-7, 1e3)),
];

/// Effects of no catalogue to develop with.
pub const DEVELOPMENT_UNKNOWNS: &[Kind] = &[
    kind("am_line", STILL, unknowns::am_line),
    kind("chirp", STILL, unknowns::chirp),
    kind("glitch_train", STILL, unknowns::glitch_train),
    bounded("heavy_tails", STILL, unknowns::heavy_tails, (1e-2, 30.0)),
    bounded("half_power_noise", STILL, unknowns::half_power_noise, (1e-4, 1e4)),
    bounded("band_modulated_noise", STILL, unknowns::band_modulated_noise, (1e-3, 1e3)),
    kind("temperature_supply_product", &[Combined], unknowns::temperature_supply_product),
    kind("staircase_drift", &[Static], unknowns::staircase_drift),
];

/// Effects of no catalogue that development never sees.
pub const HELD_OUT_UNKNOWNS: &[Kind] = &[
    kind("drifting_sawtooth", STILL, unknowns_more::drifting_sawtooth),
    kind("one_sided_spikes", STILL, unknowns_more::one_sided_spikes),
    bounded("burst_in_band", STILL, unknowns_more::burst_in_band, (1e-3, 1e3)),
    bounded("echo", STILL, unknowns_more::echo, (1e-3, 9.0)),
    kind("rectified_walk", &[Static], unknowns_more::rectified_walk),
    kind("intermittent_line", STILL, unknowns_more::intermittent_line),
    bounded("skewed_noise", STILL, unknowns_more::skewed_noise, (1e-2, 30.0)),
    kind("reversing_line", STILL, unknowns_more::reversing_line),
];

/// The kind called `name`, catalogued or not.
pub fn find(name: &str) -> Option<&'static Kind> {
    KINDS.iter().chain(DEVELOPMENT_UNKNOWNS).chain(HELD_OUT_UNKNOWNS).find(|k| k.name == name)
}

/// True of the kinds of section 3.
pub fn catalogued(name: &str) -> bool {
    KINDS.iter().any(|k| k.name == name)
}
