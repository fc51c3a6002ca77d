//! One quantity over the units of a lot.

use super::outlook::{outlook, risks};
use super::units::TestedUnit;
use crate::estimate::{Interval, UpperLimit, normal_quantile};
use crate::i18n::{Arg, Note, note};
use crate::lot::population::{
    Central, LEAST_VALUES, LOTS_FOR_SPREAD, Method, NOT_NORMAL, Of, Population, Reading, Side, Unit,
};
use crate::lot::tolerance::Promise;
use crate::measurand;
use crate::record::{
    LimitRecord, MeasurandRecord, Message, SheetBound, SheetLargest, SheetLimit, SheetOf, SheetOutlook,
    SheetQuantity, SheetScale, SheetShare, SheetSide, SheetSpread, SheetTypical, SheetValue,
};
use rayon::prelude::*;

/// Coverage of the intervals of medians and shares.
const INTERVAL_COVERAGE: f64 = 0.95;

/// What tells one quantity from another.
type Key<'a> = (Option<&'a str>, &'a str, &'a str);

fn key(m: &MeasurandRecord) -> Key<'_> {
    (m.phase.as_deref(), m.channel.as_str(), m.id.as_str())
}

/// The quantities, in the order in which they first appear.
pub(super) fn quantities(units: &[TestedUnit], promise: Promise) -> Vec<SheetQuantity> {
    let mut keys: Vec<Key<'_>> = vec![];
    for m in units.iter().flat_map(|u| &u.result.measurands) {
        // The Earth rate is one of the site, not of the units.
        if m.id != measurand::EARTH_RATE_COMPONENT.id && !keys.contains(&key(m)) {
            keys.push(key(m));
        }
    }
    // Each depends on no other.
    let each: Vec<Option<SheetQuantity>> =
        keys.into_par_iter().map(|k| quantity(k, units, promise)).collect();
    each.into_iter().flatten().collect()
}

/// What one unit tells of a quantity.
struct Row<'a> {
    unit: &'a TestedUnit,
    told: &'a MeasurandRecord,
}

impl Row<'_> {
    fn value(&self) -> Option<f64> {
        self.told.value.filter(|v| self.told.identifiable && v.is_finite())
    }

    /// The bound, where there is no value.
    fn bound(&self) -> Option<UpperLimit> {
        let limit = self.told.upper_limit.filter(|_| self.value().is_none())?;
        let right = limit.value.is_finite() && limit.coverage > 0.5 && limit.coverage < 1.0;
        right.then_some(limit)
    }

    /// The likelihood of a bounded quantity where its peak is told: normal, with the bound at its coverage.
    fn likelihood(&self, bound: UpperLimit, scale: SheetScale) -> Option<Reading> {
        let peak = self.told.most_likely.filter(|m| m.is_finite() && *m < bound.value)?;
        let z = normal_quantile(bound.coverage);
        match scale {
            SheetScale::Linear => Some(Reading::Value { value: peak, standard: (bound.value - peak) / z }),
            SheetScale::Log => (peak > 0.0)
                .then(|| Reading::Value { value: peak.ln(), standard: (bound.value / peak).ln() / z }),
        }
    }

    /// Part of the standard uncertainty on a scale that all units have in common; `None` where the result does not say.
    fn common(&self, scale: SheetScale) -> Option<f64> {
        let stated = self.told.common_standard_uncertainty.filter(|u| *u >= 0.0 && u.is_finite())?;
        match scale {
            SheetScale::Linear => Some(stated),
            SheetScale::Log => Some(stated / self.value()?),
        }
    }

    /// Standard uncertainty of the value on a scale without what all units have in common; `None` without an interval.
    fn own(&self, scale: SheetScale) -> Option<f64> {
        let (whole, common) = (self.standard(scale)?, self.common(scale).unwrap_or(0.0));
        Some((whole * whole - common * common).max(0.0).sqrt())
    }

    /// Standard uncertainty of the value on a scale; `None` without an interval.
    fn standard(&self, scale: SheetScale) -> Option<f64> {
        let (value, interval) = (self.value()?, self.told.interval?);
        let inside = interval.coverage > 0.0 && interval.coverage < 1.0 && interval.high >= interval.low;
        let reach = 2.0 * normal_quantile(0.5 + 0.5 * interval.coverage);
        let width = match scale {
            SheetScale::Linear => interval.high - interval.low,
            SheetScale::Log if interval.low > 0.0 => (interval.high / interval.low).ln(),
            SheetScale::Log => (interval.high - interval.low) / value,
        };
        let standard = width / reach;
        (inside && standard.is_finite()).then_some(standard)
    }
}

