//! The unit of the stamps by the angle of the table from sample to sample.

use super::blocks::TURN_ARCSEC;
use super::steps::TableRun;
use crate::numeric::order::SortNumbers;

/// Share of the largest rate from which on a step tells the unit.
const MIN_RATE_SHARE: f64 = 0.05;
/// Share of the steps that must tell the same unit.
const MIN_AGREEING_SHARE: f64 = 0.8;
/// Relative difference of time factors within which steps tell the same unit.
const MAX_RELATIVE_DIFFERENCE: f64 = 0.02;

/// The time that passes by angle and rate of the table over the time by the stamps, where it is the same at most steps.
/// Whole turns between two readings are no motion here: the rate by which they would be counted may rest on a wrong time.
pub fn time_factor(run: &TableRun) -> Option<f64> {
    let (blocks, steps) = (&run.blocks, &run.steps.list);
    if !blocks.has_angle || !blocks.has_rate {
        return None;
    }
    let largest = steps.iter().fold(0.0, |m: f64, s| m.max(s.nominal.abs()));
    let mut factors: Vec<f64> = steps
        .iter()
        .filter(|s| s.nominal.abs() > MIN_RATE_SHARE * largest)
        .filter_map(|s| {
            let inside = |row: u64| (s.first_row..s.end_row).contains(&row);
            let moved = blocks.list.windows(2).filter(|w| w[1].continues && inside(w[0].first_row));
            let mut each: Vec<f64> = moved
                .map(|w| {
                    let step = w[1].angle_first - w[0].angle_first;
                    let time_s = (w[1].first_index - w[0].first_index) as f64 * blocks.interval_s;
                    (step - (step / TURN_ARCSEC).round() * TURN_ARCSEC) / (s.nominal * time_s)
                })
                .filter(|f| f.is_finite())
                .collect();
            let middle = each.len() / 2;
            (each.len() >= 4).then(|| *each.select_nth_unstable_by(middle, f64::total_cmp).1)
        })
        .collect();
    if factors.is_empty() {
        return None;
    }
    factors.sort_ascending();
    let middle = factors[factors.len() / 2];
    let alike = factors.iter().filter(|f| (*f / middle - 1.0).abs() < MAX_RELATIVE_DIFFERENCE).count();
    (alike as f64 >= MIN_AGREEING_SHARE * factors.len() as f64).then_some(middle)
}
