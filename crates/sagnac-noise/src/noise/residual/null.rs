//! Scores of residuals under a correct model, after parameters were fitted to them.

use crate::estimate::normal_probability;
use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Sets of scores drawn.
const SCORE_DRAWS: usize = 4000;
/// Seed: a report is a function of the record alone.
const SCORE_SEED: u64 = 0x5a67_6e61_6320_0004;

/// Scores that were independent standard normal until parameters were fitted: covariance 1 − F Fᵀ.
pub(super) struct Fitted {
    count: usize,
    /// Orthonormal directions, one a column.
    directions: DMatrix<f64>,
    /// Root of what the fit left of the variance along each.
    left: Vec<f64>,
}

impl Fitted {
    /// `gradient[p][i]`: change of score i, in its standard deviations, with parameter p; `information` of the
    /// parameters in the same units.
    pub fn new(count: usize, gradient: &[Vec<f64>], information: &DMatrix<f64>) -> Fitted {
        let none = || Fitted { count, directions: DMatrix::zeros(count, 0), left: vec![] };
        let parameters = gradient.len();
        if parameters == 0 || count == 0 || information.iter().any(|v| !v.is_finite()) {
            return none();
        }
        // Scaled to a unit diagonal, so that units do not matter.
        let scale: Vec<f64> = (0..parameters)
            .map(|p| if information[(p, p)] > 0.0 { information[(p, p)].sqrt().recip() } else { 0.0 })
            .collect();
        let scaled = DMatrix::from_fn(parameters, parameters, |i, j| {
            let v = information[(i, j)] * scale[i] * scale[j];
            if i == j && v == 0.0 { 1.0 } else { v }
        });
        let eigen = scaled.symmetric_eigen();
        let largest = eigen.eigenvalues.iter().copied().fold(0.0, f64::max);
        let rows = DMatrix::from_fn(count, parameters, |i, p| gradient[p][i] * scale[p]);
        let mut factor = rows * &eigen.eigenvectors;
        for (mut column, value) in factor.column_iter_mut().zip(eigen.eigenvalues.iter()) {
            let weight = if *value > 1e-9 * largest { value.sqrt().recip() } else { 0.0 };
            column *= weight;
        }
        if factor.iter().any(|v| !v.is_finite()) {
            return none();
        }
        let svd = factor.svd(true, false);
        let Some(directions) = svd.u else { return none() };
        let left = svd.singular_values.iter().map(|s| (1.0 - s * s).max(0.0).sqrt()).collect();
        Fitted { count, directions, left }
    }

    /// Variance of a weighted sum of the scores.
    pub fn variance(&self, weights: &[f64]) -> f64 {
        let whole: f64 = weights.iter().map(|w| w * w).sum();
        let lost: f64 = self
            .directions
            .column_iter()
            .zip(&self.left)
            .map(|(u, left)| {
                let along: f64 = u.iter().zip(weights).map(|(u, w)| u * w).sum();
                along * along * (1.0 - left * left)
            })
            .sum();
        (whole - lost).max(0.0)
    }

    fn draw(&self, rng: &mut Xoshiro256PlusPlus) -> DVector<f64> {
        let mut x = DVector::from_fn(self.count, |_, _| StandardNormal.sample(rng));
        let mut along = self.directions.tr_mul(&x);
        for (a, left) in along.iter_mut().zip(&self.left) {
            *a *= 1.0 - left;
        }
        x.gemv(-1.0, &self.directions, &along, 1.0);
        x
    }

    /// Probability that scores of a correct model give a statistic as large, by simulation with a fixed seed.
    pub fn probability(&self, observed: f64, statistic: impl Fn(&[f64]) -> f64) -> f64 {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(SCORE_SEED);
        let mut above = 0usize;
        for _ in 0..SCORE_DRAWS {
            above += usize::from(statistic(self.draw(&mut rng).as_slice()) >= observed);
        }
        (above + 1) as f64 / (SCORE_DRAWS + 1) as f64
    }
}

/// Probability that the largest of standard normal scores with this covariance is as far from zero, by simulation
/// with a fixed seed.
pub(super) fn probability_of_largest(observed: f64, covariance: DMatrix<f64>) -> f64 {
    let count = covariance.nrows();
    let eigen = covariance.symmetric_eigen();
    let mut root = eigen.eigenvectors.clone();
    for (mut column, value) in root.column_iter_mut().zip(eigen.eigenvalues.iter()) {
        column *= value.max(0.0).sqrt();
    }
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(SCORE_SEED);
    let mut above = 0usize;
    for _ in 0..SCORE_DRAWS {
        let x = DVector::from_fn(count, |_, _| StandardNormal.sample(&mut rng));
        let largest = (&root * x).iter().fold(0.0f64, |m, v| m.max(v.abs()));
        above += usize::from(largest >= observed);
    }
    at_most_bonferroni((above + 1) as f64 / (SCORE_DRAWS + 1) as f64, observed, count)
}

/// Beyond what simulation resolves, the bound of Bonferroni is the smaller one.
pub(super) fn at_most_bonferroni(simulated: f64, largest: f64, tests: usize) -> f64 {
    simulated.min(2.0 * tests as f64 * normal_probability(-largest.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fitted_mean_takes_one_degree_of_freedom() {
        // The mean of ten scores fitted: the sum of squares is χ² with nine degrees of freedom, 95 % point 16.919.
        let fitted = Fitted::new(10, &[vec![1.0; 10]], &DMatrix::from_element(1, 1, 10.0));
        assert!(fitted.variance(&[1.0; 10]) < 1e-12);
        let mut one = [0.0; 10];
        one[3] = 1.0;
        assert!((fitted.variance(&one) - 0.9).abs() < 1e-12);
        let p = fitted.probability(16.919, |s| s.iter().map(|v| v * v).sum());
        assert!((p - 0.05).abs() < 0.012, "{p}");
    }

    #[test]
    fn the_largest_of_independent_scores() {
        // 1 − (1 − 0.001)^20 for twenty scores at the two-sided 0.1 % point.
        let p = probability_of_largest(3.290_527, DMatrix::identity(20, 20));
        assert!((p - 0.0198).abs() < 0.006, "{p}");
        assert!((probability_of_largest(8.0, DMatrix::identity(20, 20)) / 2.5e-14 - 1.0).abs() < 0.1);
    }
}
