//! A schedule as a TOML file. Reading it gives the same schedule to the bit.

use super::tables::ScheduleTables;
use super::{Schedule, Step};
use crate::config::table::Table;
use std::fmt::Write as _;

/// The text of a schedule.
pub fn write(schedule: &Schedule) -> String {
    let mut out = format!("format = \"{}\"\n", ScheduleTables::FORMAT);
    let start = &schedule.start;
    let keys = [
        ("temp_degC", start.temp_degc),
        ("table_rate_deg_s", start.table_rate_deg_s),
        ("table_angle_deg", start.table_angle_deg),
    ];
    if keys.iter().any(|(_, value)| value.is_some()) {
        out.push_str("\n[start]\n");
    }
    for (key, value) in keys {
        if let Some(value) = value {
            let _ = writeln!(out, "{key} = {value:?}");
        }
    }
    for step in &schedule.steps {
        out.push_str("\n[[step]]\n");
        for (key, value) in keys_of(step) {
            let _ = writeln!(out, "{key} = {value}");
        }
    }
    out
}

/// The keys of a step with their values as TOML.
fn keys_of(step: &Step) -> Vec<(&'static str, String)> {
    let number = |value: &f64| format!("{value:?}");
    let list = |values: &[f64]| format!("[{}]", values.iter().map(number).collect::<Vec<_>>().join(", "));
    let does = |word: &str| ("do", format!("\"{word}\""));
    match step {
        Step::Hold { duration_h } => vec![does("hold"), ("duration_h", number(duration_h))],
        Step::Ramp { to_degc, rate_degc_per_h } => {
            vec![does("ramp"), ("to_degC", number(to_degc)), ("rate_degC_per_h", number(rate_degc_per_h))]
        }
        Step::Cycle { low_degc, high_degc, rate_degc_per_h, soak_h, count } => vec![
            does("cycle"),
            ("low_degC", number(low_degc)),
            ("high_degC", number(high_degc)),
            ("rate_degC_per_h", number(rate_degc_per_h)),
            ("soak_h", number(soak_h)),
            ("count", count.to_string()),
        ],
        Step::TableRates { rates_deg_s, dwell_s, count } => vec![
            does("table_rates"),
            ("rates_deg_s", list(rates_deg_s)),
            ("dwell_s", number(dwell_s)),
            ("count", count.to_string()),
        ],
        Step::Headings { angles_deg, dwell_s, count } => vec![
            does("headings"),
            ("angles_deg", list(angles_deg)),
            ("dwell_s", number(dwell_s)),
            ("count", count.to_string()),
        ],
    }
}
