//! A unit beside its siblings: whether it is unlike the other units of its lot in several quantities together.
//!
//! The distance of Mahalanobis from the middle of the siblings is taken with the mean and the covariance of the three quarters of
//! them that lie closest together (the concentration steps of P. J. Rousseeuw and K. Van Driessen, Technometrics 41, 1999, begun
//! from all of them), so that a few outlying siblings do not hide another one. Scales and mixtures of the quantities change nothing
//! of it, and so its law for siblings and unit of one normal population depends on their numbers alone. It is drawn, by the
//! sequential rule of J. Besag and P. Clifford (Biometrika 78, 1991).

use nalgebra::{DMatrix, DVector};
use rand::SeedableRng as _;
use rand_distr::{Distribution as _, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Siblings for each quantity, at least.
pub const SIBLINGS_A_QUANTITY: usize = 4;
/// Siblings from which a unit is judged.
pub const LEAST_SIBLINGS: usize = 8;

/// Share of the siblings that mean and covariance rest on.
const CORE: f64 = 0.75;
/// Share of the variance of a quantity that the others leave open, at least: below, it follows from them.
const OWN: f64 = 1e-3;
/// Concentration steps at most.
const STEPS: usize = 20;
/// Draws that are as far at which drawing ends, and draws at most.
const ENOUGH: usize = 200;
const DRAWS: usize = 19_999;
/// Seed of the draws: a report is a function of its inputs alone.
const SEED: u64 = 0x5a67_6e61_6320_0031;

/// How far a unit is from its siblings.
#[derive(Debug, Clone, PartialEq)]
pub struct Unlike {
    /// Square of the distance.
    pub distance2: f64,
    /// Probability that a unit of the population of its siblings is as far.
    pub p_value: f64,
    /// Of each quantity, the deviation from the middle of the siblings in their standard deviations.
    pub deviations: Vec<f64>,
}

/// A unit beside its siblings; every one has the same quantities on a scale on which units scatter normally. `None` for fewer than
/// [`LEAST_SIBLINGS`] siblings or [`SIBLINGS_A_QUANTITY`] for each quantity, and where quantities are the same in all of them.
pub fn unlike(unit: &[f64], siblings: &[Vec<f64>]) -> Option<Unlike> {
    let (n, p) = (siblings.len(), unit.len());
    if p == 0 || n < LEAST_SIBLINGS.max(SIBLINGS_A_QUANTITY * p) || siblings.iter().any(|s| s.len() != p) {
        return None;
    }
    let core = Core::of(siblings)?;
    let distance2 = core.distance2(unit);
    if !distance2.is_finite() {
        return None;
    }
    let deviations = (0..p).map(|j| (unit[j] - core.mean[j]) / core.covariance[(j, j)].sqrt()).collect();
    Some(Unlike { distance2, p_value: chance(distance2, n, p), deviations })
}

/// Whether units differ in each of their quantities by more than follows from the others.
pub fn are_independent(units: &[Vec<f64>]) -> bool {
    units.first().is_some_and(|u| units.iter().all(|v| v.len() == u.len())) && Core::of(units).is_some()
}

/// The siblings that lie closest together.
struct Core {
    mean: DVector<f64>,
    covariance: DMatrix<f64>,
    inverse: DMatrix<f64>,
}

impl Core {
    /// Mean and covariance of all, then of those that are nearest to them, until the same are nearest.
    fn of(siblings: &[Vec<f64>]) -> Option<Core> {
        let kept = ((CORE * siblings.len() as f64).ceil() as usize).min(siblings.len());
        let mut chosen: Vec<usize> = (0..siblings.len()).collect();
        for _ in 0..STEPS {
            let core = Core::over(siblings, &chosen)?;
            let mut order: Vec<(f64, usize)> =
                siblings.iter().enumerate().map(|(i, s)| (core.distance2(s), i)).collect();
            order.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mut nearest: Vec<usize> = order.into_iter().take(kept).map(|(_, i)| i).collect();
            nearest.sort_unstable();
            if nearest == chosen {
                break;
            }
            chosen = nearest;
        }
        Core::over(siblings, &chosen)
    }

    fn over(siblings: &[Vec<f64>], chosen: &[usize]) -> Option<Core> {
        let (n, p) = (chosen.len() as f64, siblings.first()?.len());
        let mut mean = DVector::zeros(p);
        for i in chosen {
            mean += DVector::from_column_slice(&siblings[*i]);
        }
        mean /= n;
        let mut covariance = DMatrix::zeros(p, p);
        for i in chosen {
            let d = DVector::from_column_slice(&siblings[*i]) - &mean;
            covariance.ger(1.0 / (n - 1.0), &d, &d, 1.0);
        }
        // What each quantity has of its own beside those before it, as a share of its variance.
        let roots = DVector::from_fn(p, |j, _| covariance[(j, j)].sqrt());
        let correlation =
            DMatrix::from_fn(p, p, |i, j| covariance[(i, j)] / (roots[i] * roots[j]).max(f64::MIN_POSITIVE));
        let own = correlation.cholesky()?;
        if own.l_dirty().diagonal().iter().any(|l| l * l < OWN) {
            return None;
        }
        let inverse = covariance.clone().cholesky()?.inverse();
        Some(Core { mean, covariance, inverse })
    }

    fn distance2(&self, values: &[f64]) -> f64 {
        let d = DVector::from_column_slice(values) - &self.mean;
        d.dot(&(&self.inverse * &d))
    }
}

/// Probability of such a distance for a unit and `n` siblings of one normal population in `p` quantities.
fn chance(distance2: f64, n: usize, p: usize) -> f64 {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(SEED);
    let mut one = || -> Vec<f64> { (0..p).map(|_| StandardNormal.sample(&mut rng)).collect() };
    let mut as_far = 0;
    for drawn in 1..=DRAWS {
        let siblings: Vec<Vec<f64>> = (0..n).map(|_| one()).collect();
        let unit = one();
        if Core::of(&siblings).is_some_and(|core| core.distance2(&unit) >= distance2) {
            as_far += 1;
        }
        if as_far == ENOUGH {
            return as_far as f64 / drawn as f64;
        }
    }
    (as_far + 1) as f64 / (DRAWS + 1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Units of two quantities that go together, the logarithms of two noise coefficients.
    fn units(count: usize, seed: u64) -> Vec<Vec<f64>> {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        (0..count)
            .map(|_| {
                let common = normal();
                vec![-6.0 + 0.1 * common, -7.0 + 0.1 * (0.9 * common + 0.3 * normal())]
            })
            .collect()
    }

    #[test]
    fn what_is_usual_in_each_quantity_can_be_unusual_in_both() {
        let siblings = units(30, 1);
        // One and a half deviations up in one and down in the other, which go together in the siblings.
        let found = unlike(&[-5.85, -7.15], &siblings).unwrap();
        assert!(found.p_value < 0.001, "{found:?}");
        assert!(found.deviations.iter().all(|d| (1.0..2.5).contains(&d.abs())), "{found:?}");
        let usual = unlike(&[-5.85, -6.86], &siblings).unwrap();
        assert!(usual.p_value > 0.1, "{usual:?}");
    }

    #[test]
    fn a_few_outlying_siblings_hide_no_other() {
        let mut siblings = units(24, 2);
        for sibling in siblings.iter_mut().take(4) {
            sibling[0] += 1.5;
        }
        let found = unlike(&[-4.5, -7.0], &siblings).unwrap();
        assert!(found.p_value < 0.01, "{found:?}");
    }

    #[test]
    fn neither_scale_nor_mixture_of_the_quantities_changes_the_distance() {
        let (unit, siblings) = (vec![-5.9, -6.8], units(20, 3));
        let mixed = |v: &Vec<f64>| vec![3.0 * v[0] + 2.0, 0.5 * v[1] - 4.0 * v[0]];
        let a = unlike(&unit, &siblings).unwrap();
        let b = unlike(&mixed(&unit), &siblings.iter().map(mixed).collect::<Vec<_>>()).unwrap();
        assert!((a.distance2 / b.distance2 - 1.0).abs() < 1e-6 && a.p_value == b.p_value, "{a:?} {b:?}");
    }

    #[test]
    fn too_few_siblings_or_the_same_value_in_all_say_nothing() {
        assert!(unlike(&[-6.0, -7.0], &units(7, 4)).is_none());
        assert!(unlike(&[0.0; 3], &vec![vec![1.0; 3]; 11]).is_none());
        let same: Vec<Vec<f64>> = units(20, 5).into_iter().map(|v| vec![v[0], 1.0]).collect();
        assert!(unlike(&[-6.0, 1.0], &same).is_none());
        assert!(unlike(&[], &units(20, 6)).is_none());
        let follows: Vec<Vec<f64>> =
            units(20, 5).into_iter().map(|v| vec![v[0], v[1], 1.0 + v[0] - 0.5 * v[1]]).collect();
        assert!(are_independent(&units(20, 5)) && !are_independent(&follows) && !are_independent(&[]));
    }

    #[test]
    fn a_unit_of_the_same_population_is_alarmed_as_often_as_stated() {
        // 600 lots: 6 at 1 %, with a standard deviation of 2.4; 60 at 10 %, with 7.3.
        let p_values: Vec<f64> = (0..600)
            .map(|seed| {
                let mut all = units(17, 1000 + seed);
                let unit = all.pop().unwrap();
                unlike(&unit, &all).unwrap().p_value
            })
            .collect();
        let below = |bound: f64| p_values.iter().filter(|p| **p < bound).count();
        assert!(below(0.01) <= 15 && (38..=82).contains(&below(0.1)), "{} {}", below(0.01), below(0.1));
    }
}
