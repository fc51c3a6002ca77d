//! A procedure after reading: plain values in inside units (deg/h, s, degC, Hz).

use super::diagnostics::{Problem, SourceText, Span};
use super::limit_set::{LimitSet, LimitsFile};
pub use super::section::{Allowance, Taus};
use super::site::Site;
use super::unit_facts::UnitFact;
use crate::i18n::LocalText;
use crate::influence::{ComparisonTest, RepeatabilityTest};
use crate::measurand::Measurand;
use crate::output::sha256;
use crate::record::{
    ClauseRecord, ConditionStatus, ExclusionRecord, InstrumentRecord, ProcedureRecord, WaiverRecord,
};
use crate::recording::Channel;
use crate::signing::Role;
use crate::temperature::{TemperatureTest, WarmUpTest};
use chrono::NaiveDate;
use sagnac_ingest::ReadOptions;
use std::path::PathBuf;
use std::sync::Arc;

/// A file that was read, with what identifies it.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded<T> {
    /// What the file says.
    pub value: T,
    /// Path as given.
    pub path: String,
    /// SHA-256 of the bytes of the file, hexadecimal.
    pub sha256: String,
    /// The text, for later diagnostics.
    pub source: Arc<SourceText>,
    /// Things worth knowing that do not forbid its use.
    pub warnings: Vec<Problem>,
}

/// What is recorded, under which conditions, what is determined from it, by which limits it is judged.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Procedure {
    /// Id, for example `static-bias`.
    pub id: String,
    /// Title of the report.
    pub title: LocalText,
    /// Revision.
    pub revision: String,
    /// Standard followed.
    pub standard: Option<LocalText>,
    /// Clause of the standard.
    pub clause: Option<LocalText>,
    /// Who wrote it.
    pub author: Option<LocalText>,
    /// The unit it is for.
    pub unit_under_test: UnitSpec,
    /// How the recording is read.
    pub recording: RecordingSpec,
    /// Declared sample rate, Hz.
    pub sample_rate_hz: Option<f64>,
    /// Largest relative difference between the declared and the measured sample rate.
    pub sample_rate_tolerance: f64,
    /// Channels, in the order of the file.
    pub channels: Vec<ChannelSpec>,
    /// Conditions of the test.
    pub conditions: Conditions,
    /// Spans left out, declared beforehand.
    pub exclusions: Vec<ExclusionRecord>,
    /// Where the unit stands and its axes point.
    pub site: Option<Site>,
    /// Instruments used.
    pub instruments: Vec<Instrument>,
    /// How a test on a rate table is evaluated; `None`: the unit rests.
    pub rate_table: Option<crate::rate_table::Setup>,
    /// Options of the analysis.
    pub analysis: Analysis,
    /// The model that the recording is explained against.
    pub explain: Option<ExplainSpec>,
    /// A test over temperature.
    pub temperature_test: Option<TemperatureTest>,
    /// A test of the warm-up.
    pub warm_up_test: Option<WarmUpTest>,
    /// A series of switching off and on.
    pub repeatability_test: Option<RepeatabilityTest>,
    /// A comparison without and with an influence.
    pub comparison_test: Option<ComparisonTest>,
    /// What is determined, in the order of the report.
    pub measurands: Vec<MeasurandSpec>,
    /// Limits, references and typical values that stand in the procedure itself.
    pub limits: LimitSet,
    /// Clauses of the standard.
    pub clauses: Vec<ClauseRecord>,
    /// What the report shows.
    pub report: ReportSpec,
    /// Waivers, each for one unit.
    pub waivers: Vec<Waiver>,
}

/// How a recording is read.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RecordingSpec {
    /// Decisions about the file that the procedure makes.
    pub read: ReadOptions,
}

/// The unit a procedure is for.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct UnitSpec {
    /// Family of devices.
    pub family: Option<LocalText>,
    /// Part number.
    pub part: Option<String>,
    /// Revision of the part.
    pub revision: Option<String>,
    /// True when a run without a serial number is an error.
    pub serial_required: bool,
    /// What else must be known of the unit.
    pub requires: Vec<UnitFact>,
}

/// A channel with what the checks of its values need.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelSpec {
    /// Column, role, unit and scale, ready for reading.
    pub channel: Channel,
    /// Unit of the numbers in the file, as written.
    pub unit_in_file: String,
    /// Samples at or below this are saturated; unit of the role inside.
    pub rail_low: Option<f64>,
    /// Samples at or above this are saturated; unit of the role inside.
    pub rail_high: Option<f64>,
    /// Stamps or counts after which the channel starts again: s, or counts.
    pub rollover: Option<f64>,
    /// False when a recording may lack the column.
    pub required: bool,
    /// Where it is declared.
    pub span: Span,
    /// Where its column is named.
    pub column_span: Span,
}

/// Conditions under which a test is valid.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Conditions {
    /// Least usable time, s.
    pub minimum_duration_s: Option<f64>,
    /// Usable time that the limits are to be decided in, s; `None`: the least.
    pub planned_duration_s: Option<f64>,
    /// Time at the beginning that is left out, s.
    pub warm_up_s: f64,
    /// Temperatures to be held.
    pub temperatures: Vec<TemperatureCondition>,
    /// Supply voltages to be held.
    pub supplies: Vec<SupplyCondition>,
    /// Faults that are tolerated.
    pub faults: FaultBudget,
}

