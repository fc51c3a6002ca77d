//! The tables of a procedure file.

pub(crate) mod acceleration;
pub(crate) mod conditions;
pub(crate) mod derived;
pub(crate) mod influence;
pub mod interim;
pub mod limits;
pub(crate) mod noise;
pub mod phases;
pub(crate) mod rate_table;
pub(crate) mod start_up;
pub mod temperature;
pub(crate) mod transfer;
pub(crate) mod vibration;

use super::bench::Bench;
use super::model::{Analysis, ExplainSpec, Instrument, MeasurandKeys, ReportSpec, UnitSpec, Waiver};
use super::section::Section;
use super::site::Site;
use super::thermometer_pair::ThermometerPairKeys;
use crate::config::external::ExternalKeys;
use crate::config::program::ProgramKeys;
use crate::config::recording_keys::RecordingKeys;
use crate::config::spec::{TableSpec, Word};
use crate::config::table::{Table, words};
use crate::i18n::LocalText;
use crate::record::ClauseRecord;
use crate::recording::{ColumnRef, Role};
use crate::units::Unit;
use acceleration::AccelerationKeys;
use conditions::{Conditions, Exclusion};
use derived::{DerivedKeys, DerivedLimitKeys};
use influence::{InfluenceKeys, MagneticKeys, RepeatabilityKeys, SupplyKeys, VibrationKeys};
use interim::InterimKeys;
use limits::{LimitKeys, ReferenceKeys, TypicalValues};
use noise::NoiseKeys;
use rate_table::RateTableKeys;
use sagnac_ingest::StampWriting;
use start_up::StartUpKeys;
use temperature::{TemperatureKeys, WarmUpKeys};
use transfer::TransferKeys;
use vibration::VibrationSpectrumKeys;

/// Roles a channel may have, with their meaning.
pub const CHANNEL_ROLES: &[Word] = &[
    ("time", "time stamps"),
    ("rate", "angular rate about an input axis"),
    ("angle_increment", "angle turned during the sample interval, or counts of it"),
    ("accumulated_angle", "angle turned since the beginning; its differences are the rate"),
    ("temperature", "a temperature"),
    ("table_rate", "rate of the table about the input axis"),
    ("table_angle", "angle of the table"),
    ("outer_rate", "rate of the table's other axis"),
    ("supply", "supply voltage"),
    ("magnetic_field", "magnetic field"),
    ("vibration", "vibration: rms of the acceleration"),
    ("acceleration_x", "acceleration along the x axis of the unit"),
    ("acceleration_y", "acceleration along the y axis of the unit"),
    ("acceleration_z", "acceleration along the z axis of the unit"),
    ("pressure", "pressure around the unit"),
    ("humidity", "relative humidity"),
    ("current", "supply current"),
    ("status", "status word, of which each bit tells a state"),
    ("pps", "pulse of every second, or a count of them"),
    ("counter", "sample counter: grows by one a sample"),
    ("auxiliary", "anything else that is kept beside"),
];

words!(Role, CHANNEL_ROLES, |word: &str| Role::ALL.iter().copied().find(|role| role.id() == word));

/// The procedure file as a whole.
pub static PROCEDURE_FILE: TableSpec = *ProcedureFile::SPEC;

