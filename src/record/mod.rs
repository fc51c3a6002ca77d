//! The run record: everything a report says, in one serialisable value.
//!
//! Clock, host and operator are passed in, so that a run is a pure function of its inputs and a whole report can be
//! compared byte for byte. `result.json` is this value; HTML and Markdown are views of it; nothing is computed in a
//! template.

mod attempt;
mod bench;
mod check;
mod comparison;
mod context;
mod datasheet;
mod day;
mod deviation;
mod evidence;
mod explained;
mod goodness;
mod history;
pub mod integrity;
mod interim;
mod interval_mean;
pub(crate) mod local;
mod lot;
pub(crate) mod message;
mod null_numbers;
mod origin;
mod phase;
mod proof;
pub mod read;
mod rehearsal;
mod siblings;
mod table_step;

pub use attempt::{AttemptRecord, EarlierAttempt};
pub use bench::{BenchCheckRecord, BenchRecord};
pub use check::{CheckRecord, CheckStatus};
pub use comparison::{
    Agreement, CoherentLine, ComparisonRecord, FloorRecord, MinimumRecord, ModelRecord, OctaveRecord,
    OctavesRecord, ParameterRecord, ShareRecord, WindowRecord,
};
pub use context::{ClauseRecord, ExclusionRecord, InstrumentRecord, OptionRecord, WaiverRecord};
pub use datasheet::{
    DATASHEET_FORMAT, DataSheet, SheetAudience, SheetBound, SheetCondition, SheetCurve, SheetLargest,
    SheetLimit, SheetOf, SheetOutlook, SheetPair, SheetPoint, SheetProcedure, SheetQuantity, SheetResult,
    SheetRisk, SheetScale, SheetShare, SheetSide, SheetSpread, SheetTemperatureCurve, SheetTemperaturePoint,
    SheetTypical, SheetUnitCurve, SheetValue,
};
pub use day::{DAY_FORMAT, DayRecord, DayTest, EVENT_FORMAT, HookState, Untested, WatchEvent};
pub use deviation::DeviationRecord;
pub use evidence::Evidence;
pub use explained::ExplainedRecord;
pub use goodness::GoodnessOfFitRecord;
pub use history::{
    HISTORY_FORMAT, HistoryAsked, HistoryCapability, HistoryChart, HistoryChartOf, HistoryControl,
    HistoryControlPoint, HistoryCounts, HistoryDrift, HistoryInterval, HistoryMonth, HistoryPoint,
    HistoryQuantity, HistoryReason, HistoryRecord, HistoryResult, HistoryShare, HistoryStability,
    HistoryStation, HistoryYield,
};
pub use integrity::{FaultRecord, FaultText, Integrity};
pub use interim::{InterimRecord, InterimRow, InterimState};
pub use interval_mean::IntervalMeanRecord;
pub use lot::{LOT_FORMAT, LotCondition, LotFile, LotRecord, LotUnit, SerialSource, VerdictCounts};
pub use message::Message;
pub use origin::{
    ColumnRecord, ExternalResult, LimitsFile, ProcedureRecord, Program, RecordingFile, Session, Signatory,
    UnitUnderTest,
};
pub use phase::PhaseRecord;
pub use proof::{
    ClaimOrigin, CourseRecord, FoundValue, Hidden, HiddenKind, KnownRecord, PROOF_FORMAT, ProofOutcome,
    ProofRecord, ProofRecording, ProtocolStep, RuleRecord,
};
pub use rehearsal::{
    NeededLength, NominalSource, NominalValue, REHEARSAL_FORMAT, RehearsalRecord, RehearsedLength,
    RehearsedLevel, RehearsedRow,
};
pub use siblings::{SiblingQuantity, SiblingsRecord};
pub use table_step::TableStepRecord;

use crate::estimate::{
    Component, Finding, Interval, Judgement, Limits, LowerLimit, Objection, Rule, UpperLimit, Verdict,
};
use crate::i18n::LocalText;
use crate::noise::data::NoiseType;
pub use sagnac_core::mismatch::finding as explanation;
pub use sagnac_core::recording::window::{ExcludedSpan, Window};
use serde::{Deserialize, Serialize};

/// Version of the result format.
pub const RESULT_FORMAT: &str = "result/1";

/// What made a record: an acceptance test by a procedure, or an analysis without one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RunKind {
    /// An acceptance test: conditions, checks and limits of a procedure apply.
    #[default]
    Run,
    /// An analysis: quantities are measured, and no verdict is formed.
    Analyze,
}

