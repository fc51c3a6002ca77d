//! Facts that conditions are judged by, a condition, and its record.

use super::checks::CheckLog;
use super::stability_track::{StabilityFacts, StabilityKey};
use super::status_track::StatusTrack;
use crate::acceptance::bench::{BenchCheck, OnBench};
use crate::config::procedure::{EffectiveLimits, Procedure};
use crate::i18n::{Lang, Localize, Note};
use crate::noise::tails::TailShape;
use crate::record::{ConditionRecord, ConditionStatus};
use crate::recording::integrity::Integrity;
use crate::temperature::findings::Schedule;
use chrono::NaiveDate;
use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// A thermometer with what it read.
#[derive(Debug, Clone, PartialEq)]
pub struct Thermometer {
    /// Its channel.
    pub channel: String,
    /// Unit declared for it.
    pub unit: String,
    /// Mean of its readings as declared, degC.
    pub mean_deg_c: f64,
    /// Whether something that is asked for rests on it.
    pub counts: bool,
}

/// Facts that conditions are judged by.
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
    /// Statistics of the channels that must stay within a band, by condition.
    pub stability: &'a BTreeMap<StabilityKey, StabilityFacts>,
    /// Status words, one for each condition of them.
    pub statuses: &'a [StatusTrack],
    /// Remainder of a warm-up transient on each gyro channel.
    pub warm_up: &'a [WarmUpFact],
    /// Gyro channels in the evaluated window.
    pub gyros: &'a [GyroFact],
    /// Limits and typical values that hold.
    pub limits: &'a EffectiveLimits,
    /// Thermometers whose readings no stated temperature or course tells.
    pub thermometers: &'a [Thermometer],
    /// Columns that the channels are read from.
    pub columns: &'a [ColumnFact],
    /// Length of the recording by its stamps, s.
    pub duration_s: f64,
    /// Serial number that the recording states.
    pub stated_serials: &'a [&'a str],
    /// Serial number under which the unit is tested.
    pub serial: Option<&'a str>,
    /// True when that is the number that the recording states, since nobody gave one.
    pub serial_of_recording: bool,
    /// The schedule of a test over temperature, where there is a temperature.
    pub schedule: Option<&'a Schedule>,
    /// Day of the test.
    pub today: NaiveDate,
    /// The test on its bench, where the procedure states one.
    pub on_bench: Option<OnBench<'a>>,
    /// The checks of benches that were found; `None` where nobody looked for any.
    pub bench_checks: Option<&'a [BenchCheck]>,
    /// Where each check notes that it was made, or why not.
    pub checks: &'a CheckLog,
}

/// Remainder of a warm-up transient at the start of the evaluated window.
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

/// A gyro channel in the evaluated window.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct GyroFact {
    /// Channel.
    pub channel: String,
    /// Mean, deg/h.
    pub mean_deg_h: f64,
    /// Standard uncertainty of the mean, deg/h.
    pub mean_uncertainty_deg_h: f64,
    /// Earth rate along the input axis with its standard uncertainty, deg/h, where the site is declared.
    pub earth_deg_h: Option<(f64, f64)>,
    /// Sample interval, s.
    pub tau0_s: f64,
    /// Overlapping Allan deviation at octaves: averaging time, s, and deviation, deg/h.
    pub deviations: Vec<(f64, f64)>,
    /// Longest stretch without a gap, s.
    pub longest_stretch_s: f64,
    /// Angle random walk that was identified, deg/sqrt(h).
    pub angle_random_walk: Option<f64>,
    /// Upper end of the 95 % interval of the angle random walk, deg/sqrt(h).
    pub angle_random_walk_high: Option<f64>,
    /// Step of the output, deg/h, where the values lie on a lattice.
    pub quantization_step_deg_h: Option<f64>,
    /// How far the bias moves over temperature, while it warms up, from run to run or between intervals, deg/h, in a test of that.
    pub moves_deg_h: Option<f64>,
    /// The largest step of the mean that noise does not explain.
    pub bias_step: Option<BiasStep>,
    /// A change of the noise between parts of the record.
    pub noise_change: Option<NoiseChange>,
    /// How the values are spread about their local mean, where they are white enough to tell.
    pub tails: Option<TailShape>,
}

/// A step of the mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BiasStep {
    /// Time from the start of the recording, s.
    pub time_s: f64,
    /// Size, deg/h.
    pub size_deg_h: f64,
    /// Size in units of what differences over the same time scatter by.
    pub significance: f64,
}

/// A change of the noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoiseChange {
    /// Largest over smallest scatter of neighbouring samples among the parts.
    pub ratio: f64,
    /// Middle of the part with the largest, s from the start of the recording.
    pub loudest_s: f64,
    /// Middle of the part with the smallest, s from the start of the recording.
    pub quietest_s: f64,
}

/// A column that a channel is read from.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnFact {
    /// Channel.
    pub channel: String,
    /// Name in the file.
    pub name: String,
    /// Unit that the file format declares.
    pub unit: Option<String>,
}

/// One kind of condition.
pub trait Condition: Sync {
    /// Judges it; no record when the procedure does not ask for it.
    fn judge(&self, facts: &Facts<'_>) -> Vec<ConditionRecord>;
}

/// The id of a condition on a channel: the channel is named where there are several.
pub(super) fn id_of(id: &str, channel: &str, facts: &Facts<'_>) -> String {
    if facts.gyros.len() > 1 { format!("{id}.{channel}") } else { id.to_owned() }
}

/// The record of a condition, its sentence both as a key with arguments and in English.
pub(super) fn record(
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
        status,
        observed,
        required: requirement.as_ref().map_or_else(String::new, |r| r.say(Lang::En)),
        requirement: requirement.map(Into::into),
        note: note.say(Lang::En),
        message: Some(note.into()),
        ..ConditionRecord::default()
    }
}
