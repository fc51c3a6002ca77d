//! The tables of a procedure file.

use super::spec::{Kind, Range, TableSpec, Word, optional, quantity, required, with_default};
use super::tables_conditions::{CONDITIONS, EXCLUDE};
use super::tables_influence::{MAGNETIC_TEST, REPEATABILITY_TEST, SUPPLY_TEST, VIBRATION_TEST};
use super::tables_limits::{LIMIT, REFERENCE};
use super::tables_rate_table::RATE_TABLE;
use super::tables_site::{INSTRUMENT, SITE};
use super::tables_temperature::{TEMPERATURE_TEST, WARM_UP_TEST};
use crate::config::reading_tables;

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
            "Spans left out of the evaluation, declared beforehand.",
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
            "The recording against the model of the unit's family.",
        ),
        optional("temperature_test", Kind::Table(&TEMPERATURE_TEST), "", "A test over temperature."),
        optional("warm_up_test", Kind::Table(&WARM_UP_TEST), "", "A test of the warm-up."),
        optional(
            "repeatability_test",
            Kind::Table(&REPEATABILITY_TEST),
            "",
            "A series of switching off and on.",
        ),
        optional("magnetic_test", Kind::Table(&MAGNETIC_TEST), "", "A comparison in a magnetic field."),
        optional("supply_test", Kind::Table(&SUPPLY_TEST), "", "A comparison at several supply voltages."),
        optional("vibration_test", Kind::Table(&VIBRATION_TEST), "", "A comparison under vibration."),
        required(
            "measurand",
            Kind::Tables(&MEASURAND),
            "",
            "What is determined, one table each, in the order of the report.",
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
        optional(
            "clause",
            Kind::Tables(&CLAUSE),
            "",
            "Clauses of the standard and where each is dealt with.",
        ),
        optional("report", Kind::Table(&REPORT), "", "What the report shows."),
        optional(
            "waiver",
            Kind::Tables(&WAIVER),
            "",
            "Waivers: records beside the verdict, never part of it.",
        ),
    ],
};

pub(super) static PROCEDURE: TableSpec = TableSpec {
    name: "procedure",
    doc: "Identity of the procedure. It stands in the header of every report.",
    keys: &[
        required("id", Kind::Id, "\"static-bias\"", "Id; names the output folder too."),
        required("title", Kind::Text, "\"Static bias and noise\"", "Title of the report."),
        required(
            "revision",
            Kind::Text,
            "\"A\"",
            "Revision. Change it whenever anything else in the file changes.",
        ),
        optional("standard", Kind::Text, "\"IEEE Std 952-2020\"", "Standard followed, with its edition."),
        optional("clause", Kind::Text, "\"12.11 drift-rate series\"", "Clause of the standard."),
        optional("author", Kind::Text, "\"QA department\"", "Who wrote the procedure."),
    ],
};

pub(super) static UNIT_UNDER_TEST: TableSpec = TableSpec {
    name: "unit_under_test",
    doc: "The unit the procedure is for. The serial number is given when the test is run.",
    keys: &[
        optional("family", Kind::Text, "\"OIUS-501\"", "Family of devices."),
        optional("part", Kind::Text, "\"501-00-01\"", "Part number."),
        optional("revision", Kind::Text, "\"C\"", "Revision of the part."),
        with_default(
            "serial_required",
            Kind::Flag,
            "true",
            "true",
            "Whether a run without a serial number is an error.",
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
            "Largest relative difference between the declared and the measured sample rate.",
        ),
        reading_tables::FORMAT,
        reading_tables::ENCODING,
        reading_tables::DELIMITER,
        reading_tables::DECIMAL,
        reading_tables::HEADER_LINE,
        reading_tables::FIRST_LINE,
        reading_tables::COMMENT,
        reading_tables::PART,
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

static CHANNEL: TableSpec = TableSpec {
    name: "channel",
    doc: "One channel: a column of the recording and what it is taken for.",
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
            "True when the channel counts in the opposite direction; its values change sign.",
        ),
        optional(
            "stamp",
            Kind::Choice(STAMPS),
            "\"day_first\"",
            "How the time stamps of a text file are written, for the role `time`; left out: found. Stamps become seconds, so that `unit` is \"s\".",
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
            "Lowest output of the channel: samples at or below it count as saturated.",
        ),
        optional(
            "rail_high",
            Kind::QuantityBy("role"),
            "\"400 deg/s\"",
            "Highest output of the channel: samples at or above it count as saturated.",
        ),
        optional(
            "rollover",
            Kind::Text,
            "\"86400 s\"",
            "Period after which stamps or a counter start again, such as \"86400 s\" for clock time or \"256 count\" for a counter of 8 bits. Usual periods are found without it where no sample is missing there.",
        ),
        with_default(
            "required",
            Kind::Flag,
            "true",
            "false",
            "False for a column that a recording may lack.",
        ),
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
            "Probability that noise alone shows a line anywhere in the spectrum.",
        ),
    ],
};

