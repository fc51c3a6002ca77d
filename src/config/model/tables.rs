//! The tables of a claim.

use crate::config::spec::{Kind, Range, TableSpec, Word, optional, required, with_default};

/// A claim as a whole.
pub static MODEL_FILE: TableSpec = TableSpec {
    name: "",
    doc: "A claim: the expected content of a recording. An omitted table is taken as zero or not applicable.",
    keys: &[
        required("recording", Kind::Table(&RECORDING), "", "The recording that the claim is of."),
        optional("noise", Kind::Table(&NOISE), "", "Coefficients of the noise."),
        optional("bias", Kind::Table(&BIAS), "", "The constant part of the rate."),
        optional(
            "temperature",
            Kind::Table(&TEMPERATURE),
            "",
            "Dependence of the bias on the recorded temperature.",
        ),
        optional(
            "scale_factor",
            Kind::Table(&SCALE_FACTOR),
            "",
            "The scale factor, where there is a rate table.",
        ),
        optional("earth", Kind::Table(&EARTH), "", "Where the input axis points, where the heading matters."),
        optional("uncertainty", Kind::Table(&UNCERTAINTY), "", "How well the values are known."),
        optional("effect", Kind::Tables(&EFFECT), "", "Effects that the claim states, one table each."),
        optional(
            "simulation",
            Kind::Table(&SIMULATION),
            "",
            "What `simulate` makes when the command line does not say.",
        ),
        optional("driver", Kind::Tables(&DRIVER), "", "Column profiles for `simulate`, one table each."),
    ],
};

/// Columns of a recording beside time and rate.
const COLUMNS: &[Word] = &[
    ("time_s", "Time of the sample, s"),
    ("rate_deg_h", "Output of the gyro, deg/h"),
    ("temp_degC", "Temperature of the housing, degC"),
    ("table_rate_deg_s", "Rate of the table about the input axis, deg/s"),
    ("table_angle_deg", "Position of the table, 0 to 360 deg"),
    ("outer_rate_deg_s", "Rate of the table's other axis, deg/s"),
    ("supply_v", "Supply voltage, V"),
];

/// Columns that a profile can drive.
const DRIVEN: &[Word] = &[
    ("temp_degC", "Temperature of the housing, degC"),
    ("table_rate_deg_s", "Rate of the table about the input axis, deg/s"),
    ("table_angle_deg", "Position of the table, deg; written as 0 to 360"),
    ("outer_rate_deg_s", "Rate of the table's other axis, deg/s"),
    ("supply_v", "Supply voltage, V"),
];

const RATE: Range = Range::above_up_to(0.0, 1e9);
const COEFFICIENT: Range = Range::between(0.0, 1e6);
const SIGNED: Range = Range::between(-1e12, 1e12);

static RECORDING: TableSpec = TableSpec {
    name: "recording",
    doc: "The recording that the claim is of.",
    keys: &[
        optional("case", Kind::Remark, "\"unit-0042\"", "Name of the case."),
        optional("description", Kind::LocalRemark, "\"static, laboratory\"", "Free text."),
        required("sample_rate_hz", Kind::Number(RATE), "10", "Nominal sample rate, Hz."),
        optional(
            "columns",
            Kind::Columns(COLUMNS),
            "[\"time_s\", \"rate_deg_h\"]",
            "Columns that the recording has.",
        ),
    ],
};

static NOISE: TableSpec = TableSpec {
    name: "noise",
    doc: "Coefficients of IEEE Std 952; the two-sided density is 3600 N² + B²/(2πf) + K²/(3600 (2πf)²), (deg/h)²/Hz.",
    keys: &[
        with_default(
            "N_deg_rt_h",
            Kind::Number(COEFFICIENT),
            "0.0",
            "0.0023",
            "Angle random walk N, deg/√h.",
        ),
        with_default(
            "B_deg_h",
            Kind::Number(COEFFICIENT),
            "0.0",
            "0.0017",
            "Flicker B, deg/h. The floor of the Allan deviation is 0.664 B.",
        ),
        with_default(
            "K_deg_h_rt_h",
            Kind::Number(COEFFICIENT),
            "0.0",
            "0.0009",
            "Rate random walk K, deg/h/√h.",
        ),
        with_default(
            "quantization_lsb_arcsec",
            Kind::Number(COEFFICIENT),
            "0.0",
            "0.01",
            "Angle increment of the output, arcsec; 0 for none.",
        ),
    ],
};

static BIAS: TableSpec = TableSpec {
    name: "bias",
    doc: "The constant part of the rate.",
    keys: &[with_default("value_deg_h", Kind::Number(SIGNED), "0.0", "-3.1", "Bias, deg/h.")],
};

static TEMPERATURE: TableSpec = TableSpec {
    name: "temperature",
    doc: "Dependence of the bias on the recorded temperature: coefficient · (temp_degC − reference).",
    keys: &[
        required("coefficient_deg_h_per_degC", Kind::Number(SIGNED), "1.2e-4", "Coefficient, deg/h/°C."),
        with_default(
            "reference_degC",
            Kind::Number(Range::between(-273.15, 1000.0)),
            "20.0",
            "20.0",
            "Temperature at which the bias holds, °C.",
        ),
    ],
};

static SCALE_FACTOR: TableSpec = TableSpec {
    name: "scale_factor",
    doc: "The scale factor: 3600 (1 + 10⁻⁶ error) · table_rate_deg_s.",
    keys: &[with_default(
        "error_ppm",
        Kind::Number(Range::between(-1e6, 1e6)),
        "0.0",
        "12.0",
        "Known error, already part of the claim, ppm.",
    )],
};

