//! The tables of a procedure that declare its conditions.

use super::spec::{Kind, Range, TableSpec, difference, optional, quantity, required, with_default};

pub(super) static CONDITIONS: TableSpec = TableSpec {
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
            "repeated",
            Kind::Allowance,
            "0",
            "Samples in stretches that occurred before, bit for bit, beyond chance.",
        ),
        optional(
            "timestamp_jitter",
            quantity("s", Range::POSITIVE),
            "\"1 ms\"",
            "Largest rms deviation of the stamps from a uniform clock.",
        ),
    ],
};

pub(super) static EXCLUDE: TableSpec = TableSpec {
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
        required(
            "reason",
            Kind::Text,
            "\"door of the chamber opened\"",
            "Why, as it shall stand in the report.",
        ),
    ],
};
