//! The grid that the values of a recording lie on, and its step as an angle increment.

use super::regular::Regular;
use crate::numeric::decimal::multiples;
use crate::numeric::order::SortNumbers;
use std::collections::BTreeMap;

/// Values looked at.
const MAX_VALUES: usize = 4096;

/// A grid that values lie on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QuantizationGrid {
    /// Its step as the angle increment of a sample, arcsec.
    pub increment_arcsec: f64,
    /// Uncertainty of it by the digits of the file, either way, arcsec.
    pub open_arcsec: f64,
    /// Values that the digits of the file could write in one step.
    pub digits_in_step: f64,
}

impl QuantizationGrid {
    /// Least variance of the rounding over that of the noise of a sample from which the grid is more than digits.
    const MIN_ROUNDING_VARIANCE: f64 = 0.01;

    /// The finest step that is more than digits beside white noise of some deviation.
    pub fn finest_arcsec(noise_arcsec: f64) -> f64 {
        (12.0 * QuantizationGrid::MIN_ROUNDING_VARIANCE).sqrt() * noise_arcsec
    }

    /// Log-likelihood of so many values on the grid over values that could be any which the file can write; nothing for a
    /// lattice so fine beside white noise of some deviation that a simulation may leave it out.
    pub fn gain(&self, rows: usize, noise_arcsec: f64) -> f64 {
        let fine = self.increment_arcsec.powi(2) / 12.0
            < QuantizationGrid::MIN_ROUNDING_VARIANCE * noise_arcsec.powi(2);
        if fine { 0.0 } else { rows as f64 * self.digits_in_step.max(1.0).ln() }
    }
}

/// The grid that the values lie on. `None` where there is none, or where it is no more than the last digit that the
/// file writes.
pub fn of(regular: &Regular) -> Option<QuantizationGrid> {
    let values: Vec<f64> = regular
        .rate
        .iter()
        .zip(&regular.grid.present)
        .filter(|(_, p)| **p)
        .map(|(v, _)| *v)
        .take(MAX_VALUES)
        .collect();
    let mut steps: Vec<f64> = values.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|d| *d > 0.0).collect();
    if steps.len() < 32 {
        return None;
    }
    steps.sort_ascending();
    let largest = values.iter().fold(0.0, |a: f64, v| a.max(v.abs())).max(1e-30);
    // The smallest difference that is more than the rounding of the digits written.
    let rounding = largest * 1e-9;
    let tiny = steps.iter().copied().find(|d| *d > rounding)?;
    // Several of the smallest differences agree on one step, or there is no grid.
    let near: Vec<f64> = steps.iter().copied().filter(|d| *d > rounding && *d < 1.5 * tiny).collect();
    if near.len() < 3 {
        return None;
    }
    let mut step = near.iter().sum::<f64>() / near.len() as f64;
    // Larger differences give more digits of the step, for as long as they are told apart from their neighbours.
    for _ in 0..3 {
        let (mut wide, mut count) = (0.0, 0.0);
        for d in &steps {
            let times = (d / step).round();
            if (1.0..2000.0).contains(&times) {
                wide += d * times;
                count += times * times;
            }
        }
        if count > 0.0 {
            step = wide / count;
        }
    }
    let on = steps.iter().filter(|d| {
        let times = **d / step;
        (times - times.round()).abs() < 0.05
    });
    let share = on.count() as f64 / steps.len() as f64;
    let distinct = steps.last().copied().unwrap_or(0.0) / step;
    // A step of a round decimal number is how the file was written, which a few dozens of levels do not tell; an angle
    // increment is seen in the spectrum as well, and that decides.
    if share <= 0.99 || distinct >= 2000.0 {
        return None;
    }
    let large: Vec<f64> = values.iter().copied().filter(|v| v.abs() > 0.1 * largest).collect();
    // Digits that nothing is known of are those that a number holds.
    let digit = last_digit(large.iter()).unwrap_or(1e-15 * largest);
    let (step, open) = by_levels(&values, step, digit);
    let dt_s = regular.grid.dt_s;
    Some(QuantizationGrid {
        increment_arcsec: step * dt_s,
        open_arcsec: open * dt_s,
        digits_in_step: step / digit,
    })
}

