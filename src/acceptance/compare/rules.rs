//! Allan bias instability under each read-out rule, with the ratio of the Russian drift to it.

use super::unit::{ReadOutRule, RuleRow, Unit};
use crate::estimate::{Interval, UpperLimit};
use crate::measurand;
use crate::record::MeasurandRecord;

/// √(2 ln 2/π): the Allan floor of flicker noise is this times B.
const FLOOR_OF_FLICKER: f64 = 0.664_282_470_3;

/// The rules: the measurand each is read from, and the factor on it.
const READ_OUT_RULES: [(ReadOutRule, &str, f64); 4] = [
    (ReadOutRule::Minimum, measurand::BIAS_INSTABILITY_MINIMUM.id, 1.0),
    (ReadOutRule::ScaledMinimum, measurand::BIAS_INSTABILITY_MINIMUM_SCALED.id, 1.0),
    (ReadOutRule::FittedB, measurand::BIAS_INSTABILITY.id, 1.0),
    (ReadOutRule::FittedFloor, measurand::BIAS_INSTABILITY.id, FLOOR_OF_FLICKER),
];

/// The rows of a unit; a rule whose measurand the result lacks has no row.
pub(super) fn rules(unit: &Unit) -> Vec<RuleRow> {
    let drift = unit.quantity(measurand::RUSSIAN_DRIFT_100S.id);
    READ_OUT_RULES
        .into_iter()
        .filter_map(|(rule, id, factor)| {
            let q = unit.quantity(id)?;
            let scaled = |i: Interval| Interval { low: i.low * factor, high: i.high * factor, ..i };
            let of_minimum =
                unit.quantity(measurand::RATIO_RUSSIAN_TO_ALLAN_BIAS.id).and_then(|r| r.interval);
            let sigma = drift.and_then(|d| d.value);
            let value = q.value.map(|v| v * factor);
            let limit = q.upper_limit.map(|u| UpperLimit { value: u.value * factor, ..u });
            let ratio = sigma.zip(value.or(limit.map(|l| l.value))).map(|(s, v)| s / v);
            let ratio_interval = match rule {
                ReadOutRule::Minimum => of_minimum,
                ReadOutRule::ScaledMinimum => of_minimum.map(|i| Interval {
                    low: i.low * FLOOR_OF_FLICKER,
                    high: i.high * FLOOR_OF_FLICKER,
                    ..i
                }),
                _ => drift.and_then(|d| quotient(d, q, 1.0 / factor)),
            };
            Some(RuleRow {
                rule,
                value,
                interval: q.interval.filter(|_| q.value.is_some()).map(scaled),
                upper_limit: limit.filter(|_| q.value.is_none()),
                ratio: ratio.filter(|r| r.is_finite()),
                ratio_interval: ratio_interval.filter(|_| q.value.is_some()),
                inverse: ratio.map(|r| 1.0 / r).filter(|r| r.is_finite() && q.value.is_some()),
            })
        })
        .collect()
}

/// The interval of a quotient of two positive quantities: half-widths in the logarithm add as squares.
fn quotient(above: &MeasurandRecord, below: &MeasurandRecord, factor: f64) -> Option<Interval> {
    let (a, b) = (above.value?, below.value?);
    let (ia, ib) = (above.interval?, below.interval?);
    if [a, b, ia.low, ib.low].iter().any(|v| *v <= 0.0) {
        return None;
    }
    let up = (ia.high / a).ln().hypot((b / ib.low).ln());
    let down = (a / ia.low).ln().hypot((ib.high / b).ln());
    let ratio = factor * a / b;
    Some(Interval { low: ratio * (-down).exp(), high: ratio * up.exp(), coverage: ia.coverage })
}
