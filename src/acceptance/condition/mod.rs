//! Conditions of a test, judged from the recording. One file a condition; adding one is one file and one line in
//! [`CONDITIONS`].
//!
//! A condition is met only when it is shown to be met, the sensor's uncertainty included. One that is not makes the
//! whole indeterminate: a test that was not done right neither passes nor fails a unit.

pub mod checks;
mod clock;
mod duration;
mod earth_rate;
pub mod evidence;
mod faults;
mod gyro_fact;
mod held;
pub mod influence;
mod instruments;
mod mistakes;
mod noise_level;
mod output;
mod sample_rate;
mod schedule;
mod steadiness;
mod supply;
pub mod table;
pub mod table_motion;
mod tails;
mod temperature;
pub mod temperature_track;
pub mod thermometer;
mod unit_named;
mod units;
mod warm_up;

pub use gyro_fact::{BiasStep, ColumnFact, GyroFact, NoiseChange, TailShape};

use crate::config::procedure::{EffectiveLimits, Procedure};
use crate::i18n::{Lang, Localize, Note};
use crate::record::{ConditionRecord, ConditionStatus};
use crate::recording::integrity::Integrity;
use crate::temperature::findings::Schedule;
use chrono::NaiveDate;
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use temperature_track::TemperatureFacts;

/// What conditions are judged by.
#[derive(Debug)]
pub struct Facts<'a> {
    /// The procedure.
    pub procedure: &'a Procedure,
    /// Faults of the recording.
    pub integrity: &'a Integrity,
    /// Rows of the recording.
    pub rows: u64,
    /// Measured mean sample interval, s.
    pub sample_interval_s: f64,
    /// What must be known of the time base.
    pub clock_notes: &'a [Note],
    /// True when the interval was measured from stamps.
    pub has_stamps: bool,
    /// Time with usable samples in the evaluated window, s.
    pub usable_s: f64,
    /// Longest gap, s.
    pub longest_gap_s: f64,
    /// Smoothed values of channels that must be held, by channel and position of the condition.
    pub held: &'a BTreeMap<(String, usize), TemperatureFacts>,
    /// Means of consecutive tenths of the first hours of each gyro channel: (channel, residual of the warm-up fit).
    pub warm_up: &'a [WarmUpFact],
    /// Gyro channels in the evaluated window.
    pub gyros: &'a [GyroFact],
    /// Limits and typical values that hold.
    pub limits: &'a EffectiveLimits,
    /// Columns that the channels are read from.
    pub columns: &'a [ColumnFact],
    /// Length of the recording by its stamps, s.
    pub duration_s: f64,
    /// Serial number that the recording states.
    pub stated_serials: &'a [&'a str],
    /// Serial number under which the unit is tested.
    pub serial: Option<&'a str>,
    /// The schedule of a test over temperature, where there is a temperature.
    pub schedule: Option<&'a Schedule>,
    /// Day of the test.
    pub today: NaiveDate,
    /// Where checks tell that they were made, or why not.
    pub checks: &'a checks::CheckLog,
}

/// What is left of a warm-up transient at the start of the evaluated window.
#[derive(Debug, Clone, PartialEq)]
pub struct WarmUpFact {
    /// Channel.
    pub channel: String,
    /// Transient at the start of the window, deg/h.
    pub residual_deg_h: f64,
    /// Its time constant, s.
    pub time_constant_s: f64,
    /// Significance of the transient against the noise of the means, standard deviations.
    pub significance: f64,
    /// Standard uncertainty of the bias of the channel, deg/h.
    pub bias_uncertainty_deg_h: f64,
}

/// One kind of condition.
pub trait Condition: Sync {
    /// Judges it; no record when the procedure does not ask for it.
    fn judge(&self, facts: &Facts<'_>) -> Vec<ConditionRecord>;
}

/// Every condition, in the order of the report.
pub static CONDITIONS: &[&dyn Condition] = &[
    &unit_named::UnitNamed,
    &units::Units,
    &clock::Clock,
    &earth_rate::EarthRate,
    &noise_level::NoiseLevel,
    &temperature::Temperature,
    &schedule::Schedule,
    &supply::Supply,
    &duration::Duration,
    &warm_up::WarmUp,
    &sample_rate::SampleRate,
    &steadiness::Steadiness,
    &tails::Tails,
    &output::Output,
    &faults::Faults,
    &instruments::Instruments,
];

/// Judges every condition.
pub fn judge_all(facts: &Facts<'_>) -> Vec<ConditionRecord> {
    CONDITIONS.iter().flat_map(|c| c.judge(facts)).collect()
}

/// The id of a condition on a channel: the channel is named where there are several.
fn id_of(id: &str, channel: &str, facts: &Facts<'_>) -> String {
    if facts.gyros.len() > 1 { format!("{id}.{channel}") } else { id.to_owned() }
}

/// A record with its sentence in both forms.
fn record(
    id: impl Into<String>,
    status: ConditionStatus,
    observed: &[(&str, f64)],
    requirement: Option<Note>,
    note: Note,
) -> ConditionRecord {
    let observed: Map<String, Value> =
        observed.iter().map(|(name, value)| ((*name).to_owned(), Value::from(*value))).collect();
    ConditionRecord {
        id: id.into(),
        phase: None,
        status,
        evidence: None,
        observed,
        required: requirement.as_ref().map_or_else(String::new, |r| r.say(Lang::En)),
        requirement: requirement.map(Into::into),
        note: note.say(Lang::En),
        message: Some(note.into()),
    }
}