static EXPLAIN: TableSpec = TableSpec {
    name: "explain",
    doc: "The recording is explained against a model: whether the unit behaves like its family, and if not, where it \
          differs and because of what. The finding stands in the report beside the verdict and is no part of it.",
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
            "Probability at which a correct model is called a mismatch.",
        ),
        with_default(
            "max_effects",
            Kind::Number(Range::between(1.0, 8.0)),
            "3",
            "2",
            "Most effects that are added to the model.",
        ),
    ],
};

static MEASURAND: TableSpec = TableSpec {
    name: "measurand",
    doc: "Something to be determined, for one channel or for every gyro channel.",
    keys: &[
        required("id", Kind::Measurand, "\"angle_random_walk\"", "Id of the measurand."),
        optional(
            "channel",
            Kind::Id,
            "\"x\"",
            "Channel; left out: every channel with the role `rate` or `angle_increment`.",
        ),
        optional("options", Kind::Table(&MEASURAND_OPTIONS), "", "Options, where the measurand has any."),
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
        "What is done with the Earth rate along the input axis; left out: \"remove\".",
    )],
};

/// What may be done with the Earth rate.
pub const EARTH_RATE: &[Word] = &[
    ("remove", "the Earth rate is subtracted, with its uncertainty; needs [site]"),
    ("keep", "the mean rate is reported as recorded"),
];

pub(super) static CLAUSE: TableSpec = TableSpec {
    name: "clause",
    doc: "A clause of the standard and where it is dealt with.",
    keys: &[
        required("clause", Kind::Text, "\"12.11\"", "Number of the clause."),
        required("title", Kind::Text, "\"Drift-rate series\"", "Its title."),
        required("status", Kind::Choice(CLAUSE_STATUS), "\"here\"", "Where it is dealt with."),
        optional("note", Kind::Text, "\"bias and random drift\"", "What exactly, or why not."),
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
            Kind::Text,
            "\"Acceptance report\"",
            "Title; left out: the title of the procedure.",
        ),
        optional(
            "figures",
            Kind::Choices(FIGURES),
            "[\"rate\", \"sigma_tau\"]",
            "Figures, in this order; left out: all.",
        ),
        with_default(
            "show_reference",
            Kind::Flag,
            "true",
            "true",
            "Whether published values stand in a column beside the measured ones.",
        ),
    ],
};

static WAIVER: TableSpec = TableSpec {
    name: "waiver",
    doc: "A decision to accept one unit in spite of a row. It is a record beside the verdict and never changes it.",
    keys: &[
        required("serial", Kind::Text, "\"0042\"", "Serial number of the unit: a waiver is for one unit."),
        required("row", Kind::Text, "\"angle_random_walk\"", "Measurand or condition concerned."),
        required("by", Kind::Text, "\"J. Smith, quality\"", "Who decided."),
        required(
            "reason",
            Kind::Text,
            "\"used at constant temperature only\"",
            "Why, as it shall stand in the report.",
        ),
        required("date", Kind::Date, "2026-03-01", "Day of the decision."),
    ],
};
