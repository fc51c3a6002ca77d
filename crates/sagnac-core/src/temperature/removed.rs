//! Whether the slow part of a bias over temperature was taken out of the record before it was delivered.
//!
//! What is left of a bias without its mean about each instant is what is left of its causes, of temperature and its rate, without
//! theirs. A unit gives its bias by the temperature that it has; it knows nothing of the mean of those before and after.

use super::course::{Course, Span};
use crate::numeric::sums::cumulated;
use nalgebra::{DMatrix, DVector};

/// Widths of the means that are tried, as shares of the record: from the widest, each so much less than the one before.
const WIDEST_SHARE: f64 = 0.5;
const WIDTH_RATIO: f64 = 1.25;
const WIDTHS_TRIED: i32 = 16;
/// Twice the gain of log-likelihood over the model of the unit from which the slow part counts as removed.
const MIN_GAIN: f64 = 60.0;

/// A slow part that was taken out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Removed {
    /// Width of the mean that was taken out, of those tried, s.
    pub width_s: f64,
    /// Variance that temperature and its rate without their means leave of the record, over that which the model of the unit leaves.
    pub left: f64,
}

/// Holds the record against temperature and its rate without their means. `modelled` is the model of the unit; `None` where that
/// describes the record as well.
pub fn removed(course: &Course, span: &Span, modelled: &[f64]) -> Option<Removed> {
    let n = course.len();
    let causes = causes(course, span);
    let left_by_model: f64 = course.rate_deg_h.iter().zip(modelled).map(|(y, m)| (y - m).powi(2)).sum();
    let tried = (0..WIDTHS_TRIED).filter_map(|i| {
        let share = WIDEST_SHARE * WIDTH_RATIO.powi(-i);
        let half = (0.5 * share * n as f64) as usize;
        let columns: Vec<Vec<f64>> = causes.iter().map(|c| without_mean(c, half)).collect();
        let left = left(&columns, &course.rate_deg_h)? / left_by_model;
        Some(Removed { width_s: (2 * half + 1) as f64 * course.block_s, left })
    });
    let best = tried.min_by(|a, b| a.left.total_cmp(&b.left))?;
    (-(n as f64) * best.left.ln() > MIN_GAIN).then_some(best)
}

/// Temperature and its square, and its rate.
fn causes(course: &Course, span: &Span) -> [Vec<f64>; 3] {
    let of = |power: i32| course.temperature_deg_c.iter().map(|t| span.argument(*t).powi(power)).collect();
    let (first, second): (Vec<f64>, Vec<f64>) = (of(1), of(2));
    let last = first.len().saturating_sub(1);
    let rate = (0..first.len()).map(|i| first[(i + 1).min(last)] - first[i.saturating_sub(1)]).collect();
    [first, second, rate]
}

/// Values without the mean over so many of them on either side, of which there are fewer at the ends.
fn without_mean(values: &[f64], half: usize) -> Vec<f64> {
    let sums = cumulated(values.iter().copied());
    let left = |(i, v): (usize, &f64)| {
        let (from, to) = (i.saturating_sub(half), (i + half + 1).min(values.len()));
        v - (sums[to] - sums[from]) / (to - from) as f64
    };
    values.iter().enumerate().map(left).collect()
}

/// Square sum that a constant and columns leave of values.
fn left(columns: &[Vec<f64>], values: &[f64]) -> Option<f64> {
    let x = DMatrix::from_fn(values.len(), columns.len() + 1, |i, j| {
        j.checked_sub(1).map_or(1.0, |j| columns[j][i])
    });
    let y = DVector::from_column_slice(values);
    let fitted = (x.transpose() * &x).cholesky()?.solve(&(x.transpose() * &y));
    Some((y - x * fitted).norm_squared())
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_xoshiro::Xoshiro256PlusPlus;

    /// Up and down twice with rests, and a bias that is a line over it beside white noise.
    fn course() -> Course {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(3);
        let temperature = |i: usize| {
            let at = (i % 500) as f64 / 500.0;
            20.0 + 40.0 * (4.0 * at - 0.5).clamp(0.0, 1.0) - 40.0 * (4.0 * at - 2.5).clamp(0.0, 1.0)
        };
        let temperature_deg_c: Vec<f64> = (0..1000).map(temperature).collect();
        let mut noise = || -> f64 { StandardNormal.sample(&mut rng) };
        let rate_deg_h = temperature_deg_c.iter().map(|t| 3.0 + 0.05 * t + 0.05 * noise()).collect();
        Course { block_s: 60.0, first_s: 0.0, rate_deg_h, temperature_deg_c, bridged: 0.0 }
    }

    #[test]
    fn a_drift_that_was_taken_out_is_seen_and_a_drift_that_is_there_is_none() {
        let (mut course, span) = (course(), Span { low: 20.0, high: 60.0 });
        let line: Vec<f64> = course.temperature_deg_c.iter().map(|t| 3.0 + 0.05 * t).collect();
        assert_eq!(removed(&course, &span, &line), None);
        let flat = vec![3.0; 1000];
        for half in [25, 100] {
            let of = without_mean(&course.rate_deg_h, half);
            let taken = Course { rate_deg_h: of.iter().map(|v| 3.0 + v).collect(), ..course.clone() };
            assert!(removed(&taken, &span, &flat).is_some(), "{half}");
        }
        // A bias that does not follow the temperature has nothing that could be missing.
        course.rate_deg_h.iter_mut().zip(&line).for_each(|(y, l)| *y -= l);
        assert_eq!(removed(&course, &span, &vec![0.0; 1000]), None);
    }
}
