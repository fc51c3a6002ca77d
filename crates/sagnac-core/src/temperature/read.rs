//! Values with their spreads, read from the posterior draws of a model.

use super::sampler::{Draw, normal};
use crate::estimate::{Spread, normal_probability};
use crate::numeric::optimize::bisect;
use crate::numeric::order::SortNumbers;
use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;

/// Draws of the coefficients at each state.
const DRAWS_PER_STATE: usize = 12;
/// Normal scores at which a spread is kept.
const SCORE_COUNT: usize = 65;
/// Largest score.
const MAX_SCORE: f64 = 3.2;

/// A value with its spread.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// Median.
    pub value: f64,
    /// Spread.
    pub spread: Spread,
}

impl Reading {
    /// Half of the central 68.3 %.
    pub fn standard_uncertainty(&self) -> f64 {
        let bound = |p: f64| self.spread.bound(self.value, p).unwrap_or(f64::NAN);
        0.5 * (bound(0.841_344_7) - bound(0.158_655_3))
    }

    /// The reading multiplied by a factor, its spread included.
    pub fn scaled(&self, factor: f64) -> Reading {
        let spread = match &self.spread {
            Spread::Curve(points) if factor >= 0.0 => {
                Spread::Curve(points.iter().map(|(z, v)| (*z, v * factor)).collect())
            }
            Spread::Curve(points) => {
                Spread::Curve(points.iter().rev().map(|(z, v)| (-z, v * factor)).collect())
            }
            other => other.clone(),
        };
        Reading { value: self.value * factor, spread }
    }
}

fn scores() -> impl Iterator<Item = f64> {
    (0..SCORE_COUNT).map(|i| MAX_SCORE * (2.0 * i as f64 / (SCORE_COUNT - 1) as f64 - 1.0))
}

/// A number that is linear in the coefficients: `weights` of the coefficients at a state.
pub fn linear(draws: &[Draw], weights: impl Fn(&Draw) -> DVector<f64>) -> Reading {
    let parts: Vec<(f64, f64)> = draws
        .iter()
        .map(|d| {
            let w = weights(d);
            let variance = (w.transpose() * &d.covariance * &w)[0].max(0.0);
            (w.dot(&d.coefficients), variance.sqrt())
        })
        .collect();
    let below = |x: f64| {
        let one = |(m, s): &(f64, f64)| {
            if *s > 0.0 { normal_probability((x - m) / s) } else { f64::from(u8::from(x >= *m)) }
        };
        parts.iter().map(one).sum::<f64>() / parts.len().max(1) as f64
    };
    let low = parts.iter().map(|(m, s)| m - 5.0 * s).fold(f64::INFINITY, f64::min);
    let high = parts.iter().map(|(m, s)| m + 5.0 * s).fold(f64::NEG_INFINITY, f64::max);
    of_distribution(below, (low, high))
}

/// A reading from the probability of less than a value, which all but lies between two values.
pub fn of_distribution(below: impl Fn(f64) -> f64, (low, high): (f64, f64)) -> Reading {
    let quantile = |p: f64| bisect(low, high, 44, |x| below(x) < p).middle();
    let points: Vec<(f64, f64)> = scores().map(|z| (z, quantile(normal_probability(z)))).collect();
    Reading { value: quantile(0.5), spread: Spread::Curve(points) }
}

/// A number that is not linear in the coefficients. The value at drawn coefficients is turned about the value at their
/// mean, which takes the bias of a maximum or a square out to first order.
pub fn nonlinear(draws: &[Draw], of: impl Fn(&Draw, &DVector<f64>) -> f64) -> Reading {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(0x6265_6e74);
    let mut values = Vec::with_capacity(draws.len() * DRAWS_PER_STATE);
    for draw in draws {
        let p = draw.coefficients.len();
        let factor = factor(&draw.covariance);
        let middle = of(draw, &draw.coefficients);
        for _ in 0..DRAWS_PER_STATE {
            let z = DVector::from_fn(p, |_, _| normal(&mut rng));
            let drawn = &draw.coefficients + &factor * z;
            values.push(2.0 * middle - of(draw, &drawn));
        }
    }
    from_values(values)
}

/// A number of state and coefficients as it is drawn, for what has no bias to be taken out, such as a time.
pub fn of_draws(draws: &[Draw], of: impl Fn(&Draw, &DVector<f64>) -> f64) -> Reading {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(0x6472_6177);
    let mut values = Vec::with_capacity(draws.len() * DRAWS_PER_STATE);
    for draw in draws {
        let factor = factor(&draw.covariance);
        for _ in 0..DRAWS_PER_STATE {
            let z = DVector::from_fn(draw.coefficients.len(), |_, _| normal(&mut rng));
            values.push(of(draw, &(&draw.coefficients + &factor * z)));
        }
    }
    from_values(values)
}

