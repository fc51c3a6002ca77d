//! Analysis of precision gyroscopes: noise, tests, measured quantities, effects, simulation.
//!
//! Samples go in; estimates with their confidence distribution come out. The crate opens no file, reads no clock and
//! writes no sentence: file formats are in `sagnac-ingest`, procedures, reports and languages in `sagnac`.
//!
//! | you have | you want | go to |
//! |---|---|---|
//! | samples at rest | σ(τ) | [`noise::allan::allan_deviation`], [`noise::allan::AllanAccumulator`] |
//! | | an averaged spectrum | [`noise::welch::WelchAccumulator`] |
//! | | N, B, K, R, Q and other terms with intervals | [`noise::digest::RateAccumulator`], then [`noise::spectral_record::SpectralRecord`] |
//! | an evidence by frequency | the same | [`noise::identification::identify`] |
//! | a noise model | a record that has it | [`noise::simulate::Simulator`] |
//! | values of the units of a lot | their median, spread and tolerance bounds | [`lot::population::Population`] |
//! | an estimate and a limit | a verdict with its risk | [`estimate::judge`] |
//! | a claim and a recording | why they differ | [`mismatch`] |
//!
//! Modules, from the ground up; each uses those above it only:
//!
//! | module | what it has |
//! |---|---|
//! | [`message`], [`numeric`], [`units`], [`estimate`], [`figure`], [`recording`] and others | those of [`sagnac_base`], re-exported: messages, numerical methods, units, estimates and verdicts, plots as data, blocks of samples |
//! | [`lot`] | the population that the units of a lot come from |
//! | [`noise`] | a gyro at rest: Allan family, spectra, identification of noise terms, their simulation |
//! | [`rate_table`], [`temperature`], [`influence`] | tests on a rate table, over temperature, under an influence |
//! | [`effect`] | the catalogue of physical effects that a simulation can omit |
//! | [`claim`], [`series`] | a simulation as its author states it; a recording held in memory |
//! | [`schedule`] | what chamber and table do in a test |
//! | [`mismatch`], [`simulate`] | why a recording departs from a claim; recordings made from a claim |
//! | [`plan`] | the next test: which schedule tells the explanations that are left apart |
//! | [`evidence`] | what each kind of test leaves behind |
//! | [`criticism`] | checks of what was fitted against its record |
//! | [`measurand`] | measured quantities of every kind of test: one registry, one file each |
//!
//! Nothing here panics on any input: what cannot be computed is `None`, an error, or an estimate without a value.

pub use sagnac_base::{
    estimate, figure, local_text, message, note, numeric, recording, render, spelling, units, visible,
};
pub use sagnac_explain::{claim, effect, mismatch, plan, schedule, series, simulate};
pub use sagnac_noise::noise;

mod c_header;
pub mod criticism;
pub mod evidence;
pub mod formula;
pub mod influence;
pub mod lot;
pub mod measurand;
pub mod rate_table;
pub mod start_up;
pub mod temperature;
