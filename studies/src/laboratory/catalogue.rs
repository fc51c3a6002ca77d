//! Every subject of the laboratory, by family; the split into halves.

use super::bench::Bench;
use super::effect::Effect;
use super::subjects::{driver, event, noise, table, temperature, unknown, unrecorded};
use super::truth::{Family, Half};

/// One subject: a scene, and what is concealed in it.
pub struct Subject {
    /// Its name.
    pub name: &'static str,
    /// Its family.
    pub family: Family,
    /// Sets up the scene on a bench at rest.
    pub scene: fn(&mut Bench),
    /// The effects.
    pub effects: &'static [fn(&mut Bench) -> Effect],
    /// Whether it takes days.
    pub days: bool,
}

const fn one(
    family: Family,
    name: &'static str,
    scene: fn(&mut Bench),
    effects: &'static [fn(&mut Bench) -> Effect],
) -> Subject {
    Subject { name, family, scene, effects, days: false }
}

use Family::{Driver, Event, Noise, Null, Several, Table, Temperature, Unknown, Unrecorded};

/// Every subject with a sized effect; missing rows and nulls are made by themselves.
pub static SUBJECTS: &[Subject] = &[
    one(Temperature, "temp_linear", temperature::quick, &[temperature::linear]),
    one(Temperature, "temp_polynomial", temperature::quick, &[temperature::polynomial]),
    one(Temperature, "temp_rate", temperature::quick, &[temperature::rate]),
    one(Temperature, "thermal_lag", temperature::slow, &[temperature::lag]),
    one(Temperature, "temp_hysteresis", temperature::quick, &[temperature::hysteresis]),
    one(Driver, "supply_sensitivity", driver::among_decoys, &[driver::supply]),
    one(Driver, "column_linear", driver::among_decoys, &[driver::column_linear]),
    one(Driver, "column_rate", driver::among_decoys, &[driver::column_rate]),
    one(Driver, "column_lag", driver::among_decoys, &[driver::column_lag]),
    one(Driver, "column_curve", driver::among_decoys, &[driver::column_curve]),
    one(Driver, "column_hysteresis", driver::among_decoys, &[driver::column_hysteresis]),
    one(Driver, "noise_variance_driver", driver::among_decoys, &[driver::noise_level]),
    one(Driver, "sf_supply", driver::table_with_supply, &[driver::scale_by_supply]),
    one(Unrecorded, "sf_hidden", driver::table_alone, &[driver::scale_hidden]),
    one(Unrecorded, "warmup_exponential", unrecorded::at_rest, &[unrecorded::warm_up]),
    one(Unrecorded, "rate_ramp", unrecorded::at_rest, &[unrecorded::ramp]),
    Subject {
        name: "diurnal",
        family: Unrecorded,
        scene: unrecorded::at_rest,
        effects: &[unrecorded::day],
        days: true,
    },
    one(Unrecorded, "chamber_hidden", unrecorded::at_rest, &[unrecorded::chamber_hidden]),
    one(Unrecorded, "room_hidden", unrecorded::nothing_recorded, &[unrecorded::room_hidden]),
    one(Unrecorded, "supply_hidden", unrecorded::nothing_recorded, &[unrecorded::supply_hidden]),
    one(Unrecorded, "weather_hidden", unrecorded::nothing_recorded, &[unrecorded::weather_hidden]),
    one(Table, "sf_error", table::steps, &[table::error]),
    one(Table, "sf_asymmetry", table::steps, &[table::asymmetry]),
    one(Table, "sf_nonlinearity", table::steps, &[table::sine]),
    one(Table, "sf_temperature", table::steps_in_chamber, &[table::by_temperature]),
    one(Table, "dead_zone", table::crawl, &[table::lock]),
    one(Table, "saturation", table::steps, &[table::limit]),
    one(Table, "cross_axis", table::other_axis, &[table::cross]),
    one(Table, "table_harmonic", table::turning, &[table::harmonic]),
    one(Table, "earth_rate_projection", table::positions, &[table::heading]),
    one(Table, "reset_ripple", table::crawl, &[table::reset]),
    one(Table, "time_offset", table::swings, &[table::offset]),
    one(Table, "clock_drift", table::swings, &[table::drift]),
    one(Event, "line", event::at_rest, &[event::line]),
    one(Event, "quasi_periodic", event::at_rest, &[event::resonant]),
    one(Event, "comb", event::at_rest, &[event::strokes]),
    one(Event, "outlier_bursts", event::at_rest, &[event::bursts]),
    one(Event, "random_telegraph", event::at_rest, &[event::telegraph]),
    one(Event, "bias_step", event::at_rest, &[event::step]),
    one(Event, "heading_change", event::on_positions, &[event::slip]),
    one(Noise, "excess_arw", noise::at_rest, &[noise::white]),
    one(Noise, "excess_flicker", noise::at_rest, &[noise::flicker]),
    one(Noise, "excess_rrw", noise::at_rest, &[noise::walk]),
    one(Noise, "markov_short", noise::at_rest, &[noise::short]),
    one(Noise, "markov_long", noise::at_rest, &[noise::long]),
    one(Noise, "quantization", noise::at_rest, &[noise::quantisation]),
    one(Noise, "bandwidth_filter", noise::at_rest, &[noise::filter]),
    one(Noise, "noise_variance_time", noise::at_rest, &[noise::level_in_time]),
    one(Noise, "noise_variance_rate", noise::on_table, &[noise::level_by_rate]),
    one(Several, "curve_and_rate", temperature::quick, &[temperature::polynomial, temperature::rate]),
    one(
        Several,
        "curve_and_hysteresis",
        temperature::quick,
        &[temperature::polynomial, temperature::hysteresis],
    ),
    one(Several, "rate_and_walk", temperature::quick, &[temperature::rate, noise::walk]),
    one(
        Several,
        "curve_rate_and_step",
        temperature::quick,
        &[temperature::polynomial, temperature::rate, event::step],
    ),
    one(Several, "lag_and_line", temperature::slow, &[temperature::lag, event::line]),
    one(Several, "supply_and_white", driver::among_decoys, &[driver::supply, noise::white]),
    one(Several, "column_and_supply", driver::among_decoys, &[driver::column_linear, driver::supply]),
    one(Several, "column_and_bursts", driver::among_decoys, &[driver::column_curve, event::bursts]),
    one(
        Several,
        "scale_by_temperature_and_error",
        table::steps_in_chamber,
        &[table::by_temperature, table::error],
    ),
    one(Several, "offset_and_asymmetry", table::swings, &[table::offset, table::asymmetry]),
    one(Several, "saturation_and_harmonic", table::turning, &[table::harmonic, table::limit]),
    one(Several, "step_and_line", event::at_rest, &[event::step, event::line]),
    one(Several, "markov_and_level", noise::at_rest, &[noise::short, noise::level_in_time]),
    one(Several, "warm_up_and_resonance", unrecorded::at_rest, &[unrecorded::warm_up, event::resonant]),
    // Every second one is of the development half.
    one(Unknown, "avalanches", unknown::at_rest, &[unknown::avalanches]),
    one(Unknown, "stick_slip", unknown::at_rest, &[unknown::stick_slip]),
    one(Unknown, "intermittent", unknown::at_rest, &[unknown::intermittent]),
    one(Unknown, "wandering_line", unknown::at_rest, &[unknown::wandering_line]),
    one(Unknown, "chirp", unknown::at_rest, &[unknown::chirp]),
    one(Unknown, "modulated_line", unknown::at_rest, &[unknown::modulated_line]),
    one(Unknown, "uneven_flicker", unknown::at_rest, &[unknown::uneven_flicker]),
    one(Unknown, "drifting_levels", unknown::at_rest, &[unknown::drifting_levels]),
    one(
        Unknown,
        "pressure_change_by_temperature",
        unknown::with_weather,
        &[unknown::pressure_change_by_temperature],
    ),
    one(Unknown, "threshold", unknown::with_field, &[unknown::threshold]),
    one(Unknown, "swelling_noise", unknown::at_rest, &[unknown::swelling_noise]),
    one(Unknown, "motion_memory", unknown::on_table, &[unknown::motion_memory]),
    one(Unknown, "aftershocks", unknown::at_rest, &[unknown::aftershocks]),
    one(Unknown, "heavy_impulses", unknown::at_rest, &[unknown::heavy_impulses]),
    one(Unknown, "one_sided_gusts", unrecorded::nothing_recorded, &[unknown::one_sided_gusts]),
];

/// Name of the subject of missing rows.
pub const DROPPED: &str = "dropped_samples";
/// Name of nulls.
pub const NULL: &str = "null";

/// Names of the subjects of a family.
pub fn names(family: Family) -> Vec<&'static str> {
    let mut names: Vec<&str> = SUBJECTS.iter().filter(|s| s.family == family).map(|s| s.name).collect();
    match family {
        Table => names.push(DROPPED),
        Null => names.push(NULL),
        _ => {}
    }
    names
}

/// The half to which a case belongs: even seeds are development; of unknown physics, every second kind.
pub fn half(name: &str, seed: u64) -> Half {
    let kind = SUBJECTS.iter().filter(|s| s.family == Unknown).position(|s| s.name == name);
    let even = kind.map_or(seed.is_multiple_of(2), |place| place.is_multiple_of(2));
    if even { Half::Development } else { Half::HeldOut }
}

/// Seeds of a number of cases of a half; none for unknown physics of the other half.
pub fn seeds(name: &str, half: Half, count: u64, first: u64) -> Vec<u64> {
    // Where a half takes every second seed, twice as many are enough.
    let of_half = (first..first + 2 * count).filter(|seed| self::half(name, *seed) == half);
    of_half.take(count as usize).collect()
}
