//! The tables of a procedure file.

mod conditions;
pub(crate) mod influence;
pub mod limits;
pub mod phases;
pub(crate) mod rate_table;
mod site;
pub mod temperature;

use crate::config::procedure::unit_facts::UnitFact;
use crate::config::recording_keys;
use crate::config::spec::{Kind, Range, TableSpec, Word, optional, quantity, required, with_default};
use conditions::{CONDITIONS, EXCLUDE};
use influence::{MAGNETIC_TEST, REPEATABILITY_TEST, SUPPLY_TEST, VIBRATION_TEST};
use limits::{LIMIT, REFERENCE};
use rate_table::RATE_TABLE;
use site::{INSTRUMENT, SITE};
use temperature::{TEMPERATURE_TEST, WARM_UP_TEST};

/// Roles a channel may have, with their meaning.
pub const ROLES: &[Word] = &[
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
    ("counter", "sample counter: grows by one a sample"),
    ("auxiliary", "anything else that is kept beside"),
];

/// Figures a report may show.
pub const FIGURES: &[Word] = &[
    ("rate", "rate over time with the excluded spans"),
    ("temperature", "temperature over time with its limits"),
    ("sigma_tau", "Allan deviation over averaging time with the fitted terms"),
    ("spectrum", "power spectral density with the lines found"),
    ("allan_family", "modified Allan, Hadamard and total deviation beside the Allan deviation"),
    ("autocorrelation", "autocorrelation of the record and of what the model leaves"),
    ("histogram", "distribution of the samples against the normal one"),
    ("residual", "distribution of what the model leaves against the normal one"),
    ("scale_factor_residual", "residuals of the scale factor over rate, in ppm of full scale"),
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
    ("table_polar", "residual over the angle of the table, as a polar plot"),
];

/// The procedure file as a whole.
pub static PROCEDURE_FILE: TableSpec = TableSpec {
    name: "",
    doc: "A procedure: what is recorded, under which conditions, what is determined from it and by which limits it \
          is judged.",
    keys: &[
        required("format", Kind::Format("procedure/1"), "\"procedure/1\"", "Version of the format."),
        required("procedure", Kind::Table(&PROCEDURE), "", "Identity of the procedure."),
        optional("unit_under_test", Kind::Table(&UNIT_UNDER_TEST), "", "The unit the procedure is for."),
        optional("recording", Kind::Table(&RECORDING), "", "The recording as a whole."),
        required("channel", Kind::Tables(&CHANNEL), "", "The channels of the recording, one table each."),
        optional("conditions", Kind::Table(&CONDITIONS), "", "Conditions under which the test is valid."),
        optional(
            "exclude",
            Kind::Tables(&EXCLUDE),
            "",
            "Spans excluded from the evaluation, declared beforehand.",
        ),
        optional("site", Kind::Table(&SITE), "", "Where the unit stands and where its input axis points."),
        optional(
            "instrument",
            Kind::Tables(&INSTRUMENT),
            "",
            "Instruments used, with the validity of their calibration.",
        ),
        optional("rate_table", Kind::Table(&RATE_TABLE), "", "A test on a rate table."),
        optional("analysis", Kind::Table(&ANALYSIS), "", "Options of the analysis."),
        optional(
            "explain",
            Kind::Table(&EXPLAIN),
            "",
            "Comparison of the recording with the model of the unit's family.",
        ),
        optional("temperature_test", Kind::Table(&TEMPERATURE_TEST), "", "A test over temperature."),
        optional("warm_up_test", Kind::Table(&WARM_UP_TEST), "", "A test of the warm-up."),
        optional("repeatability_test", Kind::Table(&REPEATABILITY_TEST), "", "A series of turn-ons."),
        optional("magnetic_test", Kind::Table(&MAGNETIC_TEST), "", "A comparison in a magnetic field."),
        optional("supply_test", Kind::Table(&SUPPLY_TEST), "", "A comparison at several supply voltages."),
        optional("vibration_test", Kind::Table(&VIBRATION_TEST), "", "A comparison under vibration."),
        required(
            "measurand",
            Kind::Tables(&MEASURAND),
            "",
            "Quantities to determine, one table each, in the order of the report.",
        ),
        optional("limit", Kind::Tables(&LIMIT), "", "Limits. A limits file may replace them."),
        optional(
            "reference",
            Kind::Tables(&REFERENCE),
            "",
            "Published or data-sheet values shown for comparison.",
        ),
        optional(
            "expected",
            Kind::QuantityMap,
            "",
            "Typical noise of the family, by measurand id: what the power of the limits is computed from.",
        ),
        optional("clause", Kind::Tables(&CLAUSE), "", "Clauses of the standard and where each is covered."),
        optional("report", Kind::Table(&REPORT), "", "What the report shows."),
        optional(
            "waiver",
            Kind::Tables(&WAIVER),
            "",
            "Waivers: recorded next to the verdict, never part of it.",
        ),
    ],
};

