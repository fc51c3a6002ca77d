//! One channel of one unit: what is compared.

use crate::estimate::{Interval, UpperLimit};
use crate::i18n::Note;
use crate::record::{ComparisonRecord, DeviationRecord, MeasurandRecord};
use serde::{Deserialize, Serialize};

/// Where a unit's values come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Origin {
    /// A recording that was analysed for the comparison.
    Recording,
    /// A `result.json` that was there.
    Result,
}

/// How bias instability is read off.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum ReadOutRule {
    /// The smallest Allan deviation.
    #[serde(rename = "a")]
    Minimum,
    /// The same over 0.664.
    #[serde(rename = "b")]
    ScaledMinimum,
    /// The fitted B.
    #[serde(rename = "c")]
    FittedB,
    /// 0.664 times the fitted B, its floor in the Allan deviation.
    #[serde(rename = "d")]
    FittedFloor,
}

impl ReadOutRule {
    /// The letter in tables.
    pub fn id(self) -> &'static str {
        match self {
            ReadOutRule::Minimum => "a",
            ReadOutRule::ScaledMinimum => "b",
            ReadOutRule::FittedB => "c",
            ReadOutRule::FittedFloor => "d",
        }
    }
}

/// Bias instability by one rule.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RuleRow {
    /// The rule.
    pub rule: ReadOutRule,
    /// Value, deg/h.
    pub value: Option<f64>,
    /// 95 % interval, deg/h.
    pub interval: Option<Interval>,
    /// Bound where there is no value, deg/h.
    pub upper_limit: Option<UpperLimit>,
    /// σ of 100-s means over it; where only a bound is known, the least that the ratio can be.
    pub ratio: Option<f64>,
    /// 95 % interval of the ratio.
    pub ratio_interval: Option<Interval>,
    /// The ratio the other way, as the founding paper prints it first.
    pub inverse: Option<f64>,
}

/// One channel of one unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Unit {
    /// Serial number, or the name of the file.
    pub name: String,
    /// Channel.
    pub channel: String,
    /// True when the unit has more than one channel here.
    pub several: bool,
    /// File or folder as given.
    pub path: String,
    /// Where the values come from.
    pub origin: Origin,
    /// SHA-256 of the files of the recording.
    pub recording_sha256: Vec<String>,
    /// Usable time of the record, s.
    pub length_s: Option<f64>,
    /// The rows of the result that are compared.
    pub quantities: Vec<MeasurandRecord>,
    /// Allan bias instability under each read-out rule, with the ratios.
    pub rules: Vec<RuleRow>,
    /// The overlapping Allan deviation at octaves, for the figure; empty where the result lacks it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub deviations: Vec<DeviationRecord>,
    /// Window statistics, predictions, octaves, null; absent where the result lacks them.
    pub detail: Option<ComparisonRecord>,
    /// True where the model departs from the record, so that what it predicts is indicative.
    pub indicative: bool,
    /// The findings in sentences, the most important first.
    #[serde(with = "crate::record::message::notes", rename = "says")]
    pub summary: Vec<Note>,
    /// What could not be compared, and why.
    #[serde(with = "crate::record::message::notes")]
    pub missing: Vec<Note>,
}

impl Unit {
    /// The row of a measurand.
    pub fn quantity(&self, id: &str) -> Option<&MeasurandRecord> {
        self.quantities.iter().find(|q| q.id == id)
    }

    /// The value of a quantity.
    pub fn value(&self, id: &str) -> Option<f64> {
        self.quantity(id)?.value
    }

    /// The name with the channel where it has several.
    pub fn label(&self) -> String {
        if self.several { format!("{} · {}", self.name, self.channel) } else { self.name.clone() }
    }
}
