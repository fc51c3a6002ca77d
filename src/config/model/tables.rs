//! The tables of a claim.

use crate::config::section::{Named, Section};
use crate::config::spec::{Kind, Range, TableSpec, Word};
use crate::config::table::{Table, words};
use crate::effect::Column;
use crate::i18n::LocalText;

/// A claim as a whole.
pub static MODEL_FILE: TableSpec = *ModelTables::SPEC;

/// A claim: the expected content of a recording. An omitted table is taken as zero or not applicable.
#[derive(Table)]
#[table("")]
pub(super) struct ModelTables {
    /// The recording that the claim is of.
    pub recording: RecordingKeys,
    /// Coefficients of the noise.
    #[key(optional)]
    pub noise: NoiseKeys,
    /// The constant part of the rate.
    #[key(optional)]
    pub bias: BiasKeys,
    /// Dependence of the bias on the recorded temperature.
    pub temperature: Option<TemperatureKeys>,
    /// The scale factor, where there is a rate table.
    pub scale_factor: Option<ScaleFactorKeys>,
    /// Where the input axis points, where the heading matters.
    pub earth: Option<EarthKeys>,
    /// How well the values are known.
    #[key(optional)]
    pub uncertainty: UncertaintyKeys,
    /// Effects that the claim states, one table each.
    #[key(name = "effect")]
    pub effects: Vec<EffectKeys>,
    /// What `simulate` makes when the command line does not say.
    #[key(optional)]
    pub simulation: SimulationKeys,
    /// Column profiles for `simulate`, one table each.
    #[key(name = "driver")]
    pub drivers: Vec<DriverKeys>,
}

/// Columns of a recording beside time and rate.
const RECORDED_COLUMNS: &[Word] = &[
    ("time_s", "Time of the sample, s"),
    ("rate_deg_h", "Output of the gyro, deg/h"),
    ("temp_degC", "Temperature of the housing, degC"),
    ("table_rate_deg_s", "Rate of the table about the input axis, deg/s"),
    ("table_angle_deg", "Position of the table, 0 to 360 deg"),
    ("outer_rate_deg_s", "Rate of the table's other axis, deg/s"),
    ("supply_v", "Supply voltage, V"),
];

/// Columns that a profile can drive.
const DRIVEN_COLUMNS: &[Word] = &[
    ("temp_degC", "Temperature of the housing, degC"),
    ("table_rate_deg_s", "Rate of the table about the input axis, deg/s"),
    ("table_angle_deg", "Position of the table, deg; written as 0 to 360"),
    ("outer_rate_deg_s", "Rate of the table's other axis, deg/s"),
    ("supply_v", "Supply voltage, V"),
];

/// Ranges: of a sample rate, Hz; of a coefficient of noise; of a value of either sign.
const SAMPLE_RATE_HZ: Range = Range::above_up_to(0.0, 1e9);
const COEFFICIENT_RANGE: Range = Range::between(0.0, 1e6);
const SIGNED_RANGE: Range = Range::between(-1e12, 1e12);

words!(Column, DRIVEN_COLUMNS, |word: &str| Column::KNOWN.into_iter().find(|column| column.name() == word));

/// The recording that the claim is of.
#[derive(Table)]
#[table("recording")]
pub(super) struct RecordingKeys {
    /// Name of the case.
    #[key(remark, optional, example = "unit-0042")]
    pub case: String,
    /// Free text.
    #[key(remark, optional, example = "static, laboratory")]
    pub description: LocalText,
    /// Nominal sample rate, Hz.
    #[key(range = SAMPLE_RATE_HZ, example = 10)]
    pub sample_rate_hz: f64,
    /// Columns that the recording has.
    #[key(kind = Kind::Columns(RECORDED_COLUMNS), example = ["time_s", "rate_deg_h"])]
    pub columns: Option<Vec<String>>,
}