fn quantity(of: Key<'_>, units: &[TestedUnit], promise: Promise) -> Option<SheetQuantity> {
    let rows: Vec<Row<'_>> = units
        .iter()
        .flat_map(|unit| {
            let own = unit.result.measurands.iter().filter(|m| key(m) == of);
            own.take(1).map(move |told| Row { unit, told })
        })
        .filter(|r| r.value().is_some() || r.bound().is_some())
        .collect();
    let unit = rows.first()?.told.unit.clone();
    let (rows, others): (Vec<Row<'_>>, Vec<Row<'_>>) = rows.into_iter().partition(|r| r.told.unit == unit);
    let mut notes: Vec<Note> = vec![];
    if !others.is_empty() {
        notes.push(note!("datasheet.note.other_unit", n = others.len(), unit = unit.as_str()));
    }
    let scale = scale(of.2, &rows);
    let lots = lots(&rows);
    let count = lots.iter().max().map_or(0, |l| l + 1);
    let bounded = rows.iter().filter(|r| r.value().is_none()).count();
    // Where most units are only bounded, the shape of their likelihoods would decide instead of the units.
    let valued = rows.len() - bounded;
    let needed = LEAST_VALUES.max(rows.len().div_ceil(2));
    let on_scale = on_scale(&rows, &lots, scale, &mut notes);
    let common = common(&rows, scale);
    let population = if valued >= needed { Population::of(&on_scale) } else { None };
    let population = population.map(|p| p.with_common_error(common.unwrap_or(0.0)));
    let signed = measurand::find(of.2).map_or(scale == SheetScale::Linear, |m| m.signed);
    let sides: &[Side] = if signed { &[Side::Upper, Side::Lower] } else { &[Side::Upper] };
    match &population {
        Some(p) => {
            say(&mut notes, p, bounded, count, scale);
            notes.extend(said_of_common(common, &rows, scale));
        }
        None => notes.push(note!("datasheet.note.too_few", n = valued, needed)),
    }
    let back = |v: f64| if scale == SheetScale::Log { v.exp() } else { v };
    let to = |v: f64| if scale == SheetScale::Log { v.ln() } else { v };
    let limit = limit(&rows, population.as_ref(), scale);
    let bounds = population.as_ref().map(|p| bounds(p, sides, promise, &back)).unwrap_or_default();
    let measured = |side: SheetSide| bounds.iter().find(|b| b.of == SheetOf::Measured && b.side == side);
    let upper = measured(SheetSide::Upper).map(|b| b.value);
    let outlook = sides.iter().filter_map(|side| {
        let told = if *side == Side::Upper { SheetSide::Upper } else { SheetSide::Lower };
        let bound = measured(told)?.value;
        let more = outlook(population.as_ref()?, rows.len(), to(bound), *side, promise)?;
        Some(SheetOutlook { value: back(more.value), ..more })
    });
    let outlook = outlook.collect();
    let risks = population.as_ref().zip(limit.and_then(|l| l.max)).map(|(p, max)| risks(p, to(max)));
    Some(SheetQuantity {
        id: of.2.to_owned(),
        channel: of.1.to_owned(),
        phase: of.0.map(str::to_owned),
        name: None,
        footnote: None,
        unit,
        units: rows.len(),
        lots: count,
        bounded,
        reading: reading(&rows),
        scale,
        typical: population.as_ref().map(|p| {
            let Central { value, low, high } = p.typical(INTERVAL_COVERAGE);
            let interval = Interval { low: back(low), high: back(high), coverage: INTERVAL_COVERAGE };
            SheetTypical { value: back(value), interval }
        }),
        spread: population.as_ref().map(|p| SheetSpread {
            between_units: p.between_units(),
            between_lots: p.between_lots(),
            measurement: p.measurement(),
        }),
        share_above_bound: population.as_ref().zip(upper).map(|(p, u)| share_above(p, to(u))),
        bounds,
        outlook,
        largest: largest(&rows),
        limit,
        risks: risks.unwrap_or_default(),
        normality: population.as_ref().and_then(Population::normality),
        values: rows.iter().map(value).collect(),
        notes: notes.into_iter().map(Message::from).collect(),
    })
}

