//! The tables of a procedure that ask for a test over temperature, and for the warm-up time.

use crate::config::spec::{
    Kind, Range, TableSpec, Word, difference, optional, quantity, required, with_default,
};

const REACHABLE: Range = Range::between(-273.15, 1000.0);

/// What a stated segment may be.
pub const SEGMENTS: &[Word] = &[
    ("soak", "constant temperature before the first ramp"),
    ("heating", "rising temperature"),
    ("cooling", "falling temperature"),
    ("dwell", "constant temperature after a ramp"),
];

pub(crate) static TEMPERATURE_TEST: TableSpec = TableSpec {
    name: "temperature_test",
    doc: "A temperature test: ramps and dwells, checked from the recording. This table makes the temperature \
          measurands available.",
    keys: &[
        required(
            "channel",
            Kind::Id,
            "\"temp\"",
            "Channel with the role `temperature` used as the reference for the bias: the sensor nearest to \
             the coil.",
        ),
        optional(
            "command",
            Kind::Id,
            "\"chamber\"",
            "Channel with the role `temperature` that has the chamber set point; segments are then found \
             from it. Default: `channel`.",
        ),
        required("low", quantity("degC", REACHABLE), "\"-40 degC\"", "Lowest temperature to be reached."),
        required("high", quantity("degC", REACHABLE), "\"60 degC\"", "Highest temperature to be reached."),
        with_default(
            "end_tolerance",
            difference("degC", Range::POSITIVE),
            "\"2 degC\"",
            "\"2 degC\"",
            "Maximum shortfall from an end point.",
        ),
        optional(
            "overshoot",
            difference("degC", Range::POSITIVE),
            "\"3 degC\"",
            "Maximum overshoot of an end point. If omitted, not judged.",
        ),
        optional(
            "ramp_rate",
            difference("degC/h", Range::POSITIVE),
            "\"20 degC/h\"",
            "Nominal ramp rate. Default: any from `slowest` to `fastest`.",
        ),
        with_default(
            "ramp_rate_tolerance",
            quantity("1", Range::above_up_to(0.0, 0.5)),
            "\"10 %\"",
            "\"10 %\"",
            "Maximum relative difference from the nominal rate.",
        ),
        with_default(
            "slowest",
            difference("degC/h", Range::POSITIVE),
            "\"4 degC/h\"",
            "\"4 degC/h\"",
            "Slowest ramp allowed.",
        ),
        with_default(
            "fastest",
            difference("degC/h", Range::POSITIVE),
            "\"60 degC/h\"",
            "\"60 degC/h\"",
            "Fastest ramp allowed.",
        ),
        optional(
            "dwell",
            quantity("s", Range::POSITIVE),
            "\"1 h\"",
            "Minimum length of a dwell between ramps. If omitted, not judged.",
        ),
        with_default(
            "dwell_drift",
            difference("degC/h", Range::POSITIVE),
            "\"1 degC/h\"",
            "\"1 degC/h\"",
            "Maximum temperature drift in the second half of a dwell.",
        ),
        with_default(
            "ramps_each_way",
            Kind::Number(Range::between(0.0, 100.0)),
            "1",
            "3",
            "Minimum number of ramps in each direction.",
        ),
        required(
            "sensor_uncertainty",
            difference("degC", Range::NOT_NEGATIVE),
            "\"0.1 degC\"",
            "Standard uncertainty (k = 1) of the sensor, calibration and drift included.",
        ),
        with_default(
            "coverage_factor",
            Kind::Number(Range::between(0.0, 4.0)),
            "2.0",
            "2.0",
            "Multiple of the sensor's uncertainty by which requirements are narrowed.",
        ),
        with_default(
            "zones",
            Kind::Number(Range::between(0.0, 21.0)),
            "5",
            "5",
            "Zones of temperature, evenly from `low` to `high`, in which the noise is determined.",
        ),
        with_default(
            "residual_average",
            quantity("s", Range::POSITIVE),
            "\"100 s\"",
            "\"100 s\"",
            "Averaging time of the residual.",
        ),
        with_default(
            "highest_order",
            Kind::Number(Range::between(1.0, 6.0)),
            "6",
            "4",
            "Highest order of the polynomial in temperature; the order is chosen by holding out whole ramps.",
        ),
        optional(
            "segment",
            Kind::Tables(&SEGMENT),
            "",
            "Segments of the schedule; detected from the recording if omitted.",
        ),
    ],
};

static SEGMENT: TableSpec = TableSpec {
    name: "temperature_test.segment",
    doc: "A segment of the schedule, in the order of time.",
    keys: &[
        required("kind", Kind::Choice(SEGMENTS), "\"heating\"", "What it is."),
        required(
            "from",
            quantity("s", Range::NOT_NEGATIVE),
            "\"2 h\"",
            "Start, from the beginning of the recording.",
        ),
        required(
            "to",
            quantity("s", Range::POSITIVE),
            "\"7 h\"",
            "End, from the beginning of the recording.",
        ),
    ],
};

/// What can say when a unit was switched on.
pub const STARTS: &[Word] = &[
    ("declared", "the procedure: at the first row; reports say that it is declared, not seen"),
    ("stamp", "the stamps: at `power_on`"),
    ("supply", "a supply that comes on in the recording"),
    ("temperature", "a thermometer that stands at `cold` first and rises"),
];

pub(crate) static WARM_UP_TEST: TableSpec = TableSpec {
    name: "warm_up_test",
    doc: "A warm-up test, from turn-on. The recording must show the turn-on, or the procedure must declare \
          it: a recording with its start missing shows a shorter warm-up. Otherwise no warm-up time can \
          pass.",
    keys: &[
        required(
            "band",
            quantity("deg/h", Range::POSITIVE),
            "\"0.01 deg/h\"",
            "Maximum deviation of the bias from its final value once the unit is warm.",
        ),
        with_default(
            "final_share",
            quantity("1", Range::above_up_to(0.0, 0.5)),
            "\"25 %\"",
            "\"25 %\"",
            "Share of the recording, at its end, whose mean is the final value.",
        ),
        optional(
            "start",
            Kind::Choice(STARTS),
            "\"declared\"",
            "What shows the turn-on time. If omitted, it is unknown and no warm-up time can pass.",
        ),
        optional(
            "start_channel",
            Kind::Id,
            "\"supply\"",
            "With `start = \"supply\"` the channel of the supply, with `\"temperature\"` that of the thermometer on the unit.",
        ),
        with_default(
            "power_on",
            quantity("s", Range::NOT_NEGATIVE),
            "\"0 s\"",
            "\"0 s\"",
            "With `start = \"stamp\"`: the timestamp of turn-on.",
        ),
        optional(
            "cold",
            quantity("degC", REACHABLE),
            "\"23 degC\"",
            "With `start = \"temperature\"`: temperature of the cold unit, that of the chamber.",
        ),
        with_default(
            "cold_tolerance",
            difference("degC", Range::POSITIVE),
            "\"0.5 degC\"",
            "\"0.5 degC\"",
            "Maximum difference of the first temperature from `cold`; the unit must warm up by three times \
             as much.",
        ),
    ],
};
