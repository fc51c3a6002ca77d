//! A procedure after reading: plain values in inside units (deg/h, s, degC, Hz).

use super::bench::Bench;
use super::derived_rows::DerivedSpec;
use super::diagnostics::{Problem, SourceText, Span};
pub use super::instrument::Instrument;
use super::interim_plan::InterimPlan;
use super::limit_set::{LimitSet, LimitsFile};
pub use super::section::{Allowance, Taus};
use super::site::Site;
use super::spec::Word;
pub use super::tables::conditions::{
    Bounds, Conditions, FaultBudget, RangeCondition, StatusCondition, SupplyCondition, TemperatureCondition,
};
use super::thermometer_pair::ThermometerPair;
use super::unit_facts::UnitFact;
use crate::config::external::ExternalSpec;
use crate::config::program::ProgramSpec;
use crate::config::table::{Table, words};
use crate::i18n::LocalText;
use crate::influence::{ComparisonTest, RepeatabilityTest};
use crate::measurand::Measurand;
use crate::noise::in_band::NoiseTest;
use crate::output::sha256;
use crate::rate_table::acceleration::AccelerationTest;
use crate::rate_table::transfer::TransferTest;
use crate::record::{ClauseRecord, ExclusionRecord, ProcedureRecord, Signatory, WaiverRecord};
use crate::recording::Channel;
use crate::signing::Role;
use crate::start_up::StartUpTest;
use crate::temperature::{TemperatureTest, WarmUpTest};
use crate::units::Unit;
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

/// A procedure: the recording, its conditions, the quantities determined from it and their limits.
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
    /// Looks at a growing recording; `None`: it is decided at its full duration.
    pub interim: Option<InterimPlan>,
    /// Spans left out, declared beforehand.
    pub exclusions: Vec<ExclusionRecord>,
    /// Where the unit stands and its axes point.
    pub site: Option<Site>,
    /// Instruments used.
    pub instruments: Vec<Instrument>,
    /// The bench that the test is made on, where it is checked or must be.
    pub bench: Option<Bench>,
    /// Thermometers that are compared, in the order of the file.
    pub thermometer_pairs: Vec<ThermometerPair>,
    /// How a test on a rate table is evaluated; `None`: the unit rests.
    pub rate_table: Option<crate::rate_table::Setup>,
    /// Options of the analysis.
    pub analysis: Analysis,
    /// The model that the recording is explained against.
    pub explain: Option<ExplainSpec>,
    /// A test of the noise by frequency.
    pub noise_test: Option<NoiseTest>,
    /// A test over temperature.
    pub temperature_test: Option<TemperatureTest>,
    /// A test of the warm-up.
    pub warm_up_test: Option<WarmUpTest>,
    /// A test in positions in the field of gravity.
    pub acceleration_test: Option<AccelerationTest>,
    /// A test of the transfer function.
    pub transfer_test: Option<TransferTest>,
    /// A test of the start-up.
    pub start_up_test: Option<StartUpTest>,
    /// A series of switching off and on.
    pub repeatability_test: Option<RepeatabilityTest>,
    /// A comparison without and with an influence.
    pub comparison_test: Option<ComparisonTest>,
    /// Quantities to determine, in the order of the report.
    pub measurands: Vec<MeasurandSpec>,
    /// Quantities by a formula, in the order of the file.
    pub derived: Vec<DerivedSpec>,
    /// Results of other tests that the report states, in the order of the file.
    pub externals: Vec<ExternalSpec>,
    /// Programs of the user that give rows of their own, in the order of the file.
    pub programs: Vec<ProgramSpec>,
    /// Limits, references and typical values that stand in the procedure itself.
    pub limits: LimitSet,
    /// Clauses of the standard.
    pub clauses: Vec<ClauseRecord>,
    /// Contents of the report.
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

