//! The tables of a procedure that declare its conditions.

use crate::config::quantity::{self, QuantityError};
use crate::config::section::Allowance;
use crate::config::table::Table;
use crate::i18n::LocalText;
use crate::record::ExclusionRecord;
use crate::recording::Channel;

/// Conditions under which the test is valid. A condition that is not proven to be met makes the verdict
/// indeterminate, because an invalid test neither passes nor fails a unit.
#[derive(Debug, Clone, PartialEq, Table)]
#[table("conditions")]
pub struct Conditions {
    /// Minimum usable time after warm-up, exclusions and gaps.
    #[key(quantity = "s", above = 0, example = "10 h")]
    pub minimum_duration_s: Option<f64>,
    /// Usable time of a record as planned. `sagnac check` examines whether the limits can be decided in it.
    /// Default: `minimum_duration`.
    #[key(quantity = "s", above = 0, example = "100 h")]
    pub planned_duration_s: Option<f64>,
    /// Time excluded at the start, fixed before the data are examined.
    #[key(quantity = "s", min = 0, default = "0 s", example = "30 min")]
    pub warm_up_s: f64,
    /// Temperature to be held, one table per sensor.
    #[key(name = "temperature", one_or_several)]
    pub temperatures: Vec<TemperatureCondition>,
    /// Supply voltage to be held.
    #[key(name = "supply", one_or_several)]
    pub supplies: Vec<SupplyCondition>,
    /// Bounds of other channels.
    #[key(name = "range", one_or_several)]
    pub ranges: Vec<RangeCondition>,
    /// Bits of status words.
    #[key(name = "status", one_or_several)]
    pub statuses: Vec<StatusCondition>,
    /// Maximum number of faults of each kind.
    #[key(optional)]
    pub faults: FaultBudget,
}

/// A temperature that must hold over the whole evaluated window. It holds if every smoothed value lies inside the
/// tolerance minus `coverage_factor` times the sensor's uncertainty.
#[derive(Debug, Clone, PartialEq, Table)]
#[table("conditions.temperature")]
pub struct TemperatureCondition {
    /// Channel with the role `temperature`.
    #[key(id, example = "temp")]
    pub channel: String,
    /// Nominal temperature.
    #[key(quantity = "degC", min = -273.15, max = 1000, example = "20 degC")]
    pub nominal_deg_c: f64,
    /// Maximum difference from it.
    #[key(difference = "degC", above = 0, example = "0.4 degC")]
    pub tolerance_deg_c: f64,
    /// Standard uncertainty (k = 1) of the sensor, calibration and drift included.
    #[key(difference = "degC", min = 0, example = "0.05 degC")]
    pub sensor_uncertainty_deg_c: f64,
    /// Multiple of the sensor's uncertainty by which the tolerance is narrowed.
    #[key(min = 0, max = 4, default = 2.0, example = 2.0)]
    pub coverage_factor: f64,
    /// Length of the moving average applied to the temperature, so that sensor noise is not mistaken for the
    /// chamber.
    #[key(quantity = "s", min = 0, default = "60 s", example = "60 s")]
    pub smoothing_s: f64,
}

impl TemperatureCondition {
    /// Largest difference from nominal at which the tolerance is shown to hold, degC: tolerance − k·u.
    pub fn provable_deg_c(&self) -> f64 {
        self.tolerance_deg_c - self.coverage_factor * self.sensor_uncertainty_deg_c
    }
}

/// A supply voltage that must hold over the whole evaluated window.
#[derive(Debug, Clone, PartialEq, Table)]
#[table("conditions.supply")]
pub struct SupplyCondition {
    /// Channel with the role `supply`.
    #[key(id, example = "supply")]
    pub channel: String,
    /// Nominal voltage.
    #[key(quantity = "V", example = "5 V")]
    pub nominal_v: f64,
    /// Maximum difference from it.
    #[key(difference = "V", above = 0, example = "0.25 V")]
    pub tolerance_v: f64,
    /// Standard uncertainty (k = 1) of the reading.
    #[key(difference = "V", min = 0, default = "0 V", example = "0.01 V")]
    pub sensor_uncertainty_v: f64,
    /// Multiple of that uncertainty by which the tolerance is narrowed.
    #[key(min = 0, max = 4, default = 2.0, example = 2.0)]
    pub coverage_factor: f64,
}

impl SupplyCondition {
    /// Largest difference from nominal at which the tolerance is shown to hold, V: tolerance − k·u.
    pub fn provable_v(&self) -> f64 {
        self.tolerance_v - self.coverage_factor * self.sensor_uncertainty_v
    }
}

/// Bounds that a channel of any role must keep over the whole evaluated window: pressure, humidity, laser power, tilt.
/// The numbers are those of the recording: a unit of the channel's dimension, or none for a channel without a unit.
#[derive(Debug, Clone, PartialEq, Table)]
#[table("conditions.range")]
pub struct RangeCondition {
    /// Channel that is held between the bounds.
    #[key(id, example = "pressure")]
    pub channel: String,
    /// Lowest value allowed.
    #[key(example = "90 kPa")]
    pub min: Option<String>,
    /// Highest value allowed.
    #[key(example = "110 kPa")]
    pub max: Option<String>,
    /// Standard uncertainty (k = 1) of the sensor. Default: none.
    #[key(example = "0.2 kPa")]
    pub sensor_uncertainty: Option<String>,
    /// Multiple of the sensor's uncertainty by which the bounds are narrowed.
    #[key(min = 0, max = 4, default = 2.0, example = 2.0)]
    pub coverage_factor: f64,
    /// Length of the moving average applied to the channel.
    #[key(quantity = "s", min = 0, default = "0 s", example = "60 s")]
    pub smoothing_s: f64,
}

