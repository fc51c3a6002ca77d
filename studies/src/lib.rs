//! Monte Carlo studies: what the program states of simulated units, set against their truth.
//!
//! A study is one module with a [`study::Study`], and one line in [`STUDIES`]. `cargo xtask validate` runs them and writes
//! `docs/validation/`. Short versions with fixed seeds run with `cargo test`; they use the same functions.

pub mod allan_intervals;
pub mod comparison;
pub mod false_lines;
pub mod goodness_of_fit;
pub mod index;
pub mod laboratory;
pub mod pages;
pub mod results;
pub mod study;
pub mod whole_runs;

use study::Study;

/// Every study, in the order of the summary.
pub static STUDIES: &[&Study] = &[
    &allan_intervals::STUDY,
    &whole_runs::INTERVALS,
    &whole_runs::LINES,
    &false_lines::STUDY,
    &goodness_of_fit::STUDY,
    &comparison::STUDY,
    &comparison::PUBLISHED,
    &laboratory::study::STUDY,
];
