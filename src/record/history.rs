//! What the results of a store tell over time, as `history --format json` writes it.
//!
//! It depends on the store alone and not on the moment of asking, so that the same store gives the same bytes.

use super::{Message, Program};
use crate::estimate::{Interval, Limits, Verdict};
use crate::lot::share::Share;
use serde::{Deserialize, Serialize};

/// Version of the format of a history.
pub const HISTORY_FORMAT: &str = "history/1";

/// The history of some results.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HistoryRecord {
    /// Always `history/1`.
    pub format: String,
    /// The program that wrote this.
    pub program: Program,
    /// What was asked for.
    pub asked: HistoryAsked,
    /// How many results there are.
    pub counts: HistoryCounts,
    /// Yields, by procedure.
    pub yields: Vec<HistoryYield>,
    /// What kept units from passing, the most frequent first.
    pub reasons: Vec<HistoryReason>,
    /// Verdicts by month.
    pub months: Vec<HistoryMonth>,
    /// Quantities over time.
    pub charts: Vec<HistoryChart>,
    /// Drift of the unit that was asked for.
    pub drifts: Vec<HistoryDrift>,
    /// Stability of the unit that was asked for over days.
    pub stabilities: Vec<HistoryStability>,
    /// Stations set against each other.
    pub stations: Vec<HistoryStation>,
    /// What must be known of the whole.
    pub notes: Vec<Message>,
    /// The results, the earliest first.
    pub results: Vec<HistoryResult>,
}

/// What was asked for; what is absent did not matter.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HistoryAsked {
    /// Serial number.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub serial: Option<String>,
    /// Model.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model: Option<String>,
    /// Lots.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub lots: Vec<String>,
    /// Id of the procedure.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub procedure: Option<String>,
    /// Id of the measurand.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measurand: Option<String>,
    /// Station.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub station: Option<String>,
    /// Earliest day or moment.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub since: Option<String>,
}

/// How many results there are.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HistoryCounts {
    /// All results.
    pub results: usize,
    /// Units that are products.
    pub units: usize,
    /// Reference units.
    pub reference_units: usize,
    /// Results of reference units, which count in no yield.
    pub of_reference_units: usize,
    /// Results that others supersede.
    pub superseded: usize,
    /// Tests that were not done as required: aborted, or with a condition that was not met.
    pub not_done: usize,
    /// Units with a procedure of which the store lacks attempts that later ones name: they count in no yield.
    pub incomplete: usize,
    /// Results of products without a serial number, which count in no yield.
    pub without_serial: usize,
}

/// A counted share with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HistoryShare {
    /// How many there were.
    pub count: usize,
    /// Of how many.
    pub of: usize,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

impl From<Share> for HistoryShare {
    fn from(Share { count, of, low, high }: Share) -> HistoryShare {
        HistoryShare { count, of, low, high }
    }
}

impl HistoryShare {
    /// The share itself.
    pub fn value(&self) -> f64 {
        self.count as f64 / self.of.max(1) as f64
    }
}

/// The yield of a procedure.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HistoryYield {
    /// Id of the procedure.
    pub procedure: String,
    /// Units whose first test passed.
    pub first_pass: HistoryShare,
    /// Units whose last test passed.
    pub last_pass: HistoryShare,
}

/// What kept units from passing.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HistoryReason {
    /// `measurand`, `condition`, `fault` or `error`.
    pub kind: String,
    /// Its id.
    pub name: String,
    /// Results that have it.
    pub results: usize,
    /// Share of all reasons up to this one.
    pub cumulative: f64,
}

/// The verdicts of a month.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HistoryMonth {
    /// Month, such as `2026-03`.
    pub month: String,
    /// Tests of products that were done as required.
    pub tests: usize,
    /// Those of them that passed.
    pub passed: usize,
}

/// What a chart is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum HistoryChartOf {
    /// The first valid test of each unit.
    Process,
    /// The tests of one unit.
    Unit,
    /// The tests of a reference unit at one station.
    Bench,
}

impl HistoryChartOf {
    /// The id used in files and locale tables.
    pub fn id(self) -> &'static str {
        match self {
            HistoryChartOf::Process => "process",
            HistoryChartOf::Unit => "unit",
            HistoryChartOf::Bench => "bench",
        }
    }
}

/// A quantity over time.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HistoryChart {
    /// What it is of.
    pub of: HistoryChartOf,
    /// Serial number of the unit; absent for a process.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub serial: Option<String>,
    /// Station, for a bench.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub station: Option<String>,
    /// The quantity.
    #[serde(flatten)]
    pub quantity: HistoryQuantity,
    /// Limits, where all values have the same.
    pub limit: Option<Limits>,
    /// The values.
    pub points: Vec<HistoryPoint>,
    /// Control limits and what lies beyond; absent for few values.
    pub control: Option<HistoryControl>,
    /// Capability, for a process; absent for few values, or without limits.
    pub capability: Option<HistoryCapability>,
    /// What must be known with it.
    pub notes: Vec<Message>,
}

/// What tells one quantity from another.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HistoryQuantity {
    /// Id of the procedure.
    pub procedure: String,
    /// Id of the measurand.
    pub measurand: String,
    /// Channel.
    pub channel: String,
    /// Phase, in a test of several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub phase: Option<String>,
    /// Unit of the numbers.
    pub unit: String,
}