static EARTH: TableSpec = TableSpec {
    name: "earth",
    doc: "Earth rate in the plane of the table: 15.041067 cos(latitude) cos(table_angle_deg + azimuth), deg/h.",
    keys: &[
        required(
            "latitude_deg",
            Kind::Number(Range::between(-90.0, 90.0)),
            "55.98",
            "Geographic latitude, deg.",
        ),
        with_default(
            "azimuth_deg",
            Kind::Number(Range::between(-360.0, 360.0)),
            "0.0",
            "12.3",
            "Heading of the input axis at table angle 0, deg.",
        ),
    ],
};

static UNCERTAINTY: TableSpec = TableSpec {
    name: "uncertainty",
    doc: "One standard deviation of the author's knowledge of each value; omitted values are exact. The bias \
          is always free.",
    keys: &[
        with_default("N_rel", Kind::Number(COEFFICIENT), "0.0", "0.015", "Of N, relative."),
        with_default("B_rel", Kind::Number(COEFFICIENT), "0.0", "0.12", "Of B, relative."),
        with_default("K_rel", Kind::Number(COEFFICIENT), "0.0", "0.15", "Of K, relative."),
        with_default(
            "N_deg_rt_h",
            Kind::Number(COEFFICIENT),
            "0.0",
            "0.001",
            "Of N where it is stated as 0, deg/√h: the value is positive and within about two of these.",
        ),
        with_default(
            "B_deg_h",
            Kind::Number(COEFFICIENT),
            "0.0",
            "0.002",
            "Of B where it is stated as 0, deg/h.",
        ),
        with_default(
            "K_deg_h_rt_h",
            Kind::Number(COEFFICIENT),
            "0.0",
            "0.0005",
            "Of K where it is stated as 0, deg/h/√h.",
        ),
        with_default(
            "N_at_most_deg_rt_h",
            Kind::Number(COEFFICIENT),
            "0.0",
            "0.003",
            "Upper limit (95 %) of N where it is stated as 0 because a record did not resolve it, deg/√h.",
        ),
        with_default(
            "B_at_most_deg_h",
            Kind::Number(COEFFICIENT),
            "0.0",
            "0.004",
            "Upper limit (95 %) of B where it is stated as 0 because a record did not resolve it, deg/h.",
        ),
        with_default(
            "K_at_most_deg_h_rt_h",
            Kind::Number(COEFFICIENT),
            "0.0",
            "0.001",
            "Upper limit (95 %) of K where it is stated as 0 because a record did not resolve it, deg/h/√h.",
        ),
        with_default("bias_deg_h", Kind::Number(COEFFICIENT), "0.0", "0.03", "Of the bias, deg/h."),
        with_default(
            "temperature_coefficient_deg_h_per_degC",
            Kind::Number(COEFFICIENT),
            "0.0",
            "1e-6",
            "Of the temperature coefficient, deg/h/°C.",
        ),
        with_default(
            "scale_factor_ppm",
            Kind::Number(COEFFICIENT),
            "0.0",
            "2.0",
            "Of the scale factor, ppm.",
        ),
        with_default(
            "skewness",
            Kind::Number(COEFFICIENT),
            "0.0",
            "0.02",
            "Largest skewness of the noise of single samples, of either sign: the third central moment over the cube of \
             the standard deviation. 0: the law is even.",
        ),
    ],
};

/// An effect with its parameters.
pub(crate) static EFFECT: TableSpec = TableSpec {
    name: "effect",
    doc: "An effect that the claim states. `sagnac effects` lists the kinds, `sagnac effects KIND` the parameters of one.",
    keys: &[
        required("kind", Kind::Id, "\"line\"", "Kind of the effect."),
        optional("parameters", Kind::Values, "", "Its parameters by name, in a table [effect.parameters]."),
    ],
};

static SIMULATION: TableSpec = TableSpec {
    name: "simulation",
    doc: "What `simulate` makes when the command line does not say. The claim itself does not depend on it.",
    keys: &[
        optional("duration_s", Kind::Number(Range::POSITIVE), "36000", "Length, s."),
        optional(
            "seed",
            Kind::Number(Range::between(0.0, 9_007_199_254_740_992.0)),
            "1",
            "Seed, a whole number: equal seeds give equal recordings.",
        ),
        with_default("start_s", Kind::Number(SIGNED), "0.0", "0.0", "`time_s` of the first sample, s."),
    ],
};

static DRIVER: TableSpec = TableSpec {
    name: "driver",
    doc: "The profile of a column: straight lines between points, the first and last value held outside, \
          plus a sine.",
    keys: &[
        required("column", Kind::Choice(DRIVEN), "\"temp_degC\"", "The column."),
        with_default(
            "time_s",
            Kind::Numbers(SIGNED),
            "[0.0]",
            "[0.0, 600.0, 7200.0]",
            "Times of the points on `time_s`, increasing; two equal ones make a step.",
        ),
        with_default(
            "value",
            Kind::Numbers(SIGNED),
            "[0.0]",
            "[20.0, 20.0, 60.0]",
            "Values there, in the unit of the column.",
        ),
        with_default(
            "sine_amplitude",
            Kind::Number(SIGNED),
            "0.0",
            "0.5",
            "Amplitude of the sine, in the unit of the column.",
        ),
        optional("sine_period_s", Kind::Number(Range::POSITIVE), "1800.0", "Period of the sine, s."),
        with_default(
            "sine_phase_deg",
            Kind::Number(SIGNED),
            "0.0",
            "90.0",
            "Phase of the sine at `time_s` = 0, deg.",
        ),
        with_default(
            "noise",
            Kind::Number(COEFFICIENT),
            "0.0",
            "0.003",
            "Standard deviation of the sensor's white noise, in the unit of the column: added to the column, \
             not to what the gyro senses.",
        ),
    ],
};
