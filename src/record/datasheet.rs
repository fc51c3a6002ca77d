//! The data sheet of a lot, as `datasheet.json` holds it.

use super::{Message, Program};
use crate::estimate::{Interval, UpperLimit, Verdict};
use crate::i18n::LocalText;
use serde::{Deserialize, Serialize};

/// Version of the format of a data sheet.
pub const DATASHEET_FORMAT: &str = "datasheet/1";

/// A whole data sheet.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DataSheet {
    /// Always `datasheet/1`.
    pub format: String,
    /// The program that wrote this.
    pub program: Program,
    /// When, RFC 3339, UTC.
    pub made_at: String,
    /// Reader of its pages; absent for the engineer.
    #[serde(default, skip_serializing_if = "SheetAudience::is_engineer")]
    pub audience: SheetAudience,
    /// Title that a sheet file gives.
    #[serde(flatten, with = "super::local::title")]
    #[cfg_attr(feature = "schema", schemars(with = "super::local::title::Members<Option<String>>"))]
    pub title: Option<LocalText>,
    /// Model of the units; absent where no result names one.
    pub model: Option<String>,
    /// The procedure that every unit was tested by.
    pub procedure: SheetProcedure,
    /// Units that count.
    pub units: usize,
    /// Lots that they are of; units without a lot are of one.
    pub lots: usize,
    /// What must be known of the sheet as a whole.
    pub notes: Vec<Message>,
    /// Under which conditions the values were measured, as far as the results tell.
    pub conditions: Vec<SheetCondition>,
    /// The quantities, in the order of the first result.
    pub quantities: Vec<SheetQuantity>,
    /// Russian beside Allan values.
    pub pairs: Vec<SheetPair>,
    /// σ(τ) of the lot, by channel.
    pub curves: Vec<SheetCurve>,
    /// Bias over temperature of the lot, where results have compensation tables beside them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub temperature_curves: Vec<SheetTemperatureCurve>,
    /// The results that count, each with its hash.
    pub results: Vec<SheetResult>,
}

/// Reader of the pages of a sheet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum SheetAudience {
    /// Who tests the units: every detail.
    #[default]
    Engineer,
    /// Who buys them: one page, with the details as its annex.
    Customer,
}

impl SheetAudience {
    /// True for the reader that a sheet has where it names none.
    pub fn is_engineer(&self) -> bool {
        *self == SheetAudience::Engineer
    }
}

/// Identity of a procedure.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SheetProcedure {
    /// Id.
    #[serde(default)]
    pub id: String,
    /// Revision; several are joined by commas.
    #[serde(default)]
    pub revision: String,
}

/// A condition with what the results tell of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SheetCondition {
    /// Id: `duration_s`, `warm_up_s`, `temperature_degC`, `sample_rate_hz`. Its unit stands in it.
    pub id: String,
    /// Smallest of all units.
    pub from: f64,
    /// Largest.
    pub to: f64,
    /// How many units tell it.
    pub units: usize,
}

/// A scale on which units scatter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum SheetScale {
    /// The natural logarithm.
    Log,
    /// The value itself.
    Linear,
}

/// One quantity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SheetQuantity {
    /// Measurand.
    pub id: String,
    /// Channel.
    pub channel: String,
    /// Phase that it is of, in a test of several.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub phase: Option<String>,
    /// Name that a sheet file gives it.
    #[serde(flatten, with = "super::local::name")]
    #[cfg_attr(feature = "schema", schemars(with = "super::local::name::Members<Option<String>>"))]
    pub name: Option<LocalText>,
    /// Footnote that a sheet file gives it.
    #[serde(flatten, with = "super::local::footnote")]
    #[cfg_attr(feature = "schema", schemars(with = "super::local::footnote::Members<Option<String>>"))]
    pub footnote: Option<LocalText>,
    /// Unit.
    pub unit: String,
    /// Units that count, bounded ones among them.
    pub units: usize,
    /// Lots that they are of.
    pub lots: usize,
    /// Units of which the quantity is only bounded.
    pub bounded: usize,
    /// How it was read in every result, as in their `method`; absent where results differ or do not say.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reading: Option<String>,
    /// Scale of the spread.
    pub scale: SheetScale,
    /// Median of the true values; absent where it cannot be told.
    pub typical: Option<SheetTypical>,
    /// Spreads; absent with the median.
    pub spread: Option<SheetSpread>,
    /// Bounds for a proportion of the population.
    pub bounds: Vec<SheetBound>,
    /// The largest value measured (of signed quantities the furthest from zero).
    pub largest: Option<SheetLargest>,
    /// Bounds for measured values that more units would promise, if median and spread stayed as they are.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub outlook: Vec<SheetOutlook>,
    /// Share of units whose true value lies above the upper bound for measured values, the limit that is proposed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub share_above_bound: Option<SheetShare>,
    /// The limit of the results, where they have the same.
    pub limit: Option<SheetLimit>,
    /// Risks of its upper limit, for tests of some lengths.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub risks: Vec<SheetRisk>,
    /// The probability that a normal sample fits worse on this scale; absent where it was not judged.
    pub normality: Option<f64>,
    /// What was measured of each unit.
    pub values: Vec<SheetValue>,
    /// What must be known with the quantity.
    pub notes: Vec<Message>,
}

/// The median of the true values of the population.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SheetTypical {
    /// Estimate.
    pub value: f64,
    /// Interval.
    pub interval: Interval,
}