/// Coefficients of IEEE Std 952; the two-sided density is 3600 N² + B²/(2πf) + K²/(3600 (2πf)²), (deg/h)²/Hz.
#[derive(Table)]
#[table("noise")]
pub(super) struct NoiseKeys {
    /// Angle random walk N, deg/√h.
    #[key(name = "N_deg_rt_h", range = COEFFICIENT_RANGE, default = 0.0, example = 0.0023)]
    pub n_deg_rt_h: f64,
    /// Flicker B, deg/h. The floor of the Allan deviation is 0.664 B.
    #[key(name = "B_deg_h", range = COEFFICIENT_RANGE, default = 0.0, example = 0.0017)]
    pub b_deg_h: f64,
    /// Rate random walk K, deg/h/√h.
    #[key(name = "K_deg_h_rt_h", range = COEFFICIENT_RANGE, default = 0.0, example = 0.0009)]
    pub k_deg_h_rt_h: f64,
    /// Angle increment of the output, arcsec; 0 for none.
    #[key(range = COEFFICIENT_RANGE, default = 0.0, example = 0.01)]
    pub quantization_lsb_arcsec: f64,
}

/// The constant part of the rate.
#[derive(Table)]
#[table("bias")]
pub(super) struct BiasKeys {
    /// Bias, deg/h.
    #[key(range = SIGNED_RANGE, default = 0.0, example = -3.1)]
    pub value_deg_h: f64,
}

/// Dependence of the bias on the recorded temperature: coefficient · (temp_degC − reference).
#[derive(Table)]
#[table("temperature")]
pub(super) struct TemperatureKeys {
    /// Coefficient, deg/h/°C.
    #[key(name = "coefficient_deg_h_per_degC", range = SIGNED_RANGE, example = 1.2e-4)]
    pub coefficient_deg_h_per_degc: f64,
    /// Temperature at which the bias holds, °C.
    #[key(name = "reference_degC", min = -273.15, max = 1000, default = 20.0, example = 20.0)]
    pub reference_degc: f64,
}

/// The scale factor: 3600 (1 + 10⁻⁶ error) · table_rate_deg_s.
#[derive(Table)]
#[table("scale_factor")]
pub(super) struct ScaleFactorKeys {
    /// Known error, already part of the claim, ppm.
    #[key(min = -1e6, max = 1e6, default = 0.0, example = 12.0)]
    pub error_ppm: f64,
}

/// Earth rate in the plane of the table: 15.041067 cos(latitude) cos(table_angle_deg + azimuth), deg/h.
#[derive(Table)]
#[table("earth")]
pub(super) struct EarthKeys {
    /// Geographic latitude, deg.
    #[key(min = -90, max = 90, example = 55.98)]
    pub latitude_deg: f64,
    /// Heading of the input axis at table angle 0, deg.
    #[key(min = -360, max = 360, default = 0.0, example = 12.3)]
    pub azimuth_deg: f64,
}

/// One standard deviation of the author's knowledge of each value; omitted values are exact. The bias is always
/// free.
#[derive(Table)]
#[table("uncertainty")]
pub(super) struct UncertaintyKeys {
    /// Of N, relative.
    #[key(name = "N_rel", range = COEFFICIENT_RANGE, default = 0.0, example = 0.015)]
    pub n_rel: f64,
    /// Of B, relative.
    #[key(name = "B_rel", range = COEFFICIENT_RANGE, default = 0.0, example = 0.12)]
    pub b_rel: f64,
    /// Of K, relative.
    #[key(name = "K_rel", range = COEFFICIENT_RANGE, default = 0.0, example = 0.15)]
    pub k_rel: f64,
    /// Of N where it is stated as 0, deg/√h: the value is positive and within about two of these.
    #[key(name = "N_deg_rt_h", range = COEFFICIENT_RANGE, default = 0.0, example = 0.001)]
    pub n_deg_rt_h: f64,
    /// Of B where it is stated as 0, deg/h.
    #[key(name = "B_deg_h", range = COEFFICIENT_RANGE, default = 0.0, example = 0.002)]
    pub b_deg_h: f64,
    /// Of K where it is stated as 0, deg/h/√h.
    #[key(name = "K_deg_h_rt_h", range = COEFFICIENT_RANGE, default = 0.0, example = 0.0005)]
    pub k_deg_h_rt_h: f64,
    /// Upper limit (95 %) of N where it is stated as 0 because a record did not resolve it, deg/√h.
    #[key(name = "N_at_most_deg_rt_h", range = COEFFICIENT_RANGE, default = 0.0, example = 0.003)]
    pub n_at_most_deg_rt_h: f64,
    /// Upper limit (95 %) of B where it is stated as 0 because a record did not resolve it, deg/h.
    #[key(name = "B_at_most_deg_h", range = COEFFICIENT_RANGE, default = 0.0, example = 0.004)]
    pub b_at_most_deg_h: f64,
    /// Upper limit (95 %) of K where it is stated as 0 because a record did not resolve it, deg/h/√h.
    #[key(name = "K_at_most_deg_h_rt_h", range = COEFFICIENT_RANGE, default = 0.0, example = 0.001)]
    pub k_at_most_deg_h_rt_h: f64,
    /// Of the bias, deg/h.
    #[key(range = COEFFICIENT_RANGE, default = 0.0, example = 0.03)]
    pub bias_deg_h: f64,
    /// Of the temperature coefficient, deg/h/°C.
    #[key(name = "temperature_coefficient_deg_h_per_degC", range = COEFFICIENT_RANGE, default = 0.0, example = 1e-6)]
    pub temperature_coefficient_deg_h_per_degc: f64,
    /// Of the scale factor, ppm.
    #[key(range = COEFFICIENT_RANGE, default = 0.0, example = 2.0)]
    pub scale_factor_ppm: f64,
    /// Largest skewness of the noise of single samples, of either sign: the third central moment over the cube of
    /// the standard deviation. 0: the law is even.
    #[key(range = COEFFICIENT_RANGE, default = 0.0, example = 0.02)]
    pub skewness: f64,
}