pub(crate) static PROCEDURE: TableSpec = TableSpec {
    name: "procedure",
    doc: "Identity of the procedure, shown in the header of every report.",
    keys: &[
        required("id", Kind::Id, "\"static-bias\"", "Id, also used in the name of the output folder."),
        required("title", Kind::LocalText, "\"Static bias and noise\"", "Title of the report."),
        required(
            "revision",
            Kind::Text,
            "\"A\"",
            "Revision. Change it whenever anything else in the file changes.",
        ),
        optional(
            "standard",
            Kind::LocalText,
            "\"IEEE Std 952-2020\"",
            "Standard followed, with its edition.",
        ),
        optional("clause", Kind::LocalText, "\"12.11 drift-rate series\"", "Clause of the standard."),
        optional("author", Kind::LocalText, "\"QA department\"", "Author of the procedure."),
    ],
};

pub(crate) static UNIT_UNDER_TEST: TableSpec = TableSpec {
    name: "unit_under_test",
    doc: "The unit the procedure is for. The serial number is given when the test is run.",
    keys: &[
        optional("family", Kind::LocalText, "\"OIUS-501\"", "Family of devices."),
        optional("part", Kind::Text, "\"501-00-01\"", "Part number."),
        optional("revision", Kind::Text, "\"C\"", "Revision of the part."),
        with_default(
            "serial_required",
            Kind::Flag,
            "true",
            "true",
            "Whether a run is an error if neither `--serial` nor the recording states a serial number.",
        ),
        optional(
            "requires",
            Kind::Choices(UnitFact::WORDS),
            "[\"lot\"]",
            "What must be known of the unit besides, or a run is an error: from `--lot`, `--unit-data` or the manifest.",
        ),
    ],
};

static RECORDING: TableSpec = TableSpec {
    name: "recording",
    doc: "The recording as a whole.",
    keys: &[
        optional(
            "sample_rate",
            quantity("Hz", Range::POSITIVE),
            "\"10 Hz\"",
            "Declared sample rate. Required when no channel has the role `time`; otherwise the measured rate is judged against it.",
        ),
        with_default(
            "sample_rate_tolerance",
            quantity("1", Range::above_up_to(0.0, 0.5)),
            "\"1 %\"",
            "\"0.1 %\"",
            "Maximum relative difference between the declared and the measured sample rate.",
        ),
        recording_keys::FORMAT,
        recording_keys::ENCODING,
        recording_keys::DELIMITER,
        recording_keys::DECIMAL,
        recording_keys::HEADER_LINE,
        recording_keys::FIRST_LINE,
        recording_keys::COMMENT,
        recording_keys::PART,
        optional(
            "layout",
            Kind::Text,
            "\"layouts/logger.toml\"",
            "Layout of the records of a raw binary file, relative to the procedure.",
        ),
    ],
};

