//! The largest of several magnitudes, each known with errors that are correlated.
//!
//! The largest observed one is too large on average, and its interval is not that of one point. The truth is taken to
//! have the shape of what was observed and some size s; the confidence of a size is the probability that errors would
//! leave a smaller largest one than was observed. Near the noise the observed shape is noise itself, and says too little:
//! upper ends are therefore never below what they are for any shape. Wherever the largest truth is, the one observed there
//! is too small by more than z standard deviations in a share 1 − Φ(z) of all tests; so the truth is at most the largest of
//! |v| + z·u in all but that share, whatever the others are. The covariance comes from the record as well: every draw of the errors is
//! stretched as the scale of such a covariance is uncertain, so that one value alone has Student's interval. Draws are fixed,
//! so that a result repeats to the bit.

use crate::estimate::{Spread, normal_probability};
use crate::numeric::order::SortNumbers;
use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_distr::{ChiSquared, Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Draws of the errors.
const ERROR_DRAWS: usize = 2000;

/// Quarters of a normal score at which the confidence distribution is tabled.
const SCORE_QUARTERS: std::ops::RangeInclusive<i32> = -12..=12;

/// The largest magnitude as far as it is known.
#[derive(Debug, Clone, PartialEq)]
pub struct Largest {
    /// Position of the largest observed.
    pub at: usize,
    /// Median of the confidence distribution.
    pub value: f64,
    /// (normal score, value), ascending.
    pub curve: Vec<(f64, f64)>,
    /// Probability that errors alone leave as large a one.
    pub by_chance: f64,
}

/// The largest of `values`, whose errors have the covariance given, which has the degrees of freedom that `dof` gives for
/// each value. `None` without values or with a covariance that is none.
pub fn largest(values: &[f64], covariance: &DMatrix<f64>, dof: &dyn Fn(usize) -> f64) -> Option<Largest> {
    let n = values.len();
    let (at, observed) =
        values.iter().enumerate().map(|(i, v)| (i, v.abs())).max_by(|a, b| a.1.total_cmp(&b.1))?;
    let root = root_of(covariance)?;
    let dof = dof(at).max(1.0);
    let scatter = ChiSquared::new(dof).ok()?;
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(0x005a_676e_6163);
    let draws: Vec<DVector<f64>> = (0..ERROR_DRAWS)
        .map(|_| {
            let z = DVector::from_iterator(n, (0..n).map(|_| StandardNormal.sample(&mut rng)));
            let stretch = (dof / scatter.sample(&mut rng)).sqrt();
            &root * z * stretch
        })
        .collect();
    // The size at which a draw leaves just what was observed: the largest of |s·v + e| grows with s where s is large.
    let mut sizes: Vec<f64> = draws.iter().map(|e| size_of(values, e, observed)).collect();
    sizes.sort_ascending();
    let chance = draws.iter().filter(|e| e.iter().fold(0.0, |m: f64, v| m.max(v.abs())) >= observed).count()
        as f64
        / ERROR_DRAWS as f64;
    let quantile = |p: f64| {
        let x = p * (ERROR_DRAWS - 1) as f64;
        let i = (x.floor() as usize).min(ERROR_DRAWS - 2);
        sizes[i] + (x - i as f64) * (sizes[i + 1] - sizes[i])
    };
    let any_shape = |p: f64| {
        let bounds = values.iter().enumerate().filter_map(|(i, v)| {
            let standard_uncertainty = covariance[(i, i)].max(0.0).sqrt();
            Spread::StudentT { standard_uncertainty, dof }.bound(v.abs(), p)
        });
        bounds.fold(0.0, f64::max)
    };
    let curve: Vec<(f64, f64)> = SCORE_QUARTERS
        .map(|z| 0.25 * f64::from(z))
        .map(|z| {
            let p = normal_probability(z);
            let of_shape = quantile(p) * observed;
            (z, if z > 0.0 { of_shape.max(any_shape(p)) } else { of_shape })
        })
        .collect();
    let value = quantile(0.5) * observed;
    Some(Largest { at, value, curve, by_chance: chance })
}

/// The largest s ≥ 0 with max |s·v + e| ≤ observed; 0 when errors alone exceed it.
fn size_of(values: &[f64], errors: &DVector<f64>, observed: f64) -> f64 {
    let mut most = f64::INFINITY;
    for (v, e) in values.iter().zip(errors.iter()) {
        if e.abs() > observed {
            return 0.0;
        }
        if *v != 0.0 {
            // s·v + e reaches ±observed, whichever the sign of v leads to.
            most = most.min((observed - e * v.signum()) / v.abs());
        }
    }
    if most.is_finite() { most.max(0.0) } else { 0.0 }
}

/// A root of a covariance that may be singular.
fn root_of(covariance: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    if covariance.iter().any(|v| !v.is_finite()) || covariance.nrows() == 0 {
        return None;
    }
    let eigen = covariance.clone().symmetric_eigen();
    let scale = DMatrix::from_diagonal(&eigen.eigenvalues.map(|v| v.max(0.0).sqrt()));
    Some(&eigen.eigenvectors * scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_that_stands_out_has_the_interval_of_a_point() {
        let found = largest(&[10.0, 0.1, -0.2], &(DMatrix::identity(3, 3) * 0.01), &|_| 1e9).unwrap();
        assert_eq!(found.at, 0);
        assert!((found.value - 10.0).abs() < 0.02);
        let at = |z: f64| found.curve.iter().find(|p| p.0 == z).unwrap().1;
        assert!((at(2.0) - 10.2).abs() < 0.02 && (at(-2.0) - 9.8).abs() < 0.02);
        assert_eq!(found.by_chance, 0.0);
    }

    #[test]
    fn one_that_stands_out_has_students_interval_where_the_noise_is_hardly_known() {
        let found = largest(&[10.0, 0.1, -0.2], &(DMatrix::identity(3, 3) * 0.01), &|_| 4.0).unwrap();
        // Student's quantile at Φ(2) with four degrees of freedom is 2.869.
        let at = |z: f64| found.curve.iter().find(|p| p.0 == z).unwrap().1;
        assert!((at(2.0) - 10.287).abs() < 0.04 && (at(-2.0) - 9.713).abs() < 0.04, "{}", at(2.0));
    }

    /// Shares of tests with a truth at or below the one-sided bound of 95 %, and the least bound.
    fn bounded(truth: &[f64], seed: u64) -> (f64, f64) {
        let n = truth.len();
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        let most = truth.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        let (mut held, mut least, runs) = (0, f64::INFINITY, 200);
        for _ in 0..runs {
            let values: Vec<f64> =
                truth.iter().map(|t| t + Distribution::<f64>::sample(&StandardNormal, &mut rng)).collect();
            let found = largest(&values, &DMatrix::identity(n, n), &|_| 1e9).unwrap();
            let bound = Spread::Curve(found.curve).bound(found.value, 0.95).unwrap();
            held += usize::from(most <= bound);
            least = least.min(bound);
        }
        (held as f64 / f64::from(runs), least)
    }

    #[test]
    fn bounds_hold_where_the_shape_is_noise_and_are_never_zero() {
        // Nothing, a cubic of one and of three deviations, one rate that stands out.
        let cubic = |size: f64| (-5..=5).map(|i| size * f64::from(i).powi(3) / 125.0).collect::<Vec<f64>>();
        let mut one = vec![0.0; 11];
        one[3] = 2.0;
        for (seed, truth) in [vec![0.0; 11], cubic(1.0), cubic(3.0), one].iter().enumerate() {
            let (held, least) = bounded(truth, 31 + seed as u64);
            assert!(held >= 0.93, "{truth:?}: {held}");
            assert!(least > 1.6, "{truth:?}: {least}");
        }
    }

    #[test]
    fn noise_alone_is_seen_to_be_noise() {
        let found = largest(&[1.2, -0.8, 0.3, -1.0, 0.6], &DMatrix::identity(5, 5), &|_| 1e9).unwrap();
        assert!(found.by_chance > 0.3, "{}", found.by_chance);
    }
}