/// A temperature that must hold. Shown when |T − nominal| ≤ tolerance − k·u for every smoothed value.
#[derive(Debug, Clone, PartialEq)]
pub struct TemperatureCondition {
    /// Channel judged.
    pub channel: String,
    /// Nominal temperature, degC.
    pub nominal_deg_c: f64,
    /// Largest difference from it, degC.
    pub tolerance_deg_c: f64,
    /// Standard uncertainty of the sensor, degC.
    pub sensor_uncertainty_deg_c: f64,
    /// Multiple k of it by which the tolerance is narrowed.
    pub coverage_factor: f64,
    /// Length of the moving mean, s; 0 for none.
    pub smoothing_s: f64,
}

impl TemperatureCondition {
    /// Largest difference from nominal at which the tolerance is shown to hold, degC: tolerance − k·u.
    pub fn provable_deg_c(&self) -> f64 {
        self.tolerance_deg_c - self.coverage_factor * self.sensor_uncertainty_deg_c
    }
}

/// A supply voltage that must hold, judged as a temperature is.
#[derive(Debug, Clone, PartialEq)]
pub struct SupplyCondition {
    /// Channel judged.
    pub channel: String,
    /// Nominal voltage, V.
    pub nominal_v: f64,
    /// Largest difference from it, V.
    pub tolerance_v: f64,
    /// Standard uncertainty of the reading, V.
    pub sensor_uncertainty_v: f64,
    /// Multiple of it by which the tolerance is narrowed.
    pub coverage_factor: f64,
}

impl SupplyCondition {
    /// Largest difference from nominal at which the tolerance is shown to hold, V: tolerance − k·u.
    pub fn provable_v(&self) -> f64 {
        self.tolerance_v - self.coverage_factor * self.sensor_uncertainty_v
    }
}

/// Faults that are tolerated; `None` is counted and reported, and not judged.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[allow(missing_docs)]
pub struct FaultBudget {
    pub gaps: Option<Allowance>,
    pub missing_samples: Option<Allowance>,
    /// Longest gap, s.
    pub longest_gap_s: Option<f64>,
    pub duplicate_timestamps: Option<Allowance>,
    pub backward_timestamps: Option<Allowance>,
    pub non_finite: Option<Allowance>,
    pub unparsable: Option<Allowance>,
    pub outliers: Option<Allowance>,
    pub saturated: Option<Allowance>,
    pub stuck: Option<Allowance>,
    pub repeated: Option<Allowance>,
    /// Rms deviation of the stamps from a uniform clock, s.
    pub timestamp_jitter_s: Option<f64>,
}

/// An instrument.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Instrument {
    /// What it is.
    pub name: LocalText,
    /// Serial number.
    pub serial: Option<String>,
    /// Last day on which its calibration is valid.
    pub calibration_due: Option<NaiveDate>,
    /// True when it makes the test invalid to use it without a valid calibration.
    pub required: bool,
    /// Where it is declared.
    pub span: Span,
}

impl Instrument {
    /// The record of the instrument with its state on the day of the test.
    ///
    /// A calibration that has run out makes the test invalid where the instrument is required, and is a remark
    /// otherwise; so is one that states no date. The last day of validity counts as valid. A valid date without a
    /// serial number is a remark too: it belongs to no certain instrument.
    pub fn record_on(&self, day: NaiveDate) -> InstrumentRecord {
        let identified = self.serial.as_deref().is_some_and(|s| !s.trim().is_empty());
        let status = match self.calibration_due {
            Some(due) if day > due && self.required => ConditionStatus::Invalid,
            Some(due) if day <= due && identified => ConditionStatus::Ok,
            _ => ConditionStatus::Remark,
        };
        InstrumentRecord {
            name: self.name.clone(),
            serial: self.serial.clone(),
            calibration_due: self.calibration_due.map(|d| d.to_string()),
            status,
        }
    }
}

/// Options of the analysis.
#[derive(Debug, Clone, PartialEq)]
pub struct Analysis {
    /// Averaging times.
    pub taus: Taus,
    /// Every overlapping term at any length.
    pub exact: bool,
    /// Probability that noise alone shows a line anywhere.
    pub line_false_alarm: f64,
}

impl Default for Analysis {
    /// Octaves, a false line in one of a hundred recordings.
    fn default() -> Analysis {
        Analysis { taus: Taus::Octave, exact: false, line_false_alarm: 0.01 }
    }
}

/// The recording against a model.
#[derive(Debug, Clone, PartialEq)]
pub struct ExplainSpec {
    /// The model's file.
    pub model: PathBuf,
    /// Probability at which a correct model is called a mismatch.
    pub alpha: f64,
    /// Most effects that are added.
    pub max_effects: usize,
}