/// A whole run.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RunRecord {
    /// Always `result/1`.
    pub format: String,
    /// The program that wrote this.
    pub program: Program,
    /// `run` or `analyze`.
    pub kind: RunKind,
    /// The procedure, absent for `analyze`.
    pub procedure: Option<ProcedureRecord>,
    /// The unit that was tested.
    pub unit_under_test: UnitUnderTest,
    /// Who tested, where, when.
    pub session: Session,
    /// Which test of the unit this is, where a store knows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub attempt: Option<AttemptRecord>,
    /// The unit beside the others of its lot, where a store has enough of them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub siblings: Option<SiblingsRecord>,
    /// The bench, where the procedure checks it or demands that it was checked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bench: Option<BenchRecord>,
    /// The files that were read.
    pub recording: Vec<RecordingFile>,
    /// Worst verdict of all rows and conditions.
    pub verdict: Verdict,
    /// Why the verdict is what it is, in one or more sentences.
    pub summary: Vec<Message>,
    /// Conditions of the test with their evidence.
    pub conditions: Vec<ConditionRecord>,
    /// Checks that a test of this kind could make, and whether they were made.
    pub checks: Vec<CheckRecord>,
    /// The plan of looks that the test may end at, and the look that was evaluated; absent without a plan.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interim: Option<InterimRecord>,
    /// Faults of the recording.
    pub integrity: Integrity,
    /// The part of the recording that was evaluated, and what was left out of it.
    pub window: Window,
    /// Spans that the procedure excludes, with their reasons; absent where it excludes none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub exclusions: Vec<ExclusionRecord>,
    /// Measured quantities.
    pub measurands: Vec<MeasurandRecord>,
    /// Spectral lines that were found.
    pub lines: Vec<LineRecord>,
    /// The noise model that was fitted, per channel.
    pub noise_models: Vec<NoiseModelRecord>,
    /// How well each noise model fits, per channel and view.
    pub goodness_of_fit: Vec<GoodnessOfFitRecord>,
    /// The Allan family at octaves, per channel.
    pub deviations: Vec<DeviationRecord>,
    /// Steps of a test on a rate table, per channel.
    pub table_steps: Vec<TableStepRecord>,
    /// Runs of a series of switching off and on, or intervals without and with an influence, per channel.
    pub interval_means: Vec<IntervalMeanRecord>,
    /// Russian against Allan values, per channel long enough for it; absent in earlier results.
    #[serde(default)]
    pub comparison: Vec<ComparisonRecord>,
    /// What this test can decide: power of each limit.
    pub power: Vec<PowerRecord>,
    /// Instruments that were used.
    pub instruments: Vec<InstrumentRecord>,
    /// Waivers: records beside the verdict, never part of it.
    pub waivers: Vec<WaiverRecord>,
    /// Clauses of the standard and where they are dealt with.
    pub clauses: Vec<ClauseRecord>,
    /// Options that the analysis used, by name.
    pub options: Vec<OptionRecord>,
    /// Figures, by id, in the order of the report.
    pub figures: Vec<FigureRecord>,
    /// The recording against the model of the unit's family, where the procedure asks for it. It is no part of the
    /// verdict.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub explained: Option<ExplainedRecord>,
    /// The phases of a test of several, in their order; `conditions` and `measurands` are those of all of them.
    pub phases: Vec<PhaseRecord>,
    /// Errors that made the verdict `error`.
    pub errors: Vec<Message>,
}

/// State of a condition.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ConditionStatus {
    /// Shown to be met.
    #[default]
    Ok,
    /// Met with a remark, or not decidable without harm.
    Remark,
    /// Not met or not shown: the test was not done right.
    Invalid,
}

/// One condition with its evidence.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(!default))]
pub struct ConditionRecord {
    /// Id, for example `temperature`.
    pub id: String,
    /// Phase that it is of, in a test of several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub phase: Option<String>,
    /// State.
    pub status: ConditionStatus,
    /// How it is known; `null` where nothing tells it.
    pub evidence: Option<Evidence>,
    /// What was found, by name, in the unit of `required`.
    pub observed: serde_json::Map<String, serde_json::Value>,
    /// What was required, as text with unit, English.
    pub required: String,
    /// The same by name.
    pub requirement: Option<Message>,
    /// The sentence that explains the state, English.
    pub note: String,
    /// The same sentence by name.
    pub message: Option<Message>,
}

