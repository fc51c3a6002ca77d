//! Conditions of a test, judged from the recording. One file a condition; adding one is one file and one line in
//! [`ALL_CONDITIONS`].
//!
//! A condition is met only when it is shown to be met, the sensor's uncertainty included. One that is not makes the
//! whole indeterminate: a test that was not done right neither passes nor fails a unit.

mod bench;
pub mod checks;
mod clock;
mod duration;
mod earth_rate;
pub mod evidence;
mod facts;
mod faults;
pub mod influence;
mod instruments;
mod noise_level;
mod output;
mod plausibility;
pub mod positions;
mod range;
mod sample_rate;
mod schedule;
mod stability;
pub mod stability_track;
mod stationarity;
mod status;
pub mod status_track;
pub mod table;
mod tails;
pub mod thermometer;
mod unit_named;
mod unit_slip;
mod units;
mod warm_up;

pub use facts::{BiasStep, ColumnFact, Condition, Facts, GyroFact, NoiseChange, WarmUpFact};

use crate::record::ConditionRecord;

/// Every condition, in the order of the report.
pub static ALL_CONDITIONS: &[&dyn Condition] = &[
    &unit_named::UnitNamed,
    &units::Units,
    &clock::Clock,
    &earth_rate::EarthRate,
    &noise_level::NoiseLevel,
    &stability::Temperature,
    &schedule::Schedule,
    &stability::Supply,
    &range::Range,
    &status::Status,
    &duration::Duration,
    &warm_up::WarmUp,
    &sample_rate::SampleRate,
    &stationarity::Stationarity,
    &tails::Tails,
    &output::Output,
    &faults::Faults,
    &instruments::Instruments,
    &bench::ReleasedBench,
];

/// Judges every condition that the procedure asks for.
pub fn judge_all(facts: &Facts<'_>) -> Vec<ConditionRecord> {
    ALL_CONDITIONS.iter().flat_map(|c| c.judge(facts)).collect()
}
