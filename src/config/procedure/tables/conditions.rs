//! The tables of a procedure that declare its conditions.

use crate::config::spec::{Kind, Range, TableSpec, difference, optional, quantity, required, with_default};

pub(crate) static CONDITIONS: TableSpec = TableSpec {
    name: "conditions",
    doc: "Conditions under which the test is valid. A condition that is not proven to be met makes the \
          verdict indeterminate, because an invalid test neither passes nor fails a unit.",
    keys: &[
        optional(
            "minimum_duration",
            quantity("s", Range::POSITIVE),
            "\"10 h\"",
            "Minimum usable time after warm-up, exclusions and gaps.",
        ),
        optional(
            "planned_duration",
            quantity("s", Range::POSITIVE),
            "\"100 h\"",
            "Usable time of a record as planned. `sagnac check` examines whether the limits can be decided in it. \
             Default: `minimum_duration`.",
        ),
        with_default(
            "warm_up",
            quantity("s", Range::NOT_NEGATIVE),
            "\"0 s\"",
            "\"30 min\"",
            "Time excluded at the start, fixed before the data are examined.",
        ),
        optional(
            "temperature",
            Kind::TableOrTables(&TEMPERATURE),
            "",
            "Temperature to be held, one table per sensor.",
        ),
        optional("supply", Kind::TableOrTables(&SUPPLY), "", "Supply voltage to be held."),
        optional("faults", Kind::Table(&FAULTS), "", "Maximum number of faults of each kind."),
    ],
};

static TEMPERATURE: TableSpec = TableSpec {
    name: "conditions.temperature",
    doc: "A temperature that must hold over the whole evaluated window. It holds if every smoothed value \
          lies inside the tolerance minus `coverage_factor` times the sensor's uncertainty.",
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
            "Maximum difference from it.",
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
            "Length of the moving average applied to the temperature, so that sensor noise is not mistaken \
             for the chamber.",
        ),
    ],
};

static SUPPLY: TableSpec = TableSpec {
    name: "conditions.supply",
    doc: "A supply voltage that must hold over the whole evaluated window.",
    keys: &[
        required("channel", Kind::Id, "\"supply\"", "Channel with the role `supply`."),
        required("nominal", quantity("V", Range::ANY), "\"5 V\"", "Nominal voltage."),
        required("tolerance", difference("V", Range::POSITIVE), "\"0.25 V\"", "Maximum difference from it."),
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
    doc: "Maximum number of faults of each kind: a count, or a share of the samples. An omitted kind is \
          counted and reported, but not judged.",
    keys: &[
        optional("gaps", Kind::Allowance, "10", "Places where samples are missing."),
        optional("missing_samples", Kind::Allowance, "\"0.1 %\"", "Missing samples."),
        optional("longest_gap", quantity("s", Range::NOT_NEGATIVE), "\"10 s\"", "Length of the longest gap."),
        optional(
            "duplicate_timestamps",
            Kind::Allowance,
            "0",
            "Rows with the same timestamp as the previous \
                                                                one.",
        ),
        optional(
            "backward_timestamps",
            Kind::Allowance,
            "0",
            "Rows with an earlier timestamp than a \
                                                               previous one.",
        ),
        optional("non_finite", Kind::Allowance, "\"0.01 %\"", "Fields that are empty, NaN or infinite."),
        optional("unparsable", Kind::Allowance, "0", "Fields that are not numbers."),
        optional("outliers", Kind::Allowance, "\"0.1 %\"", "Samples far outside the surrounding noise."),
        optional("saturated", Kind::Allowance, "0", "Samples at a rail."),
        optional(
            "stuck",
            Kind::Allowance,
            "0",
            "Samples that repeat the previous one for longer than chance allows.",
        ),
        optional(
            "repeated",
            Kind::Allowance,
            "0",
            "Samples in stretches that repeat earlier ones bit for bit, beyond chance.",
        ),
        optional(
            "timestamp_jitter",
            quantity("s", Range::POSITIVE),
            "\"1 ms\"",
            "Maximum rms deviation of the timestamps from a uniform clock.",
        ),
    ],
};

pub(crate) static EXCLUDE: TableSpec = TableSpec {
    name: "exclude",
    doc: "A span excluded from the evaluation for a reason known before the data were examined.",
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
        required(
            "reason",
            Kind::LocalText,
            "\"door of the chamber opened\"",
            "Reason, as shown in the report.",
        ),
    ],
};
