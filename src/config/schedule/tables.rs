//! The tables of a schedule.

use crate::config::spec::{Kind, Range, TableSpec, Word, optional, required};

/// Version of the format.
pub const SCHEDULE_FORMAT: &str = "schedule/1";

/// A schedule as a whole.
pub static SCHEDULE_FILE: TableSpec = TableSpec {
    name: "",
    doc: "A schedule: what chamber and table do in a test, step after step. `sagnac simulate --schedule` makes a recording of it.",
    keys: &[
        required("format", Kind::Format(SCHEDULE_FORMAT), "\"schedule/1\"", "Version of the format."),
        optional("start", Kind::Table(&START), "", "Where chamber and table begin."),
        required("step", Kind::Tables(&STEP), "", "The steps in their order, one table each."),
    ],
};

const TEMPERATURE: Range = Range::between(-273.15, 1000.0);
const TABLE_RATE: Range = Range::between(-1e5, 1e5);
const ANGLE: Range = Range::between(-1e6, 1e6);
const HOURS: Range = Range::above_up_to(0.0, 1e6);
const SECONDS: Range = Range::above_up_to(0.0, 1e9);

static START: TableSpec = TableSpec {
    name: "start",
    doc: "Where chamber and table begin. A column that is not named here, and that no step moves, is not recorded.",
    keys: &[
        optional("temp_degC", Kind::Number(TEMPERATURE), "20.0", "Temperature, degC."),
        optional("table_rate_deg_s", Kind::Number(TABLE_RATE), "0.0", "Rate of the table, deg/s."),
        optional("table_angle_deg", Kind::Number(ANGLE), "0.0", "Angle of the table, deg."),
    ],
};

/// What a step does.
const DOES: &[Word] = &[
    ("hold", "Everything stays where it is, for `duration_h`"),
    ("ramp", "The chamber goes `to_degC` at `rate_degC_per_h`"),
    (
        "cycle",
        "The chamber goes to `low_degC`, then `count` times to `high_degC` and back, with a soak of `soak_h` at each end",
    ),
    ("table_rates", "The table turns at each of `rates_deg_s` for `dwell_s`, `count` times, then stands"),
    ("headings", "The table stands at each of `angles_deg` for `dwell_s`, `count` times"),
];

static STEP: TableSpec = TableSpec {
    name: "step",
    doc: "One step. What it does not move stays where it is.",
    keys: &[
        required("do", Kind::Choice(DOES), "\"ramp\"", "What it does."),
        optional("duration_h", Kind::Number(HOURS), "1.0", "Length of a hold, h."),
        optional("to_degC", Kind::Number(TEMPERATURE), "60.0", "Where a ramp ends, degC."),
        optional("low_degC", Kind::Number(TEMPERATURE), "10.0", "Low end of a cycle, degC."),
        optional("high_degC", Kind::Number(TEMPERATURE), "50.0", "High end of a cycle, degC."),
        optional(
            "rate_degC_per_h",
            Kind::Number(Range::above_up_to(0.0, 1e4)),
            "30.0",
            "Rate of a ramp or a cycle, degC/h, without sign.",
        ),
        optional(
            "soak_h",
            Kind::Number(Range::between(0.0, 1e6)),
            "0.5",
            "Soak at each end of a cycle, h; none where left out.",
        ),
        optional(
            "rates_deg_s",
            Kind::Numbers(TABLE_RATE),
            "[0.0, 10.0, -10.0]",
            "Rates of the table, deg/s.",
        ),
        optional(
            "angles_deg",
            Kind::Numbers(ANGLE),
            "[0.0, 90.0, 180.0, 270.0]",
            "Angles of the table, deg.",
        ),
        optional("dwell_s", Kind::Number(SECONDS), "300.0", "How long a rate or an angle is held, s."),
        optional(
            "count",
            Kind::Number(Range::between(1.0, 10_000.0)),
            "3",
            "How many times, a whole number; once where left out.",
        ),
    ],
};