/// A procedure: what is recorded, under which conditions, what is determined from it and by which limits it is
/// judged.
#[derive(Table)]
#[table("", format = "procedure/1")]
pub(in crate::config::procedure) struct ProcedureFile {
    /// Identity of the procedure.
    pub procedure: Identity,
    /// The unit the procedure is for.
    #[key(optional)]
    pub unit_under_test: UnitSpec,
    /// The recording as a whole.
    #[key(optional)]
    pub recording: RecordingTable,
    /// The channels of the recording, one table each.
    #[key(name = "channel", required)]
    pub channels: Vec<ChannelKeys>,
    /// Conditions under which the test is valid.
    #[key(optional)]
    pub conditions: Conditions,
    /// Looks at a growing recording, at which the test may end.
    pub interim: Option<InterimKeys>,
    /// Spans excluded from the evaluation, declared beforehand.
    #[key(name = "exclude")]
    pub exclusions: Vec<Exclusion>,
    /// Where the unit stands and where its input axis points.
    pub site: Option<Site>,
    /// Instruments used, with the validity of their calibration.
    #[key(name = "instrument")]
    pub instruments: Vec<Instrument>,
    /// The bench that the test is made on, where it is checked or must be.
    pub bench: Option<Bench>,
    /// Two thermometers that are compared, one table a pair.
    #[key(name = "thermometer_pair")]
    pub thermometer_pairs: Vec<ThermometerPairKeys>,
    /// A test on a rate table.
    pub rate_table: Option<RateTableKeys>,
    /// Options of the analysis.
    #[key(optional)]
    pub analysis: Analysis,
    /// Comparison of the recording with the model of the unit's family.
    pub explain: Option<ExplainSpec>,
    /// A test of the noise by frequency.
    pub noise_test: Option<NoiseKeys>,
    /// A test over temperature.
    pub temperature_test: Option<TemperatureKeys>,
    /// A test of the warm-up.
    pub warm_up_test: Option<WarmUpKeys>,
    /// A test in positions in the field of gravity.
    pub acceleration_test: Option<AccelerationKeys>,
    /// A test of the transfer function.
    pub transfer_test: Option<TransferKeys>,
    /// A test of the start-up.
    pub start_up_test: Option<StartUpKeys>,
    /// A series of turn-ons.
    pub repeatability_test: Option<RepeatabilityKeys>,
    /// A comparison in a magnetic field.
    pub magnetic_test: Option<MagneticKeys>,
    /// A comparison at several supply voltages.
    pub supply_test: Option<SupplyKeys>,
    /// A comparison under vibration.
    pub vibration_test: Option<VibrationKeys>,
    /// The effects of vibration by frequency.
    pub vibration_spectrum: Option<VibrationSpectrumKeys>,
    /// A comparison under any influence that the procedure declares.
    pub influence_test: Option<InfluenceKeys>,
    /// Quantities to determine, one table each, in the order of the report.
    #[key(name = "measurand", required)]
    pub measurands: Vec<MeasurandKeys>,
    /// Quantities by a formula over others, one table each.
    #[key(name = "derived")]
    pub derived: Vec<DerivedKeys>,
    /// Results of other tests that the report states, one table each.
    #[key(name = "external")]
    pub externals: Vec<ExternalKeys>,
    /// Programs of the user that give rows of their own, one table each.
    #[key(name = "program")]
    pub programs: Vec<ProgramKeys>,
    /// Limits. A limits file may replace them.
    #[key(name = "limit")]
    pub limits: Vec<LimitKeys>,
    /// Limits of quantities by a formula, of results of other tests and of programs of the user. A limits file may replace them.
    #[key(name = "derived_limit")]
    pub derived_limits: Vec<DerivedLimitKeys>,
    /// Published or data-sheet values shown for comparison.
    #[key(name = "reference")]
    pub references: Vec<ReferenceKeys>,
    /// Typical noise of the family, by measurand id: what the power of the limits is computed from.
    #[key(optional)]
    pub expected: TypicalValues,
    /// Clauses of the standard and where each is covered.
    #[key(name = "clause")]
    pub clauses: Vec<ClauseKeys>,
    /// What the report shows.
    #[key(optional)]
    pub report: ReportSpec,
    /// Waivers: recorded next to the verdict, never part of it.
    #[key(name = "waiver")]
    pub waivers: Vec<Waiver>,
}

/// Identity of the procedure, shown in the header of every report.
#[derive(Table)]
#[table("procedure")]
pub(in crate::config::procedure) struct Identity {
    /// Id, also used in the name of the output folder.
    #[key(id, example = "static-bias")]
    pub id: String,
    /// Title of the report.
    #[key(example = "Static bias and noise")]
    pub title: LocalText,
    /// Revision. Change it whenever anything else in the file changes.
    #[key(example = "A")]
    pub revision: String,
    /// Standard followed, with its edition.
    #[key(example = "IEEE Std 952-2020")]
    pub standard: Option<LocalText>,
    /// Clause of the standard.
    #[key(example = "12.11 drift-rate series")]
    pub clause: Option<LocalText>,
    /// Author of the procedure.
    #[key(example = "QA department")]
    pub author: Option<LocalText>,
}

/// The recording as a whole.
#[derive(Table)]
#[table("recording")]
pub(in crate::config::procedure) struct RecordingTable {
    /// Declared sample rate. Required when no channel has the role `time`; otherwise the measured rate is judged
    /// against it.
    #[key(quantity = "Hz", above = 0, example = "10 Hz")]
    pub sample_rate_hz: Option<f64>,
    /// Maximum relative difference between the declared and the measured sample rate.
    #[key(quantity = "1", above = 0, max = 0.5, default = "1 %", example = "0.1 %")]
    pub sample_rate_tolerance: f64,
    #[key(flatten)]
    pub reading: RecordingKeys,
    /// Layout of the records of a raw binary file, relative to the procedure.
    #[key(example = "layouts/logger.toml")]
    pub layout: Option<String>,
    #[key(section)]
    pub section: Section,
}