/// How the quantity was read, where all results say the same.
fn reading(rows: &[Row<'_>]) -> Option<String> {
    let first = &rows.first()?.told.method;
    (!first.is_empty() && rows.iter().all(|r| r.told.method == *first)).then(|| first.clone())
}

/// The scale on which the units scatter: the logarithm of what is never negative.
fn scale(id: &str, rows: &[Row<'_>]) -> SheetScale {
    let signed = measurand::find(id).is_some_and(|m| m.signed);
    let positive = rows.iter().all(|r| r.value().or(r.bound().map(|b| b.value)).is_none_or(|v| v > 0.0));
    if positive && !signed { SheetScale::Log } else { SheetScale::Linear }
}

/// The error that the units have in common on a scale: the largest that a result states. `None` where one does not say.
fn common(rows: &[Row<'_>], scale: SheetScale) -> Option<f64> {
    let valued = rows.iter().filter(|r| r.value().is_some());
    valued.map(|r| r.common(scale)).try_fold(0.0, |most: f64, u| Some(most.max(u?)))
}

/// A note on the error in common: how large it is, or that nothing is known of one.
fn said_of_common(common: Option<f64>, rows: &[Row<'_>], scale: SheetScale) -> Option<Note> {
    let unit = rows.first()?.told.unit.as_str();
    let with = |key: &'static str, u: f64| {
        let (value, unit) = if scale == SheetScale::Log { (100.0 * u, "%") } else { (u, unit) };
        Note::new(key).with("u", Arg::figures(value, 2)).with("unit", unit)
    };
    match common {
        Some(u) if u > 0.0 => Some(with("datasheet.note.common_error", u)),
        Some(_) => None,
        None => {
            let largest = rows.iter().filter_map(|r| r.standard(scale)).fold(0.0, f64::max);
            (largest > 0.0).then(|| with("datasheet.note.common_unknown", largest))
        }
    }
}

/// Number of the lot of each row.
fn lots(rows: &[Row<'_>]) -> Vec<usize> {
    let mut names: Vec<&str> = vec![];
    rows.iter()
        .map(|r| {
            names.iter().position(|n| *n == r.unit.lot_name()).unwrap_or_else(|| {
                names.push(r.unit.lot_name());
                names.len() - 1
            })
        })
        .collect()
}

/// The units on the scale. A bounded unit is given the uncertainty that the others have in the middle.
fn on_scale(rows: &[Row<'_>], lots: &[usize], scale: SheetScale, notes: &mut Vec<Note>) -> Vec<Unit> {
    let mut known: Vec<f64> = rows.iter().filter_map(|r| r.own(scale)).collect();
    let without = rows.iter().filter(|r| r.value().is_some()).count() - known.len();
    if without > 0 {
        notes.push(note!("datasheet.note.no_interval", n = without));
    }
    let usual = crate::numeric::order::upper_median(&mut known);
    let to = |v: f64| if scale == SheetScale::Log { v.ln() } else { v };
    rows.iter()
        .zip(lots)
        .filter_map(|(row, lot)| {
            let reading = match (row.value(), row.bound()) {
                (Some(v), _) => Reading::Value { value: to(v), standard: row.own(scale).unwrap_or(0.0) },
                (None, Some(bound)) => row
                    .likelihood(bound, scale)
                    .unwrap_or(Reading::AtMost { bound: to(bound.value), standard: usual }),
                (None, None) => return None,
            };
            Some(Unit { lot: *lot, reading })
        })
        .collect()
}

fn bounds(p: &Population, sides: &[Side], promise: Promise, back: &dyn Fn(f64) -> f64) -> Vec<SheetBound> {
    let each = [Of::True, Of::Measured].into_iter().flat_map(|of| sides.iter().map(move |side| (of, *side)));
    each.filter_map(|(of, side)| {
        let found = p.bound(of, side, promise)?;
        Some(SheetBound {
            of: if of == Of::True { SheetOf::True } else { SheetOf::Measured },
            side: if side == Side::Upper { SheetSide::Upper } else { SheetSide::Lower },
            value: back(found.value),
            proportion: promise.proportion,
            confidence: promise.confidence,
            method: method(found.method).to_owned(),
        })
    })
    .filter(|b| b.value.is_finite())
    .collect()
}

fn method(method: Method) -> &'static str {
    match method {
        Method::ExactNormal => "exact_normal",
        Method::NormalWithErrors => "normal_with_errors",
        Method::OrderStatistic => "order_statistic",
        Method::HansonKoopmans => "hanson_koopmans",
    }
}

/// What must be known with the quantity.
fn say(notes: &mut Vec<Note>, p: &Population, bounded: usize, lots: usize, scale: SheetScale) {
    if bounded > 0 {
        notes.push(note!("datasheet.note.bounded", n = bounded));
    }
    if p.below_values() > 0 {
        notes.push(note!("datasheet.note.common_bound", n = p.below_values()));
    }
    if lots > 1 && lots < LOTS_FOR_SPREAD {
        notes.push(note!("datasheet.note.few_lots", n = lots, needed = LOTS_FOR_SPREAD));
    }
    if p.measurement() > p.between_units() {
        notes.push("datasheet.note.noisy".into());
    }
    match p.normality() {
        Some(p) if p < NOT_NORMAL => {
            let key = if scale == SheetScale::Log {
                "datasheet.note.not_log_normal"
            } else {
                "datasheet.note.not_normal"
            };
            notes.push(Note::new(key).with("p", p));
        }
        Some(_) => {}
        None => notes.push("datasheet.note.law_not_judged".into()),
    }
}

/// The value furthest from zero.
fn largest(rows: &[Row<'_>]) -> Option<SheetLargest> {
    let valued = rows.iter().filter_map(|r| Some((r.value()?, r)));
    let (value, row) = valued.max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))?;
    Some(SheetLargest { value, serial: row.unit.serial.clone() })
}

/// The limit that all rows have, and how many units are beyond it.
fn limit(rows: &[Row<'_>], population: Option<&Population>, scale: SheetScale) -> Option<SheetLimit> {
    let of = |row: &Row<'_>| row.told.limit.as_ref().map(LimitRecord::limits);
    let limits = of(rows.first()?)?;
    if !rows.iter().all(|r| of(r) == Some(limits)) {
        return None;
    }
    let share_above = population
        .zip(limits.max.filter(|m| scale == SheetScale::Linear || *m > 0.0))
        .map(|(p, max)| share_above(p, if scale == SheetScale::Log { max.ln() } else { max }));
    Some(SheetLimit { min: limits.min, max: limits.max, share_above })
}

/// The share of true values above a value on the scale of the population.
fn share_above(population: &Population, at: f64) -> SheetShare {
    let Central { value, low, high } = population.share_above(at, INTERVAL_COVERAGE);
    SheetShare { value, interval: Interval { low, high, coverage: INTERVAL_COVERAGE } }
}

fn value(row: &Row<'_>) -> SheetValue {
    SheetValue {
        serial: row.unit.serial.clone(),
        lot: row.unit.result.unit_under_test.lot.clone(),
        value: row.value(),
        interval: row.told.interval.filter(|_| row.value().is_some()),
        upper_limit: row.told.upper_limit.filter(|_| row.value().is_none()),
    }
}
