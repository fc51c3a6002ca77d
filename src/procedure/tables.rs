//! The tables of a procedure file.

use super::spec::{Kind, Range, TableSpec, Word, difference, optional, quantity, required, with_default};
use super::tables_limits::{LIMIT, REFERENCE};

/// Roles a channel may have, with their meaning.
pub const ROLES: &[Word] = &[
    ("time", "time stamps"),
    ("rate", "angular rate about an input axis"),
    ("angle_increment", "angle turned during the sample interval, or counts of it"),
    ("temperature", "a temperature"),
    ("table_rate", "rate of the table about the input axis"),
    ("table_angle", "angle of the table"),
    ("outer_rate", "rate of the table's other axis"),
    ("supply", "supply voltage"),
    ("auxiliary", "anything else that is kept beside"),
];

/// Figures a report may show.
pub const FIGURES: &[Word] = &[
    ("rate", "rate over time with the excluded spans"),
    ("temperature", "temperature over time with its limits"),
    ("sigma_tau", "Allan deviation over averaging time with the fitted terms"),
    ("spectrum", "power spectral density with the lines found"),
    ("autocorrelation", "autocorrelation with the band of white noise"),
    ("histogram", "distribution of the samples against the normal one"),
];

const HALF_TURN: Range = Range::between(-360.0, 360.0);
const RIGHT_ANGLE: Range = Range::between(-90.0, 90.0);
const SMALL_ANGLE: Range = Range::between(0.0, 90.0);
const SHARE: Range = Range::between(0.0, 1.0);

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
        optional("analysis", Kind::Table(&ANALYSIS), "", "Options of the analysis."),
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

static PROCEDURE: TableSpec = TableSpec {
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

static UNIT_UNDER_TEST: TableSpec = TableSpec {
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
    ],
};

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
        with_default(
            "required",
            Kind::Flag,
            "true",
            "false",
            "False for a column that a recording may lack.",
        ),
    ],
};

static CONDITIONS: TableSpec = TableSpec {
    name: "conditions",
    doc: "Conditions under which the test is valid. One that is not shown to be met makes the verdict indeterminate: a \
          test that was not done right neither passes nor fails a unit.",
    keys: &[
        optional(
            "minimum_duration",
            quantity("s", Range::POSITIVE),
            "\"10 h\"",
            "Least usable time after warm-up, exclusions and gaps.",
        ),
        with_default(
            "warm_up",
            quantity("s", Range::NOT_NEGATIVE),
            "\"0 s\"",
            "\"30 min\"",
            "Time at the beginning that is left out, fixed before the data are looked at.",
        ),
        optional(
            "temperature",
            Kind::TableOrTables(&TEMPERATURE),
            "",
            "Temperature to be held, one table for each sensor judged.",
        ),
        optional("supply", Kind::TableOrTables(&SUPPLY), "", "Supply voltage to be held."),
        optional("faults", Kind::Table(&FAULTS), "", "How many faults of each kind a recording may have."),
    ],
};

static TEMPERATURE: TableSpec = TableSpec {
    name: "conditions.temperature",
    doc: "A temperature that must hold over the whole evaluated window. It is shown to hold when every smoothed value \
          lies inside the tolerance less `coverage_factor` times the sensor's uncertainty.",
    keys: &[
        required("channel", Kind::Id, "\"temp\"", "Channel with the role `temperature`."),
        required(
            "nominal",
            quantity("degC", Range::between(-273.15, 1000.0)),
            "\"20 degC\"",
            "Nominal temperature.",
        ),
        required(
            "tolerance",
            difference("degC", Range::POSITIVE),
            "\"0.4 degC\"",
            "Largest difference from it.",
        ),
        required(
            "sensor_uncertainty",
            difference("degC", Range::NOT_NEGATIVE),
            "\"0.05 degC\"",
            "Standard uncertainty (k = 1) of the sensor, calibration and drift included.",
        ),
        with_default(
            "coverage_factor",
            Kind::Number(Range::between(0.0, 4.0)),
            "2.0",
            "2.0",
            "Multiple of the sensor's uncertainty by which the tolerance is narrowed.",
        ),
        with_default(
            "smoothing",
            quantity("s", Range::NOT_NEGATIVE),
            "\"60 s\"",
            "\"60 s\"",
            "Length of the moving mean over which the temperature is judged, so that the sensor's noise is not taken for the chamber.",
        ),
    ],
};

static SUPPLY: TableSpec = TableSpec {
    name: "conditions.supply",
    doc: "A supply voltage that must hold over the whole evaluated window.",
    keys: &[
        required("channel", Kind::Id, "\"supply\"", "Channel with the role `supply`."),
        required("nominal", quantity("V", Range::ANY), "\"5 V\"", "Nominal voltage."),
        required("tolerance", difference("V", Range::POSITIVE), "\"0.25 V\"", "Largest difference from it."),
        with_default(
            "sensor_uncertainty",
            difference("V", Range::NOT_NEGATIVE),
            "\"0 V\"",
            "\"0.01 V\"",
            "Standard uncertainty (k = 1) of the reading.",
        ),
        with_default(
            "coverage_factor",
            Kind::Number(Range::between(0.0, 4.0)),
            "2.0",
            "2.0",
            "Multiple of that uncertainty by which the tolerance is narrowed.",
        ),
    ],
};

