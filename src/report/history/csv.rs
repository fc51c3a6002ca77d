//! A history as a table: one row a result and measurand; the same in every language.

use crate::output::csv_line;
use crate::store::Attempt;

/// The columns.
const HISTORY_COLUMNS: [&str; 24] = [
    "evaluated_at",
    "serial",
    "model",
    "lot",
    "reference",
    "procedure",
    "revision",
    "station",
    "operator",
    "attempt",
    "verdict",
    "measurand",
    "channel",
    "phase",
    "unit",
    "value",
    "low",
    "high",
    "upper_limit",
    "limit_min",
    "limit_max",
    "measurand_verdict",
    "superseded_by",
    "address",
];

/// The table of some results; of one measurand only where it is named.
pub fn csv(attempts: &[Attempt], measurand: Option<&str>) -> String {
    let mut out = csv_line(HISTORY_COLUMNS);
    let number = |v: Option<f64>| v.map_or_else(String::new, |v| v.to_string());
    for a in attempts {
        let (unit, test) = (&a.entry.unit, &a.entry.test);
        for m in a.entry.measurands.iter().filter(|m| measurand.is_none_or(|id| m.id == id)) {
            let fields = [
                test.evaluated_at.clone(),
                unit.serial.clone(),
                unit.model.clone(),
                unit.lot.clone(),
                unit.reference.to_string(),
                test.procedure.clone(),
                test.revision.clone(),
                test.station.clone(),
                test.operator.clone(),
                a.number.to_string(),
                a.entry.verdict.id().to_owned(),
                m.id.clone(),
                m.channel.clone(),
                m.phase.clone().unwrap_or_default(),
                m.unit.clone(),
                number(m.value),
                number(m.interval.map(|i| i.low)),
                number(m.interval.map(|i| i.high)),
                number(m.upper_limit.map(|u| u.value)),
                number(m.limits().min),
                number(m.limits().max),
                m.verdict.id().to_owned(),
                a.superseded.as_ref().map(|c| c.by.clone()).unwrap_or_default(),
                a.address.clone(),
            ];
            out.push_str(&csv_line(&fields));
        }
    }
    out
}