/// One measurand row.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(!default))]
pub struct MeasurandRecord {
    /// Id, see the contract.
    pub id: String,
    /// Channel.
    pub channel: String,
    /// Phase that it is of, in a test of several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub phase: Option<String>,
    /// Value, `null` where the record cannot show it.
    pub value: Option<f64>,
    /// Unit.
    pub unit: String,
    /// 95 % interval.
    pub interval: Option<Interval>,
    /// Part of the standard uncertainty that all tests on the same equipment at the same site have in common, in the unit of
    /// the value: it does not average out over units. Absent without a value, and where results do not say.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub common_standard_uncertainty: Option<f64>,
    /// Uncertainty budget: the components of the standard uncertainty, largest first. Together they give the interval.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub budget: Vec<Component>,
    /// Whether the record can show the quantity.
    #[serde(default = "is_shown")]
    #[cfg_attr(feature = "schema", schemars(!default))]
    pub identifiable: bool,
    /// Bound where it cannot.
    pub upper_limit: Option<UpperLimit>,
    /// Where the likelihood is largest where it cannot: no claim.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub most_likely: Option<f64>,
    /// Bound from below where it cannot, and where there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lower_limit: Option<LowerLimit>,
    /// How it was obtained.
    pub method: String,
    /// The limit it was judged by.
    pub limit: Option<LimitRecord>,
    /// Published or data-sheet value for comparison.
    pub reference: Option<ReferenceRecord>,
    /// Verdict of this row.
    pub verdict: Verdict,
    /// Distance to the nearest limit, positive inside.
    pub margin: Option<f64>,
    /// Probability that the unit is outside its limit, given what was measured.
    pub specific_risk: Option<f64>,
    /// What must be known with the value.
    pub notes: Vec<Message>,
    /// Checks that contradict the fit that it rests on: with one of them it decides nothing.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub objections: Vec<ObjectionRecord>,
}

/// True for a row that does not say whether the record can show its quantity.
fn is_shown() -> bool {
    true
}

impl MeasurandRecord {
    /// The limits that the row was judged by; without any, both are absent.
    pub fn limits(&self) -> Limits {
        self.limit.as_ref().map(LimitRecord::limits).unwrap_or_default()
    }
}

/// A check that contradicts what was fitted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ObjectionRecord {
    /// Id of the check, for example `allan_curve`.
    pub check: String,
    /// What was found, with its numbers.
    pub found: Message,
    /// What to do.
    pub advice: Message,
}

impl From<&Objection> for ObjectionRecord {
    fn from(objection: &Objection) -> ObjectionRecord {
        let Finding { found, advice, .. } = objection.finding.clone();
        ObjectionRecord { check: objection.check.to_owned(), found: found.into(), advice: advice.into() }
    }
}

/// A limit as applied.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(!default))]
pub struct LimitRecord {
    /// Lower limit.
    pub min: Option<f64>,
    /// Upper limit.
    pub max: Option<f64>,
    /// Unit of both.
    pub unit: String,
    /// Decision rule.
    pub rule: Rule,
    /// Risk the guard band is set for.
    pub risk: f64,
    /// Smallest measured value accepted.
    pub acceptance_min: Option<f64>,
    /// Largest measured value accepted.
    pub acceptance_max: Option<f64>,
    /// File the limit stands in.
    pub source: String,
}

/// A published value set beside the measured one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ReferenceRecord {
    /// Value in the unit of the row.
    pub value: f64,
    /// Where it was published.
    #[serde(flatten, with = "local::source")]
    #[cfg_attr(feature = "schema", schemars(with = "local::source::Members<String>"))]
    pub source: LocalText,
    /// Conventions that apply to the value; absent in earlier results.
    #[serde(flatten, with = "local::note")]
    #[cfg_attr(feature = "schema", schemars(with = "local::note::Members<Option<String>>"))]
    pub note: Option<LocalText>,
}

/// A spectral line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LineRecord {
    /// Channel.
    pub channel: String,
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Resolution of the spectrum at which it was found, Hz.
    pub resolution_hz: f64,
    /// Amplitude of the equivalent sinusoid, deg/h.
    pub amplitude_deg_h: f64,
    /// Power over the local noise floor.
    pub excess: f64,
    /// Probability that noise alone shows such a peak anywhere in the spectrum.
    pub false_alarm_probability: f64,
}