static FAULTS: TableSpec = TableSpec {
    name: "conditions.faults",
    doc: "How many faults of each kind a recording may have: a count, or a share of the samples. A kind that is left \
          out is counted and reported, and not judged.",
    keys: &[
        optional("gaps", Kind::Allowance, "10", "Places where samples are missing."),
        optional("missing_samples", Kind::Allowance, "\"0.1 %\"", "Samples missing in them."),
        optional("longest_gap", quantity("s", Range::NOT_NEGATIVE), "\"10 s\"", "Length of the longest gap."),
        optional("duplicate_timestamps", Kind::Allowance, "0", "Rows whose stamp equals the one before."),
        optional("backward_timestamps", Kind::Allowance, "0", "Rows whose stamp is earlier than one before."),
        optional("non_finite", Kind::Allowance, "\"0.01 %\"", "Fields that are empty, NaN or infinite."),
        optional("unparsable", Kind::Allowance, "0", "Fields that are no number."),
        optional("outliers", Kind::Allowance, "\"0.1 %\"", "Samples far outside the noise about them."),
        optional("saturated", Kind::Allowance, "0", "Samples at a rail."),
        optional(
            "stuck",
            Kind::Allowance,
            "0",
            "Samples that repeat the one before for longer than chance allows.",
        ),
        optional(
            "timestamp_jitter",
            quantity("s", Range::POSITIVE),
            "\"1 ms\"",
            "Largest rms deviation of the stamps from a uniform clock.",
        ),
    ],
};

static EXCLUDE: TableSpec = TableSpec {
    name: "exclude",
    doc: "A span left out of the evaluation for a reason known before the data were looked at.",
    keys: &[
        required(
            "from",
            quantity("s", Range::NOT_NEGATIVE),
            "\"2 h\"",
            "Start, from the beginning of the recording.",
        ),
        required(
            "to",
            quantity("s", Range::POSITIVE),
            "\"2.5 h\"",
            "End, from the beginning of the recording.",
        ),
        required("reason", Kind::Text, "\"door of the chamber opened\"", "Why."),
    ],
};

static SITE: TableSpec = TableSpec {
    name: "site",
    doc: "Where the unit stands and where its input axis points: the Earth rate along the axis follows from it. \
          Uncertainties are standard uncertainties (k = 1).",
    keys: &[
        required("latitude", quantity("deg", RIGHT_ANGLE), "\"55.98 deg\"", "Latitude, positive north."),
        with_default(
            "latitude_uncertainty",
            quantity("deg", SMALL_ANGLE),
            "\"0 deg\"",
            "\"1 arcsec\"",
            "Its uncertainty.",
        ),
        optional(
            "heading",
            quantity("deg", HALF_TURN),
            "\"90 deg\"",
            "Heading of the input axis from true north, positive to the east. Needed unless the axis is vertical.",
        ),
        with_default(
            "heading_uncertainty",
            quantity("deg", Range::between(0.0, 360.0)),
            "\"0 deg\"",
            "\"1 arcmin\"",
            "Its uncertainty.",
        ),
        required(
            "elevation",
            quantity("deg", RIGHT_ANGLE),
            "\"90 deg\"",
            "Elevation of the input axis above the horizon; 90 deg is up.",
        ),
        with_default(
            "elevation_uncertainty",
            quantity("deg", SMALL_ANGLE),
            "\"0 deg\"",
            "\"30 arcsec\"",
            "Its uncertainty: the tilt of the axis.",
        ),
        optional(
            "axis",
            Kind::Tables(&AXIS),
            "",
            "Orientation of single channels that differ from the above.",
        ),
    ],
};

static AXIS: TableSpec = TableSpec {
    name: "site.axis",
    doc: "Orientation of the input axis of one channel.",
    keys: &[
        required("channel", Kind::Id, "\"x\"", "Channel with the role `rate` or `angle_increment`."),
        optional(
            "heading",
            quantity("deg", HALF_TURN),
            "\"0 deg\"",
            "Heading from true north, positive to the east. Needed unless the axis is vertical.",
        ),
        with_default(
            "heading_uncertainty",
            quantity("deg", Range::between(0.0, 360.0)),
            "\"0 deg\"",
            "\"1 arcmin\"",
            "Its uncertainty.",
        ),
        required("elevation", quantity("deg", RIGHT_ANGLE), "\"0 deg\"", "Elevation above the horizon."),
        with_default(
            "elevation_uncertainty",
            quantity("deg", SMALL_ANGLE),
            "\"0 deg\"",
            "\"30 arcsec\"",
            "Its uncertainty.",
        ),
    ],
};

static INSTRUMENT: TableSpec = TableSpec {
    name: "instrument",
    doc: "An instrument and the validity of its calibration. A calibration that has run out on the day of the test is \
          an invalid condition.",
    keys: &[
        required("name", Kind::Text, "\"chamber thermometer\"", "What it is."),
        optional("serial", Kind::Text, "\"T-0412\"", "Serial number."),
        optional("calibration_due", Kind::Date, "2030-12-31", "Last day on which the calibration is valid."),
        with_default(
            "required",
            Kind::Flag,
            "true",
            "true",
            "Whether an instrument without a valid calibration makes the test invalid; otherwise it is a remark.",
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

static CLAUSE: TableSpec = TableSpec {
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
        required("row", Kind::Text, "\"bias_instability\"", "Measurand or condition concerned."),
        required("by", Kind::Text, "\"J. Smith, quality\"", "Who decided."),
        required("reason", Kind::Text, "\"used at constant temperature only\"", "Why."),
        required("date", Kind::Date, "2026-03-01", "When."),
    ],
};

/// Share of the samples that an allowance may state.
pub(super) const ALLOWANCE_SHARE: Range = SHARE;