/// A value in time.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HistoryPoint {
    /// Address of the result.
    pub result: String,
    /// Serial number.
    pub serial: String,
    /// Station.
    pub station: String,
    /// When, RFC 3339.
    pub evaluated_at: String,
    /// Value.
    pub value: f64,
    /// Its interval.
    pub interval: Option<Interval>,
}

/// Control limits.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HistoryControl {
    /// Mean of the values.
    pub center: f64,
    /// Standard deviation between values that follow each other.
    pub observed: f64,
    /// The part of it that the uncertainties of the values do not explain.
    pub process: f64,
    /// Upper limit of the distance between two values that follow each other.
    pub range_limit: f64,
    /// True where nothing lies beyond.
    pub in_control: bool,
    /// For each value.
    pub points: Vec<HistoryControlPoint>,
}

/// Control limits at a value.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HistoryControlPoint {
    /// Distance between the limits and the center; it holds the uncertainty of the value.
    pub reach: f64,
    /// Distance from the value before.
    pub range: Option<f64>,
    /// Exponentially weighted mean.
    pub ewma: f64,
    /// Distance between its limits and the center.
    pub ewma_reach: f64,
    /// Ids of the rules that are broken here.
    pub broken: Vec<String>,
    /// True where the weighted mean is beyond its limits.
    pub ewma_beyond: bool,
}

/// Capability of a process.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HistoryCapability {
    /// Units.
    pub units: usize,
    /// Mean.
    pub mean: f64,
    /// Standard deviation, with that of the measurement.
    pub deviation: f64,
    /// Cp; absent with one limit.
    pub cp: Option<f64>,
    /// Its lower bound at 95 %.
    pub cp_at_least: Option<f64>,
    /// Cpk.
    pub cpk: f64,
    /// Its lower bound at 95 %.
    pub cpk_at_least: f64,
}

/// Drift of a unit over its tests.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HistoryDrift {
    /// The quantity.
    #[serde(flatten)]
    pub quantity: HistoryQuantity,
    /// Tests.
    pub tests: usize,
    /// First moment, RFC 3339.
    pub from: String,
    /// Last moment.
    pub to: String,
    /// Last value less the first.
    pub change: f64,
    /// Half width of its 95 % interval.
    pub change_half_width: f64,
    /// Standard uncertainty that all tests share, which cancels.
    pub common: f64,
    /// Slope of the line through all values, per year.
    pub per_year: Option<f64>,
    /// Half width of its 95 % interval.
    pub per_year_half_width: Option<f64>,
    /// Probability of values as different as these if the unit did not change.
    pub steady_probability: Option<f64>,
}

/// Stability of a unit over days: runs within days. Intervals and bounds hold at 95 %.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HistoryStability {
    /// The quantity.
    #[serde(flatten)]
    pub quantity: HistoryQuantity,
    /// Tests, each a run.
    pub runs: usize,
    /// Days with a test, by the date of their moments.
    pub days: usize,
    /// First moment, RFC 3339.
    pub from: String,
    /// Last moment.
    pub to: String,
    /// Standard deviation of runs of one day; absent where it is not known.
    pub run_deviation: Option<HistoryInterval>,
    /// Standard deviation of days beyond that of their runs; absent where it is not known or may be zero.
    pub day_deviation: Option<HistoryInterval>,
    /// What that is at most, where it may be zero.
    pub day_deviation_at_most: Option<f64>,
    /// Change per month of 30.4375 days; absent where it is not known.
    pub per_month: Option<HistoryInterval>,
    /// Why something is not known.
    pub notes: Vec<Message>,
}

/// A value with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HistoryInterval {
    /// Value.
    pub value: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

/// A station against the others.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HistoryStation {
    /// The quantity.
    #[serde(flatten)]
    pub quantity: HistoryQuantity,
    /// Station; empty where none is stated.
    pub station: String,
    /// Units.
    pub units: usize,
    /// Mean of their values.
    pub mean: f64,
    /// Mean less that of all other stations; absent for few values.
    pub difference: Option<f64>,
    /// Half width of its interval; those of all stations hold together at 95 %.
    pub half_width: Option<f64>,
    /// True where the station differs from the others.
    pub differs: bool,
}

/// A result.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HistoryResult {
    /// Address.
    pub address: String,
    /// Serial number.
    pub serial: String,
    /// Model.
    pub model: String,
    /// Lot.
    pub lot: String,
    /// True for a reference unit.
    pub reference: bool,
    /// Id of the procedure.
    pub procedure: String,
    /// Its revision.
    pub revision: String,
    /// Station.
    pub station: String,
    /// Operator.
    pub operator: String,
    /// When, RFC 3339.
    pub evaluated_at: String,
    /// Number of the attempt.
    pub attempt: u64,
    /// Verdict.
    pub verdict: Verdict,
    /// False where the test was not done as required.
    pub done: bool,
    /// What kept the unit from passing: kind and id.
    pub reasons: Vec<(String, String)>,
    /// Address of the result that counts in its place.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub superseded_by: Option<String>,
    /// Why.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub superseded_because: Option<String>,
}
