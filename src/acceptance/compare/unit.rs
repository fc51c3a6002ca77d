//! One channel of one unit: what is compared.

use crate::estimate::{Interval, UpperLimit, Verdict};
use crate::i18n::Note;
use crate::record::{ComparisonRecord, DeviationRecord, LimitRecord, MeasurandRecord, Message};
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

/// One measured quantity as it stands in a result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Quantity {
    /// Id of the measurand.
    pub id: String,
    /// Channel.
    pub channel: String,
    /// Value; absent where the record cannot show it.
    pub value: Option<f64>,
    /// Unit.
    pub unit: String,
    /// 95 % interval.
    pub interval: Option<Interval>,
    /// Bound where there is no value.
    pub upper_limit: Option<UpperLimit>,
    /// The limit this very quantity was judged by.
    pub limit: Option<Limit>,
    /// What was decided.
    pub verdict: Verdict,
    /// What must be known with the value.
    #[serde(skip)]
    pub notes: Vec<Message>,
}

impl From<&MeasurandRecord> for Quantity {
    fn from(row: &MeasurandRecord) -> Quantity {
        Quantity {
            id: row.id.clone(),
            channel: row.channel.clone(),
            value: row.value,
            unit: row.unit.clone(),
            interval: row.interval,
            upper_limit: row.upper_limit,
            limit: row.limit.as_ref().map(Limit::from),
            verdict: row.verdict,
            notes: row.notes.clone(),
        }
    }
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

/// A limit as a result holds it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Limit {
    /// Lowest value allowed.
    pub min: Option<f64>,
    /// Highest value allowed.
    pub max: Option<f64>,
    /// Unit of both.
    pub unit: String,
    /// File it stands in.
    pub source: String,
}

impl From<&LimitRecord> for Limit {
    fn from(limit: &LimitRecord) -> Limit {
        Limit { min: limit.min, max: limit.max, unit: limit.unit.clone(), source: limit.source.clone() }
    }
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
    /// The quantities of the comparison that the result holds.
    pub quantities: Vec<Quantity>,
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
    /// A quantity by id.
    pub fn quantity(&self, id: &str) -> Option<&Quantity> {
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
