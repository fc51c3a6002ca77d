//! The lag from its densities at drawn states.
//!
//! The states of a chain are worth far fewer independent lags, and quantiles of m independent ones leave 2/m more outside an
//! interval than they should. So at a part of the states the density of the lag, everything else of the state held, is tabled
//! over its range, and the mean of these is its distribution (Gelfand and Smith 1990; tabled as by Ritter and Tanner 1992).

use super::read::{self, Reading};
use super::sampler::Draw;
use crate::estimate::Spread;

/// States at which the density is tabled.
const STATES: usize = 30;
/// Lags of a table.
const LAGS: usize = 33;
/// Part of the range of the drawn lags that a table goes beyond it on each side.
const BEYOND: f64 = 0.25;

/// The distribution of the lag at one state.
#[derive(Debug, Clone, PartialEq)]
pub struct Conditional {
    /// Weight of the model that the state belongs to.
    pub weight: f64,
    /// (lag in s, probability of a shorter one), ascending.
    pub below: Vec<(f64, f64)>,
}

/// Lags at which densities are tabled: all that were drawn, and beyond.
pub fn grid(draws: &[Draw], longest_s: f64) -> Vec<f64> {
    let lags = || draws.iter().filter_map(|d| d.shape.first().copied());
    let (low, high) = (lags().fold(f64::INFINITY, f64::min), lags().fold(0.0, f64::max));
    let reach = BEYOND * (high - low).max(0.01 * longest_s);
    let (low, high) = ((low - reach).max(0.0), (high + reach).min(longest_s));
    (0..LAGS).map(|i| low + (high - low) * i as f64 / (LAGS - 1) as f64).collect()
}

/// The distributions at a part of the states; `log_density` is that at a position of the grid and a state.
pub fn conditionals(
    draws: &[Draw],
    grid: &[f64],
    log_density: impl Fn(usize, &Draw) -> f64,
) -> Vec<Conditional> {
    let step = draws.len().div_ceil(STATES).max(1);
    draws
        .iter()
        .skip(step / 2)
        .step_by(step)
        .filter_map(|draw| {
            let logs: Vec<f64> = (0..grid.len()).map(|at| log_density(at, draw)).collect();
            let top = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            if !top.is_finite() {
                return None;
            }
            let mut sum = 0.0;
            let mut below = vec![(grid.first().copied().unwrap_or(0.0), 0.0)];
            for (pair, l) in grid.windows(2).zip(logs.windows(2)) {
                sum += 0.5 * (pair[1] - pair[0]) * ((l[0] - top).exp() + (l[1] - top).exp());
                below.push((pair[1], sum));
            }
            below.iter_mut().for_each(|p| p.1 /= sum.max(f64::MIN_POSITIVE));
            Some(Conditional { weight: 1.0, below })
        })
        .collect()
}

impl Conditional {
    fn share_below(&self, lag_s: f64) -> f64 {
        let at = self.below.partition_point(|p| p.0 < lag_s);
        let Some((to, high)) = self.below.get(at).copied() else { return 1.0 };
        let Some((from, low)) = at.checked_sub(1).map(|i| self.below[i]) else { return 0.0 };
        low + (high - low) * (lag_s - from) / (to - from).max(f64::MIN_POSITIVE)
    }
}

/// The lag with its spread.
pub fn reading(parts: &[Conditional]) -> Reading {
    if parts.is_empty() {
        return Reading { value: f64::NAN, spread: Spread::Unknown };
    }
    let total: f64 = parts.iter().map(|p| p.weight).sum();
    let ends = || parts.iter().flat_map(|p| [p.below.first(), p.below.last()]).flatten().map(|p| p.0);
    let range = (ends().fold(f64::INFINITY, f64::min), ends().fold(0.0, f64::max));
    read::of_distribution(
        |lag| parts.iter().map(|p| p.weight * p.share_below(lag)).sum::<f64>() / total,
        range,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    fn draw(lag_s: f64) -> Draw {
        Draw {
            shape: vec![lag_s],
            noise: [1.0, 0.0, 0.0],
            coefficients: DVector::zeros(1),
            covariance: DMatrix::zeros(1, 1),
        }
    }

    #[test]
    fn a_normal_density_gives_the_interval_of_a_normal_whatever_was_drawn() {
        // A chain that stood still on one side of the truth.
        let draws: Vec<Draw> = (0..90).map(|i| draw(480.0 + f64::from(i))).collect();
        let grid = grid(&draws, 4000.0);
        let wide: Vec<f64> = grid.iter().map(|l| 300.0 + (l - grid[0]) * 6.0).collect();
        let parts = conditionals(&draws, &wide, |at, _| -0.5 * ((wide[at] - 600.0) / 50.0).powi(2));
        let found = reading(&parts);
        let interval = found.spread.interval(found.value, 0.95).unwrap();
        assert!((found.value - 600.0).abs() < 1.0, "{found:?}");
        assert!((interval.low - 502.0).abs() < 4.0 && (interval.high - 698.0).abs() < 4.0, "{interval:?}");
    }

    #[test]
    fn models_count_by_their_weights() {
        let at = |lag: f64, weight: f64| Conditional { weight, below: vec![(lag, 0.0), (lag + 1.0, 1.0)] };
        let found = reading(&[at(100.0, 3.0), at(900.0, 1.0)]);
        let bound = |p: f64| found.spread.bound(found.value, p).unwrap();
        assert!(bound(0.70) < 101.0 && bound(0.80) > 900.0, "{} {}", bound(0.70), bound(0.80));
    }
}
