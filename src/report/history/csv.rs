//! A history as a table: one row a result and measurand; the same in every language.

use crate::output::csv_line;
use crate::record::MeasurandRecord;
use crate::store::Attempt;

/// How a column gets its text of a result and one of its measurands.
type Field = fn(&Attempt, &MeasurandRecord) -> String;

/// The columns, in their order.
const HISTORY_COLUMNS: &[(&str, Field)] = &[
    ("evaluated_at", |a, _| a.entry.test.evaluated_at.clone()),
    ("serial", |a, _| a.entry.unit.serial.clone()),
    ("model", |a, _| a.entry.unit.model.clone()),
    ("lot", |a, _| a.entry.unit.lot.clone()),
    ("reference", |a, _| a.entry.unit.reference.to_string()),
    ("procedure", |a, _| a.entry.test.procedure.clone()),
    ("revision", |a, _| a.entry.test.revision.clone()),
    ("station", |a, _| a.entry.test.station.clone()),
    ("operator", |a, _| a.entry.test.operator.clone()),
    ("attempt", |a, _| a.number.to_string()),
    ("verdict", |a, _| a.entry.verdict.id().to_owned()),
    ("measurand", |_, m| m.id.clone()),
    ("channel", |_, m| m.channel.clone()),
    ("phase", |_, m| m.phase.clone().unwrap_or_default()),
    ("unit", |_, m| m.unit.clone()),
    ("value", |_, m| number(m.value)),
    ("low", |_, m| number(m.interval.map(|i| i.low))),
    ("high", |_, m| number(m.interval.map(|i| i.high))),
    ("upper_limit", |_, m| number(m.upper_limit.map(|u| u.value))),
    ("limit_min", |_, m| number(m.limits().min)),
    ("limit_max", |_, m| number(m.limits().max)),
    ("measurand_verdict", |_, m| m.verdict.id().to_owned()),
    ("superseded_by", |a, _| a.superseded.as_ref().map(|c| c.by.clone()).unwrap_or_default()),
    ("address", |a, _| a.address.clone()),
];

fn number(value: Option<f64>) -> String {
    value.map_or_else(String::new, |v| v.to_string())
}

/// The table of some results; of one measurand only where it is named.
pub fn csv(attempts: &[Attempt], measurand: Option<&str>) -> String {
    let mut out = csv_line(HISTORY_COLUMNS.iter().map(|(name, _)| *name));
    for a in attempts {
        for m in a.entry.measurands.iter().filter(|m| measurand.is_none_or(|id| m.id == id)) {
            out.push_str(&csv_line(HISTORY_COLUMNS.iter().map(|(_, of)| of(a, m))));
        }
    }
    out
}
