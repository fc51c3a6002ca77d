//! Monte Carlo studies: what the program states of simulated units, set against their truth.
//!
//! A study is one module with a [`study::Study`], and one line in [`STUDIES`]. `cargo xtask validate` runs them and writes
//! `docs/validation/`. Short versions with fixed seeds run with `cargo test`; they use the same functions.

pub mod allan_intervals;
pub mod bench;
pub mod bench_checks;
pub mod comparison;
pub mod coverage;
pub mod disturbances;
pub mod edges;
pub mod false_lines;
pub mod goodness_of_fit;
pub mod identification;
pub mod index;
pub mod influence;
pub mod interim;
pub mod joint;
pub mod laboratory;
pub mod lot_bounds;
pub mod noticeable;
pub mod pages;
pub mod planned;
pub mod predicted_power;
pub mod rate_table;
pub mod record_lengths;
pub mod results;
pub mod sibling_alarms;
pub mod single_samples;
pub mod study;
pub mod thermal;
pub mod two_laboratories;
pub mod whole_runs;

use study::Study;

/// Every study, in the order of the summary.
pub static STUDIES: &[&Study] = &[
    &allan_intervals::STUDY,
    &whole_runs::INTERVALS,
    &whole_runs::LINES,
    &false_lines::STUDY,
    &predicted_power::STUDY,
    &record_lengths::STUDY,
    &goodness_of_fit::STUDY,
    &comparison::STUDY,
    &comparison::PUBLISHED,
    &influence::STUDY,
    &thermal::INTERVALS,
    &thermal::AMBIGUITY,
    &thermal::warm_up::STUDY,
    &rate_table::intervals::STUDY,
    &rate_table::tilts::STUDY,
    &rate_table::KNOWN_INPUTS,
    &rate_table::zones::DEAD_ZONES,
    &rate_table::zones::ROUNDED,
    &single_samples::false_finds::STUDY,
    &single_samples::DETECTION,
    &edges::DECLARED,
    &edges::FREQUENCY,
    &edges::GRAVITY,
    &edges::INFLUENCE,
    &edges::NOISE,
    &edges::NOISE_BANDS,
    &edges::OVERLOAD,
    &edges::RATE_TABLE,
    &edges::SMALL_RATES,
    &edges::SOAKS,
    &edges::START_UP,
    &edges::TEMPERATURE,
    &edges::TILTS,
    &edges::VIBRATION,
    &disturbances::STUDY,
    &identification::STUDY,
    &identification::sample_rates::STUDY,
    &identification::flicker_or_markov::STUDY,
    &laboratory::study::STUDY,
    &laboratory::real_noise::STUDY,
    &planned::STUDY,
    &noticeable::STUDY,
    &joint::STUDY,
    &lot_bounds::STUDY,
    &sibling_alarms::STUDY,
    &interim::STUDY,
    &two_laboratories::STUDY,
    &bench_checks::STUDY,
];