/// Probability that errors alone leave as large a value of a number that is zero where all coefficients are, and grows with
/// their size.
pub fn by_chance(draws: &[Draw], of: impl Fn(&DVector<f64>) -> f64) -> f64 {
    let Some(size) = draws.first().map(|d| d.coefficients.len()) else { return 1.0 };
    let mean = draws.iter().fold(DVector::zeros(size), |sum, d| sum + &d.coefficients) / draws.len() as f64;
    let found = of(&mean);
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(0x666c_6174);
    let mut as_large = 0usize;
    for draw in draws {
        let factor = factor(&draw.covariance);
        for _ in 0..DRAWS_PER_STATE {
            let z = DVector::from_fn(size, |_, _| normal(&mut rng));
            as_large += usize::from(of(&(&draw.coefficients - &mean + &factor * z)) >= found);
        }
    }
    as_large as f64 / (draws.len() * DRAWS_PER_STATE) as f64
}

/// A reading from draws.
pub fn from_values(mut values: Vec<f64>) -> Reading {
    values.retain(|v| v.is_finite());
    values.sort_ascending();
    if values.is_empty() {
        return Reading { value: f64::NAN, spread: Spread::Unknown };
    }
    let last = values.len() - 1;
    let quantile = |p: f64| {
        let at = p * last as f64;
        let (i, rest) = (at.floor() as usize, at.fract());
        values[i] + rest * (values[(i + 1).min(last)] - values[i])
    };
    let points: Vec<(f64, f64)> = scores().map(|z| (z, quantile(normal_probability(z)))).collect();
    Reading { value: quantile(0.5), spread: Spread::Curve(points) }
}

/// A lower factor F with FFᵀ = C, where rows without variance stay zero.
fn factor(covariance: &DMatrix<f64>) -> DMatrix<f64> {
    let n = covariance.nrows();
    let mut l: DMatrix<f64> = DMatrix::zeros(n, n);
    for j in 0..n {
        let pivot = covariance[(j, j)] - (0..j).map(|k| l[(j, k)].powi(2)).sum::<f64>();
        if pivot <= 1e-14 * covariance[(j, j)].abs() || pivot <= 0.0 {
            continue;
        }
        l[(j, j)] = pivot.sqrt();
        for i in j + 1..n {
            let sum: f64 = (0..j).map(|k| l[(i, k)] * l[(j, k)]).sum();
            l[(i, j)] = (covariance[(i, j)] - sum) / l[(j, j)];
        }
    }
    l
}

/// Standard deviation of a number that is linear in the coefficients, over all draws.
pub fn deviation(draws: &[Draw], weights: &DVector<f64>) -> f64 {
    let n = draws.len().max(1) as f64;
    let means: Vec<f64> = draws.iter().map(|d| weights.dot(&d.coefficients)).collect();
    let inner =
        draws.iter().map(|d| (weights.transpose() * &d.covariance * weights)[0].max(0.0)).sum::<f64>() / n;
    let mean = means.iter().sum::<f64>() / n;
    let outer = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / n;
    (inner + outer).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn readings_of_a_normal_distribution_are_its_quantiles() {
        let reading = of_distribution(|x| normal_probability((x - 3.0) / 2.0), (-20.0, 30.0));
        assert!((reading.value - 3.0).abs() < 1e-9);
        let bound = reading.spread.bound(reading.value, 0.975).unwrap_or(f64::NAN);
        assert!((bound - (3.0 + 2.0 * 1.959_964)).abs() < 1e-3, "{bound}");
    }

    #[test]
    fn readings_of_values_are_their_order() {
        let reading = from_values((0..=1000).map(f64::from).chain([f64::NAN]).collect());
        assert_eq!(reading.value, 500.0);
        assert!(from_values(vec![]).value.is_nan());
    }

    #[test]
    fn the_factor_of_a_covariance_gives_it_back() {
        let covariance = DMatrix::from_row_slice(3, 3, &[4.0, 2.0, 0.0, 2.0, 5.0, 0.0, 0.0, 0.0, 0.0]);
        let factor = factor(&covariance);
        assert!((&factor * factor.transpose() - covariance).norm() < 1e-14);
    }
}