/// Standard deviations on the scale of the quantity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SheetSpread {
    /// Of true values of units of one lot.
    pub between_units: f64,
    /// Of the means of lots; `null` where there are too few.
    pub between_lots: Option<f64>,
    /// Of the measurement: root mean square of the standard uncertainties.
    pub measurement: f64,
}

/// What a bound is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum SheetOf {
    /// True values.
    True,
    /// Values as a test will give them.
    Measured,
}

/// Where a bound lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum SheetSide {
    /// Values lie at or below it.
    Upper,
    /// Values lie at or above it.
    Lower,
}

/// A bound for a proportion of the population.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SheetBound {
    /// True or measured values.
    pub of: SheetOf,
    /// Upper or lower.
    pub side: SheetSide,
    /// The bound.
    pub value: f64,
    /// Proportion of the population.
    pub proportion: f64,
    /// Confidence.
    pub confidence: f64,
    /// `exact_normal`, `normal_with_errors`, `order_statistic`, `hanson_koopmans`.
    pub method: String,
}

/// The largest value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SheetLargest {
    /// Value.
    pub value: f64,
    /// Serial number of its unit.
    pub serial: String,
}

/// A limit that the units were judged by.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SheetLimit {
    /// Lower limit.
    #[serde(default)]
    pub min: Option<f64>,
    /// Upper limit.
    #[serde(default)]
    pub max: Option<f64>,
    /// Percentage of units whose true value lies above the upper limit; absent without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub share_above: Option<SheetShare>,
}

/// The bound that more units would promise.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SheetOutlook {
    /// Number of units.
    pub units: usize,
    /// Upper or lower.
    pub side: SheetSide,
    /// The bound for measured values.
    pub value: f64,
}

/// The risks of an upper limit over the units of the population, a value at or below it being accepted.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SheetRisk {
    /// Length of the test over that of the tests of the lot.
    pub length: f64,
    /// Probability of accepting a unit whose true value lies above the limit.
    pub consumer: f64,
    /// Probability of rejecting a unit whose true value lies at or below it.
    pub producer: f64,
}

/// A share of the population.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SheetShare {
    /// Estimate, between 0 and 1.
    pub value: f64,
    /// Interval.
    pub interval: Interval,
}

/// What was measured of one unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SheetValue {
    /// Serial number.
    pub serial: String,
    /// Lot.
    pub lot: Option<String>,
    /// Value; absent where the quantity is only bounded.
    pub value: Option<f64>,
    /// Its interval.
    pub interval: Option<Interval>,
    /// Bound where there is no value.
    pub upper_limit: Option<UpperLimit>,
}

/// A Russian value beside an Allan one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SheetPair {
    /// Channel.
    pub channel: String,
    /// Measurand of the Russian value.
    pub russian: String,
    /// Its median.
    pub russian_value: f64,
    /// Measurand of the Allan value.
    pub allan: String,
    /// Its median.
    pub allan_value: f64,
    /// Unit of both.
    pub unit: String,
    /// Median of the ratios of single units.
    pub ratio: f64,
    /// Smallest and largest of these ratios.
    pub range: [f64; 2],
    /// Units that have both.
    pub units: usize,
}

/// The overlapping Allan deviation of the lot, deg/h.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SheetCurve {
    /// Channel.
    pub channel: String,
    /// Points of the lot, by averaging time.
    pub points: Vec<SheetPoint>,
    /// The curves of the units.
    pub units: Vec<SheetUnitCurve>,
}

/// One averaging time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SheetPoint {
    /// Averaging time, s.
    pub tau_s: f64,
    /// Units that have it.
    pub units: usize,
    /// Median, deg/h.
    pub median: f64,
    /// 16 % of the units lie below, deg/h.
    pub low: f64,
    /// 84 % lie below, deg/h.
    pub high: f64,
    /// Bound for measured values at this averaging time, with the proportion and confidence of the sheet; deg/h.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bound: Option<f64>,
}

/// Bias over temperature of the units of a lot, of one channel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SheetTemperatureCurve {
    /// Channel.
    pub channel: String,
    /// Points of the lot, by temperature.
    pub points: Vec<SheetTemperaturePoint>,
    /// The curves of the units: temperatures in degC and the bias less its own mean over the common range, deg/h.
    pub units: Vec<SheetUnitCurve>,
}

/// One temperature.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SheetTemperaturePoint {
    /// Temperature, degC.
    pub temperature_deg_c: f64,
    /// Median of the units, deg/h.
    pub median: f64,
    /// 16 % of the units lie below, deg/h.
    pub low: f64,
    /// 84 % lie below, deg/h.
    pub high: f64,
    /// Two-sided tolerance band at this temperature, with the proportion and confidence of the sheet, if units are normal; deg/h.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub band: Option<[f64; 2]>,
}

/// The curve of one unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SheetUnitCurve {
    /// Serial number.
    pub serial: String,
    /// Averaging times in s and deviations in deg/h; or temperatures and biases.
    pub points: Vec<[f64; 2]>,
}

/// A result that counts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SheetResult {
    /// Serial number of the unit.
    pub serial: String,
    /// Lot.
    pub lot: Option<String>,
    /// Verdict of the unit.
    pub verdict: Verdict,
    /// The file as named.
    pub path: String,
    /// SHA-256 of the file.
    pub sha256: String,
}