/// Ways to write time stamps.
pub const STAMP_WRITINGS: &[Word] = &[
    ("iso8601", "date and time with the year first, ISO 8601 or RFC 3339"),
    ("day_first", "date and time with the day first, as in Russia"),
    ("month_first", "date and time with the month first, as in the United States"),
    ("clock", "clock time, which starts again at midnight"),
    ("gps_week_seconds", "seconds of the GPS week, which start again after 604800 s"),
    ("number", "numbers"),
];

words!(StampWriting, STAMP_WRITINGS, |word: &str| match word {
    "iso8601" => Some(StampWriting::Iso8601),
    "day_first" => Some(StampWriting::DayFirst),
    "month_first" => Some(StampWriting::MonthFirst),
    "clock" => Some(StampWriting::Clock),
    "gps_week_seconds" => Some(StampWriting::GpsWeekSeconds),
    "number" => Some(StampWriting::Number),
    _ => None,
});

/// One channel: a column of the recording and its role.
#[derive(Table)]
#[table("channel")]
pub(crate) struct ChannelKeys {
    /// Id of the channel in this procedure and in results.
    #[key(id, required, example = "rate")]
    pub id: Option<String>,
    /// Column: its name in the header, or its position counted from 1.
    #[key(required, example = "rate_deg_h")]
    pub column: Option<ColumnRef>,
    /// What the channel measures.
    #[key(required, example = "rate")]
    pub role: Option<Role>,
    /// Unit of the numbers in the file; `count` together with `scale`.
    #[key(required, example = "deg/h")]
    pub unit: Option<Unit>,
    /// Size of one `unit` of the file: a number with unit. The product with `unit` must suit the role.
    #[key(example = "0.01 arcsec/count")]
    pub scale: Option<String>,
    /// True if the channel has the opposite sign; its values are negated.
    #[key(default = false, example = true)]
    pub reversed: bool,
    /// Timestamp format of a text file, for the role `time`; detected if omitted. Timestamps are converted to
    /// seconds, so `unit` is "s".
    #[key(example = "day_first")]
    pub stamp: Option<StampWriting>,
    /// Column of the dates that belong to the clock times in `column`, for the role `time`.
    #[key(example = "date")]
    pub date_column: Option<ColumnRef>,
    /// Column of the GPS weeks that belong to the seconds of week in `column`, for the role `time`.
    #[key(example = "gps_week")]
    pub week_column: Option<ColumnRef>,
    /// Lower rail of the channel: samples at or below it count as saturated.
    #[key(unit_of = "role", example = "-400 deg/s")]
    pub rail_low: Option<f64>,
    /// Upper rail of the channel: samples at or above it count as saturated.
    #[key(unit_of = "role", example = "400 deg/s")]
    pub rail_high: Option<f64>,
    /// Period after which timestamps or a counter restart, such as "86400 s" for time of day or "256 count" for an
    /// 8-bit counter. Common periods are detected if no sample is missing at the restart.
    #[key(example = "86400 s")]
    pub rollover: Option<String>,
    /// False for an optional column.
    #[key(default = true, example = false)]
    pub required: bool,
    #[key(section)]
    pub section: Section,
}

/// A clause of the standard and where it is covered.
#[derive(Table)]
#[table("clause")]
pub(in crate::config::procedure) struct ClauseKeys {
    /// Number of the clause.
    #[key(example = "12.11")]
    clause: LocalText,
    /// Its title.
    #[key(example = "Drift-rate series")]
    title: LocalText,
    /// Where it is covered.
    #[key(choice = CLAUSE_STATUS, example = "here")]
    status: &'static str,
    /// Details, or the reason why not.
    #[key(example = "bias and random drift")]
    note: Option<LocalText>,
}

const CLAUSE_STATUS: &[Word] = &[
    ("here", "dealt with by this procedure"),
    ("elsewhere", "dealt with by another procedure"),
    ("not_applicable", "does not apply to this unit"),
];

impl From<ClauseKeys> for ClauseRecord {
    fn from(keys: ClauseKeys) -> ClauseRecord {
        let ClauseKeys { clause, title, status, note } = keys;
        ClauseRecord {
            clause,
            title,
            status: status.to_owned(),
            note: note.unwrap_or_default(),
            rows: vec![],
        }
    }
}
