//! Patterns that a schedule is made of: each is a short test that can be repeated.

use super::limits::Limits;
use crate::effect::Column;
use crate::schedule::{Schedule, Start, Step};
use std::collections::BTreeSet;

/// Ramps, °C/h, beside the ends of what the chamber does.
const RAMPS: [f64; 4] = [8.0, 15.0, 30.0, 60.0];
/// Parts of the range of temperatures that a cycle spans.
const SPANS: [f64; 3] = [1.0, 0.5, 0.25];
/// Soaks at the ends of a cycle, h.
const SOAKS_H: [f64; 2] = [0.5, 1.5];
/// Times that a table holds a rate, s.
const DWELLS_S: [f64; 3] = [120.0, 300.0, 900.0];
/// Dwell times of the table at an angle, s.
const HEADING_DWELLS_S: [f64; 3] = [300.0, 900.0, 1800.0];
/// Lengths of a rest, h.
const RESTS_H: [f64; 2] = [0.25, 1.0];

/// A pattern: steps that begin and end where chamber and table stand at the start.
pub(super) type Pattern = Vec<Step>;

/// Where every schedule begins, for columns that effects follow.
pub(super) fn start(needs: &BTreeSet<Column>, limits: &Limits) -> Start {
    let moved = |column: Column| needs.contains(&column) && limits.moves(column);
    let low = limits.temperature_degc.map(|[low, _]| low);
    Start {
        temp_degc: low.filter(|_| moved(Column::Temperature)),
        table_rate_deg_s: moved(Column::TableRate).then_some(0.0),
        table_angle_deg: moved(Column::TableAngle).then_some(0.0),
    }
}

/// Every pattern that moves what effects follow, no longer than the budget.
pub(super) fn patterns(needs: &BTreeSet<Column>, limits: &Limits) -> Vec<Pattern> {
    let mut out: Vec<Pattern> = RESTS_H.iter().map(|h| vec![Step::Hold { duration_h: *h }]).collect();
    let wanted = |column: Column| needs.contains(&column) && limits.moves(column);
    if let Some(range) = limits.temperature_degc.filter(|_| wanted(Column::Temperature)) {
        out.extend(of_chamber(range, limits.ramp_degc_per_h));
    }
    if wanted(Column::TableRate) {
        out.extend(DWELLS_S.iter().flat_map(|dwell| of_rates(&limits.table_rates_deg_s, *dwell)));
    }
    if wanted(Column::TableAngle) {
        out.extend(HEADING_DWELLS_S.iter().flat_map(|dwell| of_headings(*dwell)));
    }
    if let Some(range) = limits.temperature_degc
        && wanted(Column::Temperature)
        && wanted(Column::TableRate)
    {
        out.extend(at_both_ends(range, limits));
    }
    out.retain(|pattern| {
        let steps = pattern.clone();
        Schedule { start: start(needs, limits), steps }.duration_s() <= limits.budget_s
    });
    out
}

/// Ramps that the chamber does, slowest first.
fn ramps([slowest, fastest]: [f64; 2]) -> Vec<f64> {
    let inside = RAMPS.into_iter().filter(|r| *r > 1.2 * slowest && *r < 0.8 * fastest);
    let mut out: Vec<f64> = std::iter::once(slowest).chain(inside).chain([fastest]).collect();
    out.dedup();
    out
}

/// Cycles at one rate, with and without soaks; cycles at two rates, one after the other.
fn of_chamber([low, high]: [f64; 2], range: [f64; 2]) -> Vec<Pattern> {
    let ramps = ramps(range);
    let mut out = vec![];
    for span in SPANS.map(|s| s * (high - low)) {
        let cycle = |rate: f64, soak_h: f64| Step::Cycle {
            low_degc: low,
            high_degc: low + span,
            rate_degc_per_h: rate,
            soak_h,
            count: 1,
        };
        out.extend(ramps.iter().map(|r| vec![cycle(*r, 0.0)]));
        let fast = ramps.iter().rev().take(2);
        out.extend(fast.flat_map(|r| SOAKS_H.map(|soak| vec![cycle(*r, soak)])));
        for (i, slow) in ramps.iter().enumerate() {
            let faster = ramps.iter().skip(i + 1).filter(|f| **f >= 1.9 * slow);
            out.extend(faster.map(|fast| vec![cycle(*slow, 0.0), cycle(*fast, 0.0)]));
        }
    }
    out
}

/// A table at both signs of its largest rate, and of all of its rates.
fn of_rates(sizes: &[f64], dwell_s: f64) -> Vec<Pattern> {
    let both = |sizes: &[f64]| {
        let rates_deg_s = std::iter::once(0.0).chain(sizes.iter().flat_map(|r| [*r, -r])).collect();
        vec![Step::TableRates { rates_deg_s, dwell_s, count: 1 }]
    };
    let largest = sizes.last().map(|r| both(&[*r]));
    let all = (sizes.len() > 1).then(|| both(sizes));
    largest.into_iter().chain(all).collect()
}

/// A table at four and at eight angles of a turn.
fn of_headings(dwell_s: f64) -> Vec<Pattern> {
    let of = |count: u32| {
        let angles_deg = (0..count).map(|i| 360.0 * f64::from(i) / f64::from(count)).collect();
        vec![Step::Headings { angles_deg, dwell_s, count: 1 }]
    };
    vec![of(4), of(8)]
}

/// Rates of the table at both ends of the temperatures.
fn at_both_ends([low, high]: [f64; 2], limits: &Limits) -> Vec<Pattern> {
    let [_, rate_degc_per_h] = limits.ramp_degc_per_h;
    let of = |dwell_s: &f64| {
        let rates = of_rates(&limits.table_rates_deg_s, *dwell_s).pop()?;
        let to = |to_degc: f64| Step::Ramp { to_degc, rate_degc_per_h };
        Some([rates.clone(), vec![to(high)], rates, vec![to(low)]].concat())
    };
    DWELLS_S.iter().filter_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_keep_the_limits_and_end_where_they_began() {
        let limits = Limits { ramp_degc_per_h: [5.0, 40.0], ..Limits::usual(6.0 * 3600.0) };
        let needs = BTreeSet::from([Column::Temperature, Column::TableRate]);
        let start = start(&needs, &limits);
        let patterns = patterns(&needs, &limits);
        assert!(patterns.len() > 20);
        for pattern in patterns {
            let schedule = Schedule { start, steps: pattern };
            assert!(schedule.duration_s() <= 6.0 * 3600.0);
            let legs = schedule.legs();
            for leg in &legs {
                let rate = leg.ramp_degc_per_h().abs();
                assert!(rate == 0.0 || (4.999..=40.001).contains(&rate), "{leg:?}");
                assert!(leg.temp_degc.unwrap().iter().all(|t| (10.0..=50.0).contains(t)));
                assert!(leg.table_rate_deg_s.unwrap().abs() <= 30.0 && leg.table_angle_deg.is_none());
            }
            assert_eq!(legs.last().unwrap().temp_degc.unwrap()[1], 10.0);
        }
    }

    #[test]
    fn without_chamber_and_table_only_time_is_left() {
        let limits = Limits {
            temperature_degc: None,
            table_rates_deg_s: vec![],
            headings: false,
            ..Limits::usual(3600.0)
        };
        let needs = BTreeSet::from([Column::Temperature, Column::TableRate, Column::TableAngle]);
        assert_eq!(start(&needs, &limits), Start::default());
        assert!(patterns(&needs, &limits).iter().all(|p| matches!(p[..], [Step::Hold { .. }])));
    }
}