/// Something to be determined.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasurandSpec {
    /// What.
    pub measurand: &'static Measurand,
    /// For which channel; `None`: every gyro channel.
    pub channel: Option<String>,
    /// What is done with the Earth rate (`static_bias`).
    pub earth_rate: EarthRate,
    /// Where it is declared.
    pub span: Span,
}

/// What is done with the Earth rate along the input axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum EarthRate {
    /// It is subtracted, with its uncertainty.
    #[default]
    Remove,
    /// The mean is reported as recorded.
    Keep,
}

/// What a report shows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReportSpec {
    /// Title; `None`: that of the procedure.
    pub title: Option<LocalText>,
    /// Ids of figures in their order; `None`: all.
    pub figures: Option<Vec<&'static str>>,
    /// Whether published values stand beside the measured ones.
    pub show_reference: bool,
    /// Roles that must sign a result, each by a key of its own.
    pub signatures: Vec<Role>,
}

impl Default for ReportSpec {
    /// Every figure, and published values.
    fn default() -> ReportSpec {
        ReportSpec { title: None, figures: None, show_reference: true, signatures: vec![] }
    }
}

impl ReportSpec {
    /// Whether a figure is asked for.
    pub fn shows(&self, figure: &str) -> bool {
        self.figures.as_ref().is_none_or(|list| list.contains(&figure))
    }
}

/// A waiver and the unit it is for.
#[derive(Debug, Clone, PartialEq)]
pub struct Waiver {
    /// Serial number of the unit.
    pub serial: String,
    /// The record that goes into the report of that unit.
    pub record: WaiverRecord,
}

impl<T> Loaded<T> {
    /// The text of the file, byte for byte.
    pub fn text(&self) -> String {
        let text = &self.source.text;
        // A byte order mark is no part of the text, and one of the file.
        if sha256(text.as_bytes()) == self.sha256 { text.clone() } else { format!("\u{feff}{text}") }
    }
}

impl Loaded<Procedure> {
    /// The identity of the procedure as it stands in results.
    pub fn record(&self, limits: Option<&Loaded<LimitsFile>>) -> ProcedureRecord {
        ProcedureRecord {
            id: self.value.id.clone(),
            title: self.value.report.title.as_ref().unwrap_or(&self.value.title).clone(),
            revision: self.value.revision.clone(),
            standard: self.value.standard.clone(),
            clause: self.value.clause.clone(),
            author: self.value.author.clone(),
            path: self.path.clone(),
            sha256: self.sha256.clone(),
            signatures: Some(self.value.report.signatures.iter().map(|role| role.id().to_owned()).collect()),
            limits: limits.map(|file| file.record()),
        }
    }
}

impl Procedure {
    /// The channels that deliver a gyro output, in the order of the file.
    pub fn gyro_channels(&self) -> impl Iterator<Item = &ChannelSpec> {
        self.channels.iter().filter(|c| c.channel.role.is_gyro())
    }

    /// The channel of an id.
    pub fn channel(&self, id: &str) -> Option<&ChannelSpec> {
        self.channels.iter().find(|c| c.channel.id == id)
    }

    /// True when the measurand is determined for the channel.
    pub fn measures(&self, measurand: &str, channel: Option<&str>) -> bool {
        self.measurands.iter().any(|m| {
            m.measurand.id == measurand
                && match (&m.channel, channel) {
                    (Some(own), Some(asked)) => own == asked,
                    _ => true,
                }
        })
    }

    /// The channels, ready for reading a recording.
    pub fn recording_channels(&self) -> Vec<Channel> {
        self.channels.iter().map(|c| c.channel.clone()).collect()
    }

    /// The waivers that are for a unit.
    pub fn waivers_for(&self, serial: Option<&str>) -> Vec<WaiverRecord> {
        self.waivers.iter().filter(|w| Some(w.serial.as_str()) == serial).map(|w| w.record.clone()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_calibration_holds_through_its_last_day() {
        let day = |d| NaiveDate::from_ymd_opt(2027, 3, d).unwrap();
        let mut instrument = Instrument {
            name: "t".into(),
            serial: Some("7".into()),
            calibration_due: Some(day(1)),
            required: true,
            span: 0..0,
        };
        assert_eq!(instrument.record_on(day(1)).status, ConditionStatus::Ok);
        assert_eq!(instrument.record_on(day(2)).status, ConditionStatus::Invalid);
        instrument.serial = Some(" ".into());
        assert_eq!(instrument.record_on(day(1)).status, ConditionStatus::Remark);
        assert_eq!(instrument.record_on(day(2)).status, ConditionStatus::Invalid);
        instrument.required = false;
        assert_eq!(instrument.record_on(day(2)).status, ConditionStatus::Remark);
        instrument.calibration_due = None;
        assert_eq!(instrument.record_on(day(1)).status, ConditionStatus::Remark);
    }

    #[test]
    fn a_share_counts_samples_and_a_count_does_not() {
        assert!(Allowance::Share(0.001).allows(36, 36_000) && !Allowance::Share(0.001).allows(37, 36_000));
        assert!(Allowance::Count(0).allows(0, 5) && !Allowance::Count(0).allows(1, 36_000_000));
        assert_eq!(Allowance::Share(0.001).to_string(), "0.1 %");
    }
}
