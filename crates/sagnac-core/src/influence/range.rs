//! The range of the true biases of runs, from means that are noisy themselves.
//!
//! The largest less the smallest of several means is too large on average, the more so the more runs lie near the extremes.
//! The lower end of the interval is therefore that of the shape that noise widens most: every run that may be the highest is
//! taken to be as high as the highest, and every one that may be the lowest as low as the lowest. A range R is refused when
//! noise would make that shape wider than what was seen in too few of all tests only. The upper end needs no shape: whichever
//! two runs are the extremes, their difference is seen too small by more than its noise allows in the stated share of tests
//! only, so the largest bound of all pairs holds. Draws are fixed, so that a result repeats to the bit.

use crate::estimate::{Spread, normal_probability};
use crate::numeric::order::{SortByNumber, SortNumbers};
use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_distr::{ChiSquared, Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Draws of the errors.
const ERROR_DRAWS: usize = 4000;
/// Standard deviations of a difference within which a run may be the extreme one.
const MAY_BE: f64 = 3.0;
/// Pairs of which bounds are drawn; of the others none comes near.
const MAX_PAIRS: usize = 60;
/// Quarters of a normal score at which the confidence distribution is tabled.
const SCORE_QUARTERS: std::ops::RangeInclusive<i32> = -12..=12;

/// Means of runs in one noise that they may have.
#[derive(Debug, Clone)]
pub struct PossibleMeans {
    /// Weight; all together 1.
    pub weight: f64,
    /// The means.
    pub values: DVector<f64>,
    /// Covariance of their errors.
    pub noise: DMatrix<f64>,
    /// Degrees of freedom of its scale.
    pub dof: f64,
}

/// The range as far as it is known.
#[derive(Debug, Clone, PartialEq)]
pub struct Range {
    /// Median of the confidence distribution.
    pub value: f64,
    /// Range of the means as they are.
    pub plain: f64,
    /// Confidence distribution.
    pub spread: Spread,
}

/// The range of true means. `None` with fewer than two, or with covariances that are none.
pub fn range(list: &[PossibleMeans]) -> Option<Range> {
    let first = list.first()?;
    let n = first.values.len();
    let mean = list.iter().fold(DVector::zeros(n), |sum, p| sum + &p.values * p.weight);
    let noise = list.iter().fold(DMatrix::zeros(n, n), |sum, p| sum + &p.noise * p.weight);
    if n < 2 || mean.iter().chain(noise.iter()).any(|v| !v.is_finite()) {
        return None;
    }
    let errors = draws(list)?;
    let plain = width(mean.iter().copied());
    let shape = widest(&mean, &noise, plain);
    let mut sizes: Vec<f64> = errors.iter().map(|e| size_of(&shape, e, plain)).collect();
    sizes.sort_ascending();
    let pairs = pairs(&mean, &noise, &errors);
    let value = quantile(&sizes, 0.5);
    let points = SCORE_QUARTERS
        .map(|q| 0.25 * f64::from(q))
        .map(|z| {
            let p = normal_probability(z);
            let above = || pairs.iter().map(|sorted| quantile(sorted, p)).fold(value, f64::max);
            (z, if z > 0.0 { above() } else { quantile(&sizes, p) })
        })
        .collect();
    Some(Range { value, plain, spread: Spread::Curve(points) })
}

fn width(values: impl Iterator<Item = f64>) -> f64 {
    let (low, high) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    high - low
}

/// Errors of the means, each noise with its share of the draws, stretched as its scale is uncertain.
fn draws(list: &[PossibleMeans]) -> Option<Vec<DVector<f64>>> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(0x0072_616e_6765);
    let mut all = Vec::with_capacity(ERROR_DRAWS + list.len());
    for p in list {
        let eigen = p.noise.clone().symmetric_eigen();
        let root =
            &eigen.eigenvectors * DMatrix::from_diagonal(&eigen.eigenvalues.map(|v| v.max(0.0).sqrt()));
        let dof = p.dof.clamp(1.0, 1e9);
        let scatter = ChiSquared::new(dof).ok()?;
        for _ in 0..(p.weight * ERROR_DRAWS as f64).round() as usize {
            let z = DVector::from_iterator(
                p.values.len(),
                (0..p.values.len()).map(|_| StandardNormal.sample(&mut rng)),
            );
            let stretch = (dof / scatter.sample(&mut rng)).sqrt();
            all.push(&root * z * stretch);
        }
    }
    (all.len() > 1).then_some(all)
}

/// The shape of range 1 that noise widens most, of those that the means allow.
fn widest(mean: &DVector<f64>, noise: &DMatrix<f64>, plain: f64) -> Vec<f64> {
    let n = mean.len();
    let high = (0..n).max_by(|a, b| mean[*a].total_cmp(&mean[*b])).unwrap_or(0);
    let low = (0..n).min_by(|a, b| mean[*a].total_cmp(&mean[*b])).unwrap_or(0);
    let near = |i: usize, k: usize| (mean[i] - mean[k]).abs() <= MAY_BE * deviation(noise, i, k);
    let place = |i: usize| {
        let own = if plain > 0.0 { (mean[i] - mean[low]) / plain } else { 0.5 };
        match (near(i, high), near(i, low)) {
            (true, true) if own >= 0.5 => 1.0,
            (true, true) => 0.0,
            (true, false) => 1.0,
            (false, true) => 0.0,
            (false, false) => own,
        }
    };
    (0..n)
        .map(|i| {
            if i == high {
                1.0
            } else if i == low {
                0.0
            } else {
                place(i)
            }
        })
        .collect()
}