/// The unit the procedure is for. The serial number is given when the test is run.
#[derive(Debug, Clone, PartialEq, Eq, Table)]
#[table("unit_under_test")]
pub struct UnitSpec {
    /// Family of devices.
    #[key(example = "OIUS-501")]
    pub family: Option<LocalText>,
    /// Part number.
    #[key(example = "501-00-01")]
    pub part: Option<String>,
    /// Revision of the part.
    #[key(example = "C")]
    pub revision: Option<String>,
    /// Whether a run is an error if neither `--serial` nor the recording states a serial number.
    #[key(default = true, example = true)]
    pub serial_required: bool,
    /// What must be known of the unit besides, or a run is an error: from `--lot`, `--unit-data` or the manifest.
    #[key(example = ["lot"])]
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

/// Options of the analysis.
#[derive(Debug, Clone, PartialEq, Table)]
#[table("analysis")]
pub struct Analysis {
    /// Averaging times of the Allan deviation.
    #[key(default = "octave", example = "octave")]
    pub taus: Taus,
    /// Sum every overlapping term at any record length, at the cost of time and memory.
    #[key(default = false, example = true)]
    pub exact: bool,
    /// Probability that noise alone gives a line anywhere in the spectrum.
    #[key(min = 1e-9, max = 0.5, default = 0.01, example = 0.01)]
    pub line_false_alarm: f64,
}

/// Compares the recording with a model: whether the unit behaves like its family, and if not, where it differs and
/// why. The finding is reported next to the verdict and is not part of it.
#[derive(Debug, Clone, PartialEq, Table)]
#[table("explain")]
pub struct ExplainSpec {
    /// The model, a file as `sagnac explain` reads it, relative to the procedure.
    #[key(example = "family.toml")]
    pub model: PathBuf,
    /// Probability of calling a correct model a mismatch.
    #[key(min = 1e-9, max = 0.5, default = 0.01, example = 0.01)]
    pub alpha: f64,
    /// Maximum number of effects added to the model.
    #[key(min = 1, max = 8, default = 3, example = 2)]
    pub max_effects: usize,
}

/// Something to be determined.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasurandSpec {
    /// The quantity.
    pub measurand: &'static Measurand,
    /// For which channel; `None`: every gyro channel.
    pub channel: Option<String>,
    /// Treatment of the Earth rate (`static_bias`).
    pub earth_rate: EarthRate,
    /// Where it is declared.
    pub span: Span,
}

/// A quantity to determine, for one channel or for every gyro channel.
#[derive(Table)]
#[table("measurand")]
pub(super) struct MeasurandKeys {
    /// Id of the measurand.
    #[key(required, example = "angle_random_walk")]
    id: Option<&'static Measurand>,
    /// Channel. Default: every channel with the role `rate` or `angle_increment`.
    #[key(id, example = "x")]
    channel: Option<String>,
    /// Options of the measurand, if it has any.
    #[key(optional)]
    options: MeasurandOptions,
    #[key(span)]
    span: Span,
}

/// Options of a measurand. `earth_rate` belongs to `static_bias`.
///
/// Which measurand takes which stands in the table of measurands.
#[derive(Table)]
#[table("measurand.options")]
pub(super) struct MeasurandOptions {
    /// Treatment of the Earth rate along the input axis. Default: "remove".
    #[key(optional, example = "remove")]
    earth_rate: EarthRate,
}

impl MeasurandKeys {
    /// The quantity to be determined, where its measurand is known.
    pub(super) fn spec(self) -> Option<MeasurandSpec> {
        let MeasurandKeys { id, channel, options, span } = self;
        Some(MeasurandSpec { measurand: id?, channel, earth_rate: options.earth_rate, span })
    }
}

/// Treatments of the Earth rate.
const EARTH_RATE: &[Word] = &[
    ("remove", "the Earth rate is subtracted, with its uncertainty; needs [site]"),
    ("keep", "the mean rate is reported as recorded"),
];

words!(EarthRate, EARTH_RATE, |word: &str| match word {
    "keep" => Some(EarthRate::Keep),
    "remove" => Some(EarthRate::Remove),
    _ => None,
});

/// Treatment of the Earth rate along the input axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum EarthRate {
    /// It is subtracted, with its uncertainty.
    #[default]
    Remove,
    /// The mean is reported as recorded.
    Keep,
}

/// Figures a report may show.
const REPORT_FIGURES: &[Word] = &[
    ("rate", "rate over time with the excluded spans"),
    ("temperature", "temperature over time with its limits"),
    ("sigma_tau", "Allan deviation over averaging time with the fitted terms"),
    ("spectrum", "power spectral density with the lines found"),
    ("allan_family", "modified Allan, Hadamard and total deviation beside the Allan deviation"),
    ("autocorrelation", "autocorrelation of the record and of what the model leaves"),
    ("histogram", "distribution of the samples against the normal one"),
    ("residual", "distribution of what the model leaves against the normal one"),
    ("scale_factor_residual", "residuals of the scale factor over rate, in ppm of full scale"),
    ("scale_over_temperature", "scale factor over temperature, both ways, with the line of least squares"),
    ("table_steps", "rate of the table and residuals of the steps over time"),
    ("dead_zone", "response to rates near zero"),
    ("over_temperature", "bias over temperature, both branches, with the model and its band"),
    ("temperature_schedule", "temperature and its rate over time with the segments"),
    ("temperature_residual", "what the model over temperature leaves, over time"),
    ("temperature_sensitivity", "slope of the bias over temperature"),
    ("warm_up", "bias after switching on with its band"),
    ("bias_of_runs", "bias of every switching-on with its interval"),
    ("influence", "bias of every interval without and with an influence, and over its level"),
    ("positions", "output in every position against the Earth rate"),
    ("gravity", "output in every position in the field of gravity"),
    ("bode", "gain and phase of the response over frequency"),
    ("table_polar", "residual over the angle of the table, as a polar plot"),
];