/// Ways to write time stamps.
pub const STAMPS: &[Word] = &[
    ("iso8601", "date and time with the year first, ISO 8601 or RFC 3339"),
    ("day_first", "date and time with the day first, as in Russia"),
    ("month_first", "date and time with the month first, as in the United States"),
    ("clock", "clock time, which starts again at midnight"),
    ("gps_week_seconds", "seconds of the GPS week, which start again after 604800 s"),
    ("number", "numbers"),
];

pub(crate) static CHANNEL: TableSpec = TableSpec {
    name: "channel",
    doc: "One channel: a column of the recording and its role.",
    keys: &[
        required("id", Kind::Id, "\"rate\"", "Id of the channel in this procedure and in results."),
        required(
            "column",
            Kind::Column,
            "\"rate_deg_h\"",
            "Column: its name in the header, or its position counted from 1.",
        ),
        required("role", Kind::Choice(ROLES), "\"rate\"", "What the channel measures."),
        required(
            "unit",
            Kind::UnitText,
            "\"deg/h\"",
            "Unit of the numbers in the file; `count` together with `scale`.",
        ),
        optional(
            "scale",
            Kind::Text,
            "\"0.01 arcsec/count\"",
            "Size of one `unit` of the file: a number with unit. The product with `unit` must suit the role.",
        ),
        with_default(
            "reversed",
            Kind::Flag,
            "false",
            "true",
            "True if the channel has the opposite sign; its values are negated.",
        ),
        optional(
            "stamp",
            Kind::Choice(STAMPS),
            "\"day_first\"",
            "Timestamp format of a text file, for the role `time`; detected if omitted. Timestamps are \
             converted to seconds, so `unit` is \"s\".",
        ),
        optional(
            "date_column",
            Kind::Column,
            "\"date\"",
            "Column of the dates that belong to the clock times in `column`, for the role `time`.",
        ),
        optional(
            "week_column",
            Kind::Column,
            "\"gps_week\"",
            "Column of the GPS weeks that belong to the seconds of week in `column`, for the role `time`.",
        ),
        optional(
            "rail_low",
            Kind::QuantityBy("role"),
            "\"-400 deg/s\"",
            "Lower rail of the channel: samples at or below it count as saturated.",
        ),
        optional(
            "rail_high",
            Kind::QuantityBy("role"),
            "\"400 deg/s\"",
            "Upper rail of the channel: samples at or above it count as saturated.",
        ),
        optional(
            "rollover",
            Kind::Text,
            "\"86400 s\"",
            "Period after which timestamps or a counter restart, such as \"86400 s\" for time of day or \
             \"256 count\" for an 8-bit counter. Common periods are detected if no sample is missing at the \
             restart.",
        ),
        with_default("required", Kind::Flag, "true", "false", "False for an optional column."),
    ],
};

static ANALYSIS: TableSpec = TableSpec {
    name: "analysis",
    doc: "Options of the analysis.",
    keys: &[
        with_default(
            "taus",
            Kind::Taus,
            "\"octave\"",
            "\"octave\"",
            "Averaging times of the Allan deviation.",
        ),
        with_default(
            "exact",
            Kind::Flag,
            "false",
            "true",
            "Sum every overlapping term at any record length, at the cost of time and memory.",
        ),
        with_default(
            "line_false_alarm",
            Kind::Number(Range::between(1e-9, 0.5)),
            "0.01",
            "0.01",
            "Probability that noise alone gives a line anywhere in the spectrum.",
        ),
    ],
};

static EXPLAIN: TableSpec = TableSpec {
    name: "explain",
    doc: "Compares the recording with a model: whether the unit behaves like its family, and if not, where \
          it differs and why. The finding is reported next to the verdict and is not part of it.",
    keys: &[
        required(
            "model",
            Kind::Text,
            "\"family.toml\"",
            "The model, a file as `sagnac explain` reads it, relative to the procedure.",
        ),
        with_default(
            "alpha",
            Kind::Number(Range::between(1e-9, 0.5)),
            "0.01",
            "0.01",
            "Probability of calling a correct model a mismatch.",
        ),
        with_default(
            "max_effects",
            Kind::Number(Range::between(1.0, 8.0)),
            "3",
            "2",
            "Maximum number of effects added to the model.",
        ),
    ],
};