/// Standard deviation of the error of a difference.
fn deviation(noise: &DMatrix<f64>, i: usize, k: usize) -> f64 {
    (noise[(i, i)] + noise[(k, k)] - 2.0 * noise[(i, k)]).max(0.0).sqrt()
}

/// The largest R ≥ 0 at which R·shape + errors has at most the range seen; 0 when errors alone exceed it.
fn size_of(shape: &[f64], errors: &DVector<f64>, seen: f64) -> f64 {
    let at = |r: f64| width(shape.iter().zip(errors.iter()).map(|(s, e)| r * s + e));
    if at(0.0) > seen {
        return 0.0;
    }
    // The range is convex in R: it is below what was seen up to one size.
    let (mut low, mut high) = (0.0, seen + at(0.0));
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if at(middle) <= seen { low = middle } else { high = middle }
    }
    low
}

/// Differences of the pairs that may be the extremes, with their errors, ascending.
fn pairs(mean: &DVector<f64>, noise: &DMatrix<f64>, errors: &[DVector<f64>]) -> Vec<Vec<f64>> {
    let n = mean.len();
    let mut all: Vec<(f64, usize, usize)> = (0..n)
        .flat_map(|i| (0..i).map(move |k| (i, k)))
        .map(|(i, k)| if mean[i] >= mean[k] { (i, k) } else { (k, i) })
        .map(|(i, k)| (mean[i] - mean[k] + 2.5 * deviation(noise, i, k), i, k))
        .collect();
    all.sort_descending_by(|a| a.0);
    all.truncate(MAX_PAIRS);
    all.into_iter()
        .map(|(_, i, k)| {
            let mut drawn: Vec<f64> = errors.iter().map(|e| mean[i] - mean[k] + e[i] - e[k]).collect();
            drawn.sort_ascending();
            drawn
        })
        .collect()
}

/// A quantile of ascending values.
fn quantile(sorted: &[f64], p: f64) -> f64 {
    let x = p * (sorted.len() - 1) as f64;
    let i = (x.floor() as usize).min(sorted.len().saturating_sub(2));
    sorted[i] + (x - i as f64) * (sorted[i + 1] - sorted[i])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(values: Vec<f64>, variance: f64, dof: f64) -> Range {
        let n = values.len();
        let noise = DMatrix::identity(n, n) * variance;
        range(&[PossibleMeans { weight: 1.0, values: DVector::from_vec(values), noise, dof }]).unwrap()
    }

    #[test]
    fn two_runs_far_apart_have_the_interval_of_their_difference() {
        let found = of(vec![0.0, 5.0, 10.0], 0.01, 1e9);
        let i = found.spread.interval(found.value, 0.95).unwrap();
        let half = 1.96 * 0.02f64.sqrt();
        assert!((i.low - 10.0 + half).abs() < 0.02 && (i.high - 10.0 - half).abs() < 0.02, "{i:?}");
        // Student's quantile with four degrees of freedom is 2.776.
        let found = of(vec![0.0, 5.0, 10.0], 0.01, 4.0);
        let i = found.spread.interval(found.value, 0.95).unwrap();
        assert!((i.high - 10.0 - 2.776 * 0.02f64.sqrt()).abs() < 0.03, "{i:?}");
    }

    #[test]
    fn means_without_noise_have_their_range() {
        let found = of(vec![1.0, 4.0, 2.0], 0.0, 1e9);
        assert!((found.value - 3.0).abs() < 1e-9 && found.plain == 3.0, "{found:?}");
    }

    /// Shares of tests whose interval holds the truth, and in which one-sided bounds of 95 % do.
    fn held(truth: &[f64], seed: u64) -> (f64, f64, f64) {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        let most = width(truth.iter().copied());
        let (mut both, mut above, mut below, runs) = (0, 0, 0, 200);
        for _ in 0..runs {
            let values =
                truth.iter().map(|t| t + Distribution::<f64>::sample(&StandardNormal, &mut rng)).collect();
            let found = of(values, 1.0, 1e9);
            let i = found.spread.interval(found.value, 0.95).unwrap();
            both += usize::from((i.low..=i.high).contains(&most));
            above += usize::from(most <= found.spread.bound(found.value, 0.95).unwrap());
            below += usize::from(most >= found.spread.bound(found.value, 0.05).unwrap());
        }
        let share = |count: usize| count as f64 / f64::from(runs);
        (share(both), share(above), share(below))
    }

    #[test]
    fn intervals_hold_from_equal_runs_to_far_ones() {
        let cases: [&[f64]; 6] = [
            &[0.0; 8],
            &[0.0, 0.0, 0.0, 0.0, 2.0, 2.0, 2.0, 2.0],
            &[0.0, 0.0, 0.0, 0.0, 9.0, 9.0, 9.0, 9.0],
            &[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 3.0],
            &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0],
            &[0.0, 20.0, 50.0, 100.0],
        ];
        for (seed, truth) in cases.iter().enumerate() {
            let (both, above, below) = held(truth, 71 + seed as u64);
            assert!(both >= 0.92 && above >= 0.91 && below >= 0.91, "{truth:?}: {both} {above} {below}");
        }
    }
}