/// What the report shows.
#[derive(Debug, Clone, PartialEq, Eq, Table)]
#[table("report")]
pub struct ReportSpec {
    /// Title. Default: the title of the procedure.
    #[key(example = "Acceptance report")]
    pub title: Option<LocalText>,
    /// Figures, in this order. Default: all.
    #[key(choice = REPORT_FIGURES, example = ["rate", "sigma_tau"])]
    pub figures: Option<Vec<&'static str>>,
    /// Whether published values are shown in a column next to the measured ones.
    #[key(default = true, example = true)]
    pub show_reference: bool,
    /// Who must sign the result, each by a key of their own; `sagnac verify` asks for it. Default: nobody.
    #[key(example = ["tested", "approved"])]
    pub signatures: Vec<Role>,
    /// Number of the protocol; `{serial}` and `{date}` stand for the serial number and the day of the evaluation.
    #[key(example = "GT-{serial}-{date}")]
    pub protocol: Option<String>,
    /// Organisation that answers for the protocol.
    #[key(example = "Gyro Test Laboratory")]
    pub organisation: Option<LocalText>,
    /// Where the test is made.
    #[key(example = "Hall 4, thermal chamber 2")]
    pub place: Option<LocalText>,
    /// Who signs the printed protocol beside those who tested, reviewed and decided.
    #[key(example = ["quality_control", "customer_representative"])]
    pub signatories: Vec<Signatory>,
}

const SIGNATORIES: &[Word] = &[
    ("quality_control", "quality control of the maker"),
    ("customer_representative", "representative of the customer"),
];

words!(Signatory, SIGNATORIES, |word: &str| Signatory::ALL.into_iter().find(|who| who.id() == word));

const SIGNER_ROLES: &[Word] = &[
    ("tested", "who made the test"),
    ("reviewed", "who checked the result"),
    ("approved", "who decided on the unit"),
];

words!(Role, SIGNER_ROLES, Role::of);

impl ReportSpec {
    /// Whether a figure is asked for.
    pub fn shows(&self, figure: &str) -> bool {
        self.figures.as_ref().is_none_or(|list| list.contains(&figure))
    }
}

/// A decision to accept one unit in spite of a row. It is recorded next to the verdict and never changes it.
#[derive(Debug, Clone, PartialEq, Table)]
#[table("waiver")]
pub struct Waiver {
    /// Serial number of the unit: a waiver is for one unit.
    #[key(example = "0042")]
    pub serial: String,
    /// Measurand or condition concerned.
    #[key(example = "angle_random_walk")]
    pub row: String,
    /// Who decided.
    #[key(example = "J. Smith, quality")]
    pub by: LocalText,
    /// Reason, as shown in the report.
    #[key(example = "used at constant temperature only")]
    pub reason: LocalText,
    /// Date of the decision.
    #[key(example = toml("2026-03-01"))]
    pub date: NaiveDate,
}

impl Waiver {
    /// The waiver as it stands in the report of its unit.
    fn record(&self) -> WaiverRecord {
        WaiverRecord {
            row: self.row.clone(),
            by: self.by.clone(),
            reason: self.reason.clone(),
            date: self.date.to_string(),
        }
    }
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
            organisation: self.value.report.organisation.clone(),
            place: self.value.report.place.clone(),
            signatories: self.value.report.signatories.clone(),
            limits: limits.map(|file| file.record()),
        }
    }
}

impl Procedure {
    /// The number of the protocol of a unit, by the pattern of the procedure; `day` is in ISO 8601.
    pub fn protocol_number(&self, serial: Option<&str>, day: &str) -> Option<String> {
        let pattern = self.report.protocol.as_ref()?;
        Some(pattern.replace("{serial}", serial.unwrap_or_default()).replace("{date}", day))
    }

    /// The channels that deliver a gyro output, in the order of the file.
    pub fn gyro_channels(&self) -> impl Iterator<Item = &ChannelSpec> {
        self.channels.iter().filter(|c| c.channel.role.is_gyro())
    }

    /// True for a test of a unit at rest under constant conditions.
    pub fn is_at_rest(&self) -> bool {
        self.rate_table.is_none()
            && self.temperature_test.is_none()
            && self.warm_up_test.is_none()
            && self.acceleration_test.is_none()
            && self.transfer_test.is_none()
            && self.start_up_test.is_none()
            && self.repeatability_test.is_none()
            && self.comparison_test.is_none()
    }

    /// The unit of a quantity without an entry in the registry and without a formula: a result of another test, the difference of two
    /// thermometers, or what a program of the user gives; `None` for any other.
    pub fn unit_from_elsewhere(&self, id: &str) -> Option<&Unit> {
        let external = self.externals.iter().find(|e| e.id == id).map(|e| &e.unit);
        let pair = || self.thermometer_pairs.iter().find(|p| p.id == id).map(|p| &p.unit);
        let returns = || self.programs.iter().flat_map(|p| &p.returns);
        external.or_else(pair).or_else(|| returns().find(|(own, _)| own == id).map(|(_, unit)| unit))
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
        self.waivers.iter().filter(|w| Some(w.serial.as_str()) == serial).map(Waiver::record).collect()
    }
}