/// A key of a range whose text is no quantity of the dimension of its channel.
#[derive(Debug, Clone, PartialEq)]
pub struct WrongBound {
    /// The key.
    pub key: &'static str,
    /// What is wrong with it.
    pub why: Box<QuantityError>,
}

/// Bounds of a channel in the unit of its values inside the program.
#[derive(Debug, Clone, PartialEq)]
pub struct Bounds {
    /// Lowest value; −∞ where none is stated.
    pub low: f64,
    /// Highest value; ∞ where none is stated.
    pub high: f64,
    /// Standard uncertainty of the sensor.
    pub standard_uncertainty: f64,
    /// The unit.
    pub unit: String,
}

impl RangeCondition {
    /// The bounds for a channel.
    ///
    /// # Errors
    /// The key whose text is no quantity of the dimension of the channel, with the reason.
    pub fn bounds(&self, channel: &Channel) -> Result<Bounds, WrongBound> {
        let unit = channel.role.internal_unit().unwrap_or(channel.unit.text());
        let read = |key: &'static str, text: &Option<String>, difference: bool| match text {
            Some(text) => quantity::parse(text, unit, difference, unit == "1")
                .map(Some)
                .map_err(|why| WrongBound { key, why: Box::new(why) }),
            None => Ok(None),
        };
        Ok(Bounds {
            low: read("min", &self.min, false)?.unwrap_or(f64::NEG_INFINITY),
            high: read("max", &self.max, false)?.unwrap_or(f64::INFINITY),
            standard_uncertainty: read("sensor_uncertainty", &self.sensor_uncertainty, true)?.unwrap_or(0.0),
            unit: unit.to_owned(),
        })
    }
}

/// Bits of a status word that must hold over the whole evaluated window: failure bits are 0, valid-data bits are 1. Masks go up
/// to 2^53 − 1, the largest whole number that the values of a recording hold exactly.
#[derive(Debug, Clone, PartialEq, Table)]
#[table("conditions.status")]
pub struct StatusCondition {
    /// Channel with the role `status`.
    #[key(id, example = "status")]
    pub channel: String,
    /// Bits that tell a failure where they are 1.
    #[key(min = 0, max = 9007199254740991, default = 0.0, example = 240.0)]
    pub failure_mask: f64,
    /// Bits that tell valid data where they are 1.
    #[key(min = 0, max = 9007199254740991, default = 0.0, example = 1.0)]
    pub valid_mask: f64,
    /// Maximum number of samples that break this: a count, or a share of the samples. Default: none.
    #[key(example = "0.01 %")]
    pub allowed: Option<Allowance>,
}

/// Maximum number of faults of each kind: a count, or a share of the samples. An omitted kind is counted and
/// reported, but not judged.
#[derive(Debug, Clone, Copy, PartialEq, Table)]
#[table("conditions.faults")]
pub struct FaultBudget {
    /// Places where samples are missing.
    #[key(example = 10)]
    pub gaps: Option<Allowance>,
    /// Missing samples.
    #[key(example = "0.1 %")]
    pub missing_samples: Option<Allowance>,
    /// Length of the longest gap.
    #[key(quantity = "s", min = 0, example = "10 s")]
    pub longest_gap_s: Option<f64>,
    /// Rows with the same timestamp as the previous one.
    #[key(example = 0)]
    pub duplicate_timestamps: Option<Allowance>,
    /// Rows with an earlier timestamp than a previous one.
    #[key(example = 0)]
    pub backward_timestamps: Option<Allowance>,
    /// Fields that are empty, NaN or infinite.
    #[key(example = "0.01 %")]
    pub non_finite: Option<Allowance>,
    /// Fields that are not numbers.
    #[key(example = 0)]
    pub unparsable: Option<Allowance>,
    /// Samples far outside the surrounding noise.
    #[key(example = "0.1 %")]
    pub outliers: Option<Allowance>,
    /// Samples at a rail.
    #[key(example = 0)]
    pub saturated: Option<Allowance>,
    /// Samples that repeat the previous one for longer than chance allows.
    #[key(example = 0)]
    pub stuck: Option<Allowance>,
    /// Samples in stretches that repeat earlier ones bit for bit, beyond chance.
    #[key(example = 0)]
    pub repeated: Option<Allowance>,
    /// Maximum rms deviation of the timestamps from a uniform clock.
    #[key(quantity = "s", above = 0, example = "1 ms")]
    pub timestamp_jitter_s: Option<f64>,
}

/// A span excluded from the evaluation for a reason known before the data were examined.
#[derive(Debug, Clone, PartialEq, Table)]
#[table("exclude")]
pub struct Exclusion {
    /// Start, from the beginning of the recording.
    #[key(quantity = "s", min = 0, example = "2 h")]
    pub from_s: f64,
    /// End, from the beginning of the recording.
    #[key(quantity = "s", above = 0, example = "2.5 h")]
    pub to_s: f64,
    /// Reason, as shown in the report.
    #[key(example = "door of the chamber opened")]
    pub reason: LocalText,
}

impl From<Exclusion> for ExclusionRecord {
    fn from(exclusion: Exclusion) -> ExclusionRecord {
        let Exclusion { from_s, to_s, reason } = exclusion;
        ExclusionRecord { from_s, to_s, reason }
    }
}
