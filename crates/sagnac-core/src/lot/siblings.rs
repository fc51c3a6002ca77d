//! A unit beside its siblings: whether it is unlike the other units of its lot in several quantities together.
//!
//! The distance of Mahalanobis from the middle of the siblings is taken with the mean and the covariance of the three quarters of
//! them that lie closest together (the concentration steps of P. J. Rousseeuw and K. Van Driessen, Technometrics 41, 1999, begun
//! from all of them), so that a few outlying siblings do not hide another one. Scales and mixtures of the quantities change nothing
//! of it, and so its law for siblings and unit of one normal population depends on their numbers alone. It is drawn, by the
//! sequential rule of J. Besag and P. Clifford (Biometrika 78, 1991).

use crate::numeric::order::SortByNumber;
use nalgebra::{DMatrix, DVector};
use rand::SeedableRng as _;
use rand_distr::{Distribution as _, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Siblings for each quantity, at least.
pub const SIBLINGS_A_QUANTITY: usize = 4;
/// Siblings from which a unit is judged.
pub const LEAST_SIBLINGS: usize = 8;

/// Share of the siblings that mean and covariance rest on.
const CORE_SHARE: f64 = 0.75;
/// Share of the variance of a quantity that the others leave open, at least: below, it follows from them.
const MIN_OWN_VARIANCE_SHARE: f64 = 1e-3;
/// Standard deviation over the mean up to which values are the same.
const ROUNDING_DEVIATION: f64 = 1e-12;
/// Concentration steps at most.
const MAX_CONCENTRATION_STEPS: usize = 20;
/// Draws as far as the unit after which drawing ends.
const MAX_EXCEEDANCES: usize = 200;
/// Draws at most.
const MAX_DRAWS: usize = 19_999;
/// Seed of the draws: a report is a function of its inputs alone.
const DRAWS_SEED: u64 = 0x5a67_6e61_6320_0031;

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
    let core = Core::of(&columns(siblings))?;
    let distance2 = core.distance2(unit).filter(|d| d.is_finite())?;
    let deviations = (0..p).map(|j| (unit[j] - core.mean[j]) / core.deviations[j]).collect();
    Some(Unlike { distance2, p_value: chance(distance2, n, p), deviations })
}

/// Whether units differ in each of their quantities by more than follows from the others.
pub fn are_independent(units: &[Vec<f64>]) -> bool {
    units.first().is_some_and(|u| units.iter().all(|v| v.len() == u.len()))
        && Core::of(&columns(units)).is_some()
}

/// The siblings that lie closest together.
struct Core {
    mean: DVector<f64>,
    /// Standard deviation of each quantity.
    deviations: DVector<f64>,
    /// Lower triangular root of the covariance.
    root: DMatrix<f64>,
}

impl Core {
    /// Mean and covariance of all, then of those that are nearest to them, until the same are nearest. One sibling a column.
    fn of(siblings: &DMatrix<f64>) -> Option<Core> {
        let count = siblings.ncols();
        let kept = ((CORE_SHARE * count as f64).ceil() as usize).min(count);
        let mut chosen: Vec<usize> = (0..count).collect();
        for _ in 0..MAX_CONCENTRATION_STEPS {
            let distances2 = Core::over(siblings, &chosen)?.distances2(siblings.clone())?;
            let mut order: Vec<usize> = (0..count).collect();
            order.sort_ascending_by(|a| distances2[*a]);
            order.truncate(kept);
            order.sort_unstable();
            if order == chosen {
                break;
            }
            chosen = order;
        }
        Core::over(siblings, &chosen)
    }

    fn over(siblings: &DMatrix<f64>, chosen: &[usize]) -> Option<Core> {
        let mut values = siblings.select_columns(chosen);
        let mean = values.column_mean();
        values.column_iter_mut().for_each(|mut column| column -= &mean);
        let covariance = &values * values.transpose() / (chosen.len() as f64 - 1.0);
        let deviations = covariance.diagonal().map(f64::sqrt);
        // A quantity that is the same in all differs by its rounding.
        if deviations
            .iter()
            .zip(mean.iter())
            .any(|(deviation, mean)| *deviation <= ROUNDING_DEVIATION * mean.abs())
        {
            return None;
        }
        let root = covariance.cholesky()?.unpack();
        // The part of each quantity that those before it do not have.
        let own = root.diagonal().zip_map(&deviations, |own, all| (own / all).powi(2));
        own.iter().all(|share| *share >= MIN_OWN_VARIANCE_SHARE).then_some(Core { mean, deviations, root })
    }

    /// Squares of the distances of some units, one a column.
    fn distances2(&self, mut units: DMatrix<f64>) -> Option<Vec<f64>> {
        units.column_iter_mut().for_each(|mut column| column -= &self.mean);
        self.root.solve_lower_triangular_mut(&mut units).then_some(())?;
        Some(units.column_iter().map(|column| column.norm_squared()).collect())
    }

    fn distance2(&self, unit: &[f64]) -> Option<f64> {
        self.distances2(DMatrix::from_column_slice(unit.len(), 1, unit))?.pop()
    }
}

/// One sibling a column.
fn columns(siblings: &[Vec<f64>]) -> DMatrix<f64> {
    let quantities = siblings.first().map_or(0, Vec::len);
    DMatrix::from_fn(quantities, siblings.len(), |j, i| siblings[i][j])
}

/// Probability of such a distance for a unit and `n` siblings of one normal population in `p` quantities.
fn chance(distance2: f64, n: usize, p: usize) -> f64 {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(DRAWS_SEED);
    let mut as_far = 0;
    for drawn in 1..=MAX_DRAWS {
        let mut normal = |_, _| -> f64 { StandardNormal.sample(&mut rng) };
        let siblings = DMatrix::from_fn(p, n, &mut normal);
        let unit: Vec<f64> = (0..p).map(|j| normal(j, 0)).collect();
        let found = Core::of(&siblings).and_then(|core| core.distance2(&unit));
        if found.is_some_and(|d| d >= distance2) {
            as_far += 1;
        }
        if as_far == MAX_EXCEEDANCES {
            return as_far as f64 / drawn as f64;
        }
    }
    (as_far + 1) as f64 / (MAX_DRAWS + 1) as f64
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
        // The study is `sibling-alarms`. Of 60 lots 6 at 10 %, with a standard deviation of 2.3; a mean of 0.5, with 0.037.
        let p_values: Vec<f64> = (0..60)
            .map(|seed| {
                let mut all = units(17, 1000 + seed);
                let unit = all.pop().unwrap();
                unlike(&unit, &all).unwrap().p_value
            })
            .collect();
        let below = |bound: f64| p_values.iter().filter(|p| **p < bound).count();
        assert!(below(0.01) <= 4 && below(0.1) <= 15, "{} {}", below(0.01), below(0.1));
        let mean = p_values.iter().sum::<f64>() / 60.0;
        assert!((mean - 0.5).abs() < 0.15, "{mean}");
    }
}