/// The step as the slope of the levels that occur, each of which was rounded once to the last digit of the file, and what
/// their rounding leaves open.
fn by_levels(values: &[f64], step: f64, digit: f64) -> (f64, f64) {
    let first = values.first().copied().unwrap_or(0.0);
    let levels: BTreeMap<i64, f64> =
        values.iter().map(|v| (((v - first) / step).round() as i64, *v)).collect();
    let n = levels.len() as f64;
    let mean = |f: &dyn Fn(&i64, &f64) -> f64| levels.iter().map(|(k, v)| f(k, v)).sum::<f64>() / n;
    let (middle, level) = (mean(&|k, _| *k as f64), mean(&|_, v| *v));
    let square = levels.keys().map(|k| (*k as f64 - middle).powi(2)).sum::<f64>();
    if levels.len() < 3 {
        return (step, 1e-3 * step);
    }
    let slope = levels.iter().map(|(k, v)| (*k as f64 - middle) * (v - level)).sum::<f64>() / square;
    let off = |(k, v): (&i64, &f64)| (v - level - slope * (*k as f64 - middle)).abs();
    let largest = levels.iter().map(off).fold(0.0, f64::max);
    // Errors of rounding are bounded: no slope that differs by more keeps within twice the largest of them. A few levels can be
    // rounded alike, and then a digit of the file is what they leave open.
    let span = levels.keys().last().zip(levels.keys().next()).map_or(1, |(a, b)| a - b) as f64;
    let open = (4.0 * largest).max(digit) / span;
    (slope, open.max(1e-9 * slope.abs()))
}

/// The last decimal digit that some values are written with, in deg/h or in deg/s; `None` where they fill the digits that a
/// number holds.
fn last_digit<'a>(values: impl Iterator<Item = &'a f64> + Clone) -> Option<f64> {
    const PER_SECOND: f64 = 3600.0;
    let digits = (0..12).flat_map(|d| [PER_SECOND, 1.0].map(|unit| unit * 10f64.powi(-d)));
    digits.filter(|digit| multiples(values.clone(), *digit)).reduce(f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mismatch::regular::Grid;

    #[test]
    fn a_few_levels_leave_a_digit_of_the_file_open() {
        // Steps of 0.2912695 deg/h, written with five decimals: each of these levels is a multiple of 0.29127.
        let levels: Vec<f64> = (-5..=5).map(|k| (f64::from(k) * 0.291_269_5 * 1e5).round() / 1e5).collect();
        let (step, open) = by_levels(&levels, 0.29127, 1e-5);
        assert!((step - 0.291_269_5).abs() <= open, "{step} ± {open}");
        assert!(open < 2e-6, "{open}");
    }

    #[test]
    fn digits_of_the_file_are_no_lattice_and_coarse_steps_are() {
        let dt_s = 0.5;
        let of = |step: f64, digit: f64| {
            let scattered = |i: u64| (i as f64 * 12.9898).sin() * 43_758.545_3;
            let value = |i: u64| {
                let x = scattered(i).fract() + scattered(i + 7000).fract();
                ((4.0 * x / step).round() * step / digit).round() * digit
            };
            let rate: Vec<f64> = (0..4000).map(value).collect();
            let grid = Grid {
                dt_s,
                start_s: 0.0,
                present: vec![true; 4000],
                gaps: vec![],
                averaged: 1,
                disordered: 0,
            };
            super::of(&Regular { grid, rate, columns: std::collections::BTreeMap::new() }).expect("a lattice")
        };
        assert!(of(0.1, 0.1).gain(4000, 0.1) < 1e-6);
        let coarse = of(0.291_27, 1e-5);
        assert!(coarse.gain(4000, 0.3) > 4000.0 * 29_000f64.ln() && coarse.gain(4000, 5.0) == 0.0);
        assert!((coarse.increment_arcsec / dt_s - 0.291_27).abs() <= coarse.open_arcsec / dt_s);
    }

    #[test]
    fn the_last_digit_is_found_in_the_unit_of_the_file() {
        let close = |found: Option<f64>, digit: f64| found.is_some_and(|f| (f / digit - 1.0).abs() < 1e-9);
        assert!(close(last_digit([12.345, -0.2, 7.0].iter()), 1e-3));
        assert!(close(last_digit([0.000_12 * 3600.0, -0.000_05 * 3600.0].iter()), 0.036));
        assert_eq!(last_digit([std::f64::consts::PI, 2f64.sqrt()].iter()), None);
    }
}