static MEASURAND: TableSpec = TableSpec {
    name: "measurand",
    doc: "A quantity to determine, for one channel or for every gyro channel.",
    keys: &[
        required("id", Kind::Measurand, "\"angle_random_walk\"", "Id of the measurand."),
        optional(
            "channel",
            Kind::Id,
            "\"x\"",
            "Channel. Default: every channel with the role `rate` or `angle_increment`.",
        ),
        optional("options", Kind::Table(&MEASURAND_OPTIONS), "", "Options of the measurand, if it has any."),
    ],
};

/// Options of measurands; which measurand takes which stands in the measurand table.
pub static MEASURAND_OPTIONS: TableSpec = TableSpec {
    name: "measurand.options",
    doc: "Options of a measurand. `earth_rate` belongs to `static_bias`.",
    keys: &[optional(
        "earth_rate",
        Kind::Choice(EARTH_RATE),
        "\"remove\"",
        "Treatment of the Earth rate along the input axis. Default: \"remove\".",
    )],
};

/// What may be done with the Earth rate.
pub const EARTH_RATE: &[Word] = &[
    ("remove", "the Earth rate is subtracted, with its uncertainty; needs [site]"),
    ("keep", "the mean rate is reported as recorded"),
];

pub(crate) static CLAUSE: TableSpec = TableSpec {
    name: "clause",
    doc: "A clause of the standard and where it is covered.",
    keys: &[
        required("clause", Kind::LocalText, "\"12.11\"", "Number of the clause."),
        required("title", Kind::LocalText, "\"Drift-rate series\"", "Its title."),
        required("status", Kind::Choice(CLAUSE_STATUS), "\"here\"", "Where it is covered."),
        optional("note", Kind::LocalText, "\"bias and random drift\"", "Details, or the reason why not."),
    ],
};

const CLAUSE_STATUS: &[Word] = &[
    ("here", "dealt with by this procedure"),
    ("elsewhere", "dealt with by another procedure"),
    ("not_applicable", "does not apply to this unit"),
];

static REPORT: TableSpec = TableSpec {
    name: "report",
    doc: "What the report shows.",
    keys: &[
        optional(
            "title",
            Kind::LocalText,
            "\"Acceptance report\"",
            "Title. Default: the title of the procedure.",
        ),
        optional(
            "figures",
            Kind::Choices(FIGURES),
            "[\"rate\", \"sigma_tau\"]",
            "Figures, in this order. Default: all.",
        ),
        with_default(
            "show_reference",
            Kind::Flag,
            "true",
            "true",
            "Whether published values are shown in a column next to the measured ones.",
        ),
        optional(
            "signatures",
            Kind::Choices(SIGNER_ROLES),
            "[\"tested\", \"approved\"]",
            "Who must sign the result, each by a key of their own; `sagnac verify` asks for it. Default: nobody.",
        ),
    ],
};

const SIGNER_ROLES: &[Word] = &[
    ("tested", "who made the test"),
    ("reviewed", "who checked the result"),
    ("approved", "who decided on the unit"),
];

static WAIVER: TableSpec = TableSpec {
    name: "waiver",
    doc: "A decision to accept one unit in spite of a row. It is recorded next to the verdict and never \
          changes it.",
    keys: &[
        required("serial", Kind::Text, "\"0042\"", "Serial number of the unit: a waiver is for one unit."),
        required("row", Kind::Text, "\"angle_random_walk\"", "Measurand or condition concerned."),
        required("by", Kind::LocalText, "\"J. Smith, quality\"", "Who decided."),
        required(
            "reason",
            Kind::LocalText,
            "\"used at constant temperature only\"",
            "Reason, as shown in the report.",
        ),
        required("date", Kind::Date, "2026-03-01", "Date of the decision."),
    ],
};
