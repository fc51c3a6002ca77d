//! The tables of a schedule.

use crate::config::section::Section;
use crate::config::spec::{Range, TableSpec, Word};
use crate::config::table::Table;

/// A schedule as a whole.
pub static SCHEDULE_FILE: TableSpec = *ScheduleTables::SPEC;

/// Ranges of temperature, degC; rate of the table, deg/s; angle of the table, deg; and of lengths of time.
const TEMPERATURE_DEG_C: Range = Range::between(-273.15, 1000.0);
const TABLE_RATE_DEG_S: Range = Range::between(-1e5, 1e5);
const ANGLE_DEG: Range = Range::between(-1e6, 1e6);
const LENGTH_H: Range = Range::above_up_to(0.0, 1e6);
const LENGTH_S: Range = Range::above_up_to(0.0, 1e9);

/// A schedule: what chamber and table do in a test, step after step. `sagnac simulate --schedule` makes a recording
/// of it.
#[derive(Table)]
#[table("", format = "schedule/1")]
pub(super) struct ScheduleTables {
    /// Where chamber and table begin.
    #[key(optional)]
    pub start: StartKeys,
    /// The steps in their order, one table each.
    #[key(name = "step", required)]
    pub steps: Vec<StepKeys>,
}

/// Where chamber and table begin. A column that is not named here, and that no step moves, is not recorded.
#[derive(Table)]
#[table("start")]
pub(super) struct StartKeys {
    /// Temperature, degC.
    #[key(name = "temp_degC", range = TEMPERATURE_DEG_C, example = 20.0)]
    pub temp_degc: Option<f64>,
    /// Rate of the table, deg/s.
    #[key(range = TABLE_RATE_DEG_S, example = 0.0)]
    pub table_rate_deg_s: Option<f64>,
    /// Angle of the table, deg.
    #[key(range = ANGLE_DEG, example = 0.0)]
    pub table_angle_deg: Option<f64>,
}

/// Kinds of steps.
const STEP_KINDS: &[Word] = &[
    ("hold", "Everything stays where it is, for `duration_h`"),
    ("ramp", "The chamber goes `to_degC` at `rate_degC_per_h`"),
    (
        "cycle",
        "The chamber goes to `low_degC`, then `count` times to `high_degC` and back, with a soak of `soak_h` at each end",
    ),
    ("table_rates", "The table turns at each of `rates_deg_s` for `dwell_s`, `count` times, then stands"),
    ("headings", "The table stands at each of `angles_deg` for `dwell_s`, `count` times"),
];

/// One step. What it does not move stays where it is.
#[derive(Table)]
#[table("step")]
pub(super) struct StepKeys {
    /// What it does.
    #[key(name = "do", choice = STEP_KINDS, required, example = "ramp")]
    pub does: Option<&'static str>,
    /// Length of a hold, h.
    #[key(range = LENGTH_H, example = 1.0)]
    pub duration_h: Option<f64>,
    /// Where a ramp ends, degC.
    #[key(name = "to_degC", range = TEMPERATURE_DEG_C, example = 60.0)]
    pub to_degc: Option<f64>,
    /// Low end of a cycle, degC.
    #[key(name = "low_degC", range = TEMPERATURE_DEG_C, example = 10.0)]
    pub low_degc: Option<f64>,
    /// High end of a cycle, degC.
    #[key(name = "high_degC", range = TEMPERATURE_DEG_C, example = 50.0)]
    pub high_degc: Option<f64>,
    /// Rate of a ramp or a cycle, degC/h, without sign.
    #[key(name = "rate_degC_per_h", above = 0, max = 1e4, example = 30.0)]
    pub rate_degc_per_h: Option<f64>,
    /// Soak at each end of a cycle, h; none where left out.
    #[key(min = 0, max = 1e6, example = 0.5)]
    pub soak_h: Option<f64>,
    /// Rates of the table, deg/s.
    #[key(range = TABLE_RATE_DEG_S, example = [0.0, 10.0, -10.0])]
    pub rates_deg_s: Vec<f64>,
    /// Angles of the table, deg.
    #[key(range = ANGLE_DEG, example = [0.0, 90.0, 180.0, 270.0])]
    pub angles_deg: Vec<f64>,
    /// How long a rate or an angle is held, s.
    #[key(range = LENGTH_S, example = 300.0)]
    pub dwell_s: Option<f64>,
    /// How many times, a whole number; once where left out.
    #[key(min = 1, max = 10_000, example = 3)]
    pub count: Option<f64>,
    #[key(section)]
    pub section: Section,
}