/// A fitted noise model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NoiseModelRecord {
    /// Channel.
    pub channel: String,
    /// Method of the fit.
    pub method: String,
    /// Terms in the model that were claimed.
    pub terms: Vec<NoiseType>,
    /// Angle random walk, deg/sqrt(h).
    pub angle_random_walk: f64,
    /// Flicker coefficient B, deg/h.
    pub bias_instability: f64,
    /// Rate random walk, deg/h/sqrt(h).
    pub rate_random_walk: f64,
    /// Rate ramp, deg/h/h.
    pub rate_ramp: f64,
    /// Quantisation, arcsec.
    pub quantization: f64,
    /// Chi-square like misfit per degree of freedom of the spectrum about the model (1 when the model fits).
    pub misfit: f64,
    /// Probability of a larger misfit if the model is right.
    pub misfit_probability: f64,
    /// Frequency range with the largest misfit, Hz, when the model does not fit.
    pub misfit_band_hz: Option<[f64; 2]>,
    /// Markov processes in the description: standard deviation in deg/h, correlation time in s.
    pub markov: Vec<[f64; 2]>,
    /// Quasi-periodic disturbances in it: rms in deg/h, centre frequency in Hz, coherence time in s.
    pub quasi_periodic: Vec<[f64; 3]>,
    /// Cut-off of the measurement at -3 dB, Hz, where the record shows one.
    pub cutoff_hz: Option<f64>,
    /// What the description holds, rests on and leaves out.
    pub remarks: Vec<Message>,
}

/// Power of one limit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PowerRecord {
    /// Measurand.
    pub id: String,
    /// Channel.
    pub channel: String,
    /// Limit, in the unit of the measurand.
    pub limit: f64,
    /// Unit.
    pub unit: String,
    /// Probability that a unit 1.5 times over the limit would be failed.
    pub power: f64,
    /// Probability that a unit at half the limit would be passed.
    pub pass_probability: f64,
    /// Record length, h, with which the limit could be decided, when this one is too short.
    pub needed_h: Option<f64>,
    /// The same in words.
    pub message: Message,
}

/// A figure of the report.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FigureRecord {
    /// Id, also the stem of the file in `figures/`.
    pub id: String,
    /// File, relative to the result.
    pub file: String,
}

impl LimitRecord {
    /// The limits themselves.
    pub fn limits(&self) -> Limits {
        Limits { min: self.min, max: self.max }
    }

    /// The record of a limit with the acceptance limits of a judgement.
    pub fn new(limit: &crate::estimate::Limit, unit: &str, judgement: &Judgement) -> LimitRecord {
        LimitRecord {
            min: limit.min,
            max: limit.max,
            unit: unit.to_owned(),
            rule: limit.rule,
            risk: limit.risk,
            acceptance_min: judgement.acceptance_min,
            acceptance_max: judgement.acceptance_max,
            source: limit.source.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::effect::Domain;
    use crate::estimate::{ComponentLaw, InputQuantity};
    use crate::noise::model::TERMS;
    use crate::noise::prediction::Agreement;
    use crate::noise::residual::View;
    use crate::recording::Role;

    #[test]
    fn enums_are_written_by_their_ids() {
        let is = |written: serde_json::Value, id: &str| assert_eq!(written, id);
        for input in InputQuantity::ALL {
            is(serde_json::to_value(input).unwrap(), input.id());
            is(serde_json::to_value(input.source()).unwrap(), input.source().id());
            let Some(common) = input.common_to() else { continue };
            is(serde_json::to_value(common).unwrap(), common.id());
        }
        is(serde_json::to_value(ComponentLaw::ChiSquare).unwrap(), ComponentLaw::ChiSquare.id());
        Domain::ALL.iter().for_each(|d| is(serde_json::to_value(d).unwrap(), d.id()));
        View::ALL.iter().for_each(|v| is(serde_json::to_value(v).unwrap(), v.id()));
        Role::ALL.iter().for_each(|r| is(serde_json::to_value(r).unwrap(), r.id()));
        TERMS.iter().for_each(|t| is(serde_json::to_value(t).unwrap(), t.id()));
        for a in [Agreement::Consistent, Agreement::Above, Agreement::Below] {
            is(serde_json::to_value(a).unwrap(), a.id());
        }
    }
}
