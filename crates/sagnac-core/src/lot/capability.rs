//! Capability of a process: the distance between its values and their limits in standard deviations, with lower bounds.

use crate::estimate::{Limits, normal_quantile};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Fewest values that a capability is stated for.
pub const LEAST_VALUES: usize = 5;
/// Confidence in the lower bounds.
pub const BOUND_CONFIDENCE: f64 = 0.95;

/// An index with its one-sided lower bound at [`BOUND_CONFIDENCE`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Index {
    /// Value.
    pub value: f64,
    /// Lower bound.
    pub at_least: f64,
}

/// The capability of a process.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Capability {
    /// Number of values.
    pub values: usize,
    /// Their mean.
    pub mean: f64,
    /// Their standard deviation, with that of the measurement.
    pub deviation: f64,
    /// Width between both limits over six standard deviations; `None` with one limit.
    pub cp: Option<Index>,
    /// Distance between the mean and the nearer limit over three standard deviations.
    pub cpk: Index,
}

impl Capability {
    /// The capability of values. `None` below [`LEAST_VALUES`], without any limit, and where all values are equal.
    pub fn of(values: &[f64], limits: Limits) -> Option<Capability> {
        let n = values.len();
        if n < LEAST_VALUES {
            return None;
        }
        let mean = values.iter().sum::<f64>() / n as f64;
        let deviation = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n as f64 - 1.0)).sqrt();
        if !(deviation > 0.0 && deviation.is_finite()) {
            return None;
        }
        let distances = [limits.min.map(|min| mean - min), limits.max.map(|max| max - mean)];
        let nearer = distances.into_iter().flatten().reduce(f64::min)?;
        let cp = limits.min.zip(limits.max).map(|(min, max)| (max - min) / (6.0 * deviation));
        let cpk = nearer / (3.0 * deviation);
        Some(Capability {
            values: n,
            mean,
            deviation,
            cp: cp.and_then(|cp| Some(Index { value: cp, at_least: cp_bound(cp, n)? })),
            cpk: Index { value: cpk, at_least: cpk_bound(cpk, n) },
        })
    }
}

/// Lower bound of Cp: the deviation is at most that of the χ² quantile.
fn cp_bound(cp: f64, values: usize) -> Option<f64> {
    let dof = values as f64 - 1.0;
    let quantile = ChiSquared::new(dof).ok()?.inverse_cdf(1.0 - BOUND_CONFIDENCE);
    Some(cp * (quantile / dof).sqrt())
}

/// Lower bound of Cpk (Bissell 1990).
fn cpk_bound(cpk: f64, values: usize) -> f64 {
    let n = values as f64;
    let variance = 1.0 / (9.0 * n) + cpk * cpk / (2.0 * (n - 1.0));
    cpk - normal_quantile(BOUND_CONFIDENCE) * variance.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_xoshiro::Xoshiro256PlusPlus;

    #[test]
    fn the_bound_of_a_usual_index() {
        let found = cpk_bound(1.33, 30);
        assert!((found - 1.03).abs() < 0.01, "{found}");
        // χ² with 29 degrees of freedom, 5 %: 17.708.
        let found = cp_bound(1.33, 30).unwrap();
        assert!((found - 1.33 * (17.708_f64 / 29.0).sqrt()).abs() < 1e-4, "{found}");
    }

    #[test]
    fn indices_by_hand() {
        // Mean 3, deviation √2.5.
        let values = [1.0, 2.0, 3.0, 4.0, 5.0];
        let both = Capability::of(&values, Limits { min: Some(-3.0), max: Some(7.0) }).unwrap();
        let s = 2.5_f64.sqrt();
        assert!((both.cp.unwrap().value - 10.0 / (6.0 * s)).abs() < 1e-12);
        assert!((both.cpk.value - 4.0 / (3.0 * s)).abs() < 1e-12);
        let upper = Capability::of(&values, Limits { min: None, max: Some(2.0) }).unwrap();
        assert_eq!(upper.cp, None);
        assert!(upper.cpk.value < 0.0 && upper.cpk.at_least < upper.cpk.value);
    }

    #[test]
    fn few_or_equal_values_and_no_limits_are_refused() {
        let limits = Limits { min: None, max: Some(9.0) };
        assert_eq!(Capability::of(&[1.0, 2.0, 3.0, 4.0], limits), None);
        assert_eq!(Capability::of(&[2.0; 8], limits), None);
        assert_eq!(Capability::of(&[1.0, 2.0, 3.0, 4.0, 5.0], Limits { min: None, max: None }), None);
    }

    #[test]
    fn the_bound_holds_as_often_as_stated() {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(3);
        // A true index of 1.2 with one limit: Cpk is then the distance of that limit.
        let limits = Limits { min: None, max: Some(3.6) };
        for n in [10, 30, 100] {
            let repetitions = 4000;
            let held = (0..repetitions)
                .filter(|_| {
                    let values: Vec<f64> = (0..n).map(|_| StandardNormal.sample(&mut random)).collect();
                    Capability::of(&values, limits).unwrap().cpk.at_least <= 1.2
                })
                .count();
            let share = held as f64 / f64::from(repetitions);
            assert!((0.93..0.985).contains(&share), "{n}: {share}");
        }
    }
}