/// An effect that the claim states. `sagnac effects` lists the kinds, `sagnac effects KIND` the parameters of one.
#[derive(Table)]
#[table("effect")]
pub(crate) struct EffectKeys {
    /// Kind of the effect.
    #[key(id, required, example = "line")]
    pub kind: Option<String>,
    /// Its parameters by name, in a table [effect.parameters].
    pub parameters: Vec<Named>,
    #[key(section)]
    pub section: Section,
}

/// What `simulate` makes when the command line does not say. The claim itself does not depend on it.
#[derive(Table)]
#[table("simulation")]
pub(super) struct SimulationKeys {
    /// Length, s.
    #[key(above = 0, example = 36000)]
    pub duration_s: Option<f64>,
    /// Seed, a whole number: equal seeds give equal recordings.
    #[key(min = 0, max = 9_007_199_254_740_992, example = 1)]
    pub seed: Option<f64>,
    /// `time_s` of the first sample, s.
    #[key(range = SIGNED_RANGE, default = 0.0, example = 0.0)]
    pub start_s: f64,
    #[key(section)]
    pub section: Section,
}

/// The profile of a column: straight lines between points, the first and last value held outside, plus a sine.
#[derive(Table)]
#[table("driver")]
pub(super) struct DriverKeys {
    /// The column.
    #[key(required, example = "temp_degC")]
    pub column: Option<Column>,
    /// Times of the points on `time_s`, increasing; two equal ones make a step.
    #[key(range = SIGNED_RANGE, default = [0.0], example = [0.0, 600.0, 7200.0])]
    pub time_s: Option<Vec<f64>>,
    /// Values there, in the unit of the column.
    #[key(range = SIGNED_RANGE, default = [0.0], example = [20.0, 20.0, 60.0])]
    pub value: Option<Vec<f64>>,
    /// Amplitude of the sine, in the unit of the column.
    #[key(range = SIGNED_RANGE, default = 0.0, example = 0.5)]
    pub sine_amplitude: f64,
    /// Period of the sine, s.
    #[key(above = 0, example = 1800.0)]
    pub sine_period_s: Option<f64>,
    /// Phase of the sine at `time_s` = 0, deg.
    #[key(range = SIGNED_RANGE, default = 0.0, example = 90.0)]
    pub sine_phase_deg: f64,
    /// Standard deviation of the sensor's white noise, in the unit of the column: added to the column, not to what
    /// the gyro senses.
    #[key(range = COEFFICIENT_RANGE, default = 0.0, example = 0.003)]
    pub noise: f64,
    #[key(section)]
    pub section: Section,
}
