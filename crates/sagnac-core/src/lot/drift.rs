//! Drift of one unit over tests that share a part of their uncertainty.

use super::control_chart::Measured;
use crate::estimate::normal_quantile;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Coverage of the intervals.
pub const INTERVAL_COVERAGE: f64 = 0.95;

/// The course of a quantity of one unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drift {
    /// Last value less the first.
    pub change: f64,
    /// Half width of its interval.
    pub change_half_width: f64,
    /// Slope of the line through all values, per unit of time; `None` below three values or at one moment.
    pub slope: Option<Slope>,
    /// Probability of values as different as these if the unit did not change; `None` without uncertainties.
    pub steady_probability: Option<f64>,
}

/// A slope with its interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slope {
    /// Slope per unit of time.
    pub value: f64,
    /// Half width of its interval.
    pub half_width: f64,
}

/// The drift of values at ascending times. `common` is the standard uncertainty that all tests share, such as that of one
/// reference: it is a part of the uncertainty of each value and cancels in every difference. `None` below two values.
pub fn drift(times: &[f64], values: &[Measured], common: f64) -> Option<Drift> {
    if times.len() != values.len() {
        return None;
    }
    let own = |v: &Measured| (v.standard * v.standard - common * common).max(0.0);
    let (first, last) = (values.first()?, values.last().filter(|_| values.len() > 1)?);
    let z = normal_quantile(0.5 + 0.5 * INTERVAL_COVERAGE);
    let variances: Vec<f64> = values.iter().map(own).collect();
    Some(Drift {
        change: last.value - first.value,
        change_half_width: z * (own(first) + own(last)).sqrt(),
        slope: slope(times, values, &variances)
            .map(|(value, standard)| Slope { value, half_width: z * standard }),
        steady_probability: steady(values, &variances),
    })
}

/// Mean of some numbers with weights.
fn mean(numbers: impl Iterator<Item = f64>, weights: &[f64]) -> f64 {
    numbers.zip(weights).map(|(x, w)| x * w).sum::<f64>() / weights.iter().sum::<f64>()
}

/// Slope of the weighted line, with its standard uncertainty.
fn slope(times: &[f64], values: &[Measured], variances: &[f64]) -> Option<(f64, f64)> {
    if values.len() < 3 || variances.iter().any(|v| *v <= 0.0) {
        return None;
    }
    let weights: Vec<f64> = variances.iter().map(|v| 1.0 / v).collect();
    let time = mean(times.iter().copied(), &weights);
    let value = mean(values.iter().map(|v| v.value), &weights);
    let each = || times.iter().zip(values).zip(&weights);
    let spread: f64 = each().map(|((t, _), w)| w * (t - time).powi(2)).sum();
    let product: f64 = each().map(|((t, v), w)| w * (t - time) * (v.value - value)).sum();
    (spread > 0.0).then(|| (product / spread, spread.sqrt().recip()))
}

/// Probability of a larger χ² about the weighted mean.
fn steady(values: &[Measured], variances: &[f64]) -> Option<f64> {
    if variances.iter().any(|v| *v <= 0.0) {
        return None;
    }
    let weights: Vec<f64> = variances.iter().map(|v| 1.0 / v).collect();
    let center = mean(values.iter().map(|v| v.value), &weights);
    let sum: f64 = values.iter().zip(&weights).map(|(v, w)| w * (v.value - center).powi(2)).sum();
    Some(ChiSquared::new(values.len() as f64 - 1.0).ok()?.sf(sum))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(list: &[(f64, f64)]) -> Vec<Measured> {
        list.iter().map(|(value, standard)| Measured { value: *value, standard: *standard }).collect()
    }

    #[test]
    fn what_is_common_cancels() {
        let two = values(&[(10.0, 0.5), (10.6, 0.5)]);
        let z = normal_quantile(0.975);
        let apart = drift(&[0.0, 1.0], &two, 0.0).unwrap();
        assert!((apart.change - 0.6).abs() < 1e-12);
        assert!((apart.change_half_width - z * 0.5_f64.sqrt()).abs() < 1e-12);
        let common = drift(&[0.0, 1.0], &two, 0.46).unwrap();
        assert!((common.change_half_width - z * 0.0768_f64.sqrt()).abs() < 1e-12);
        assert!(common.change_half_width < common.change && apart.change_half_width > apart.change);
        let all = drift(&[0.0, 1.0], &two, 0.6).unwrap();
        assert_eq!((all.change_half_width, all.steady_probability), (0.0, None));
    }

    #[test]
    fn a_line_is_found_with_its_uncertainty() {
        // Equal weights: u(slope) = u / √Σ(t − t̄)², here √2.
        let line = values(&[(1.0, 0.1), (3.0, 0.1), (5.0, 0.1)]);
        let found = drift(&[0.0, 1.0, 2.0], &line, 0.0).unwrap();
        let slope = found.slope.unwrap();
        assert!((slope.value - 2.0).abs() < 1e-12);
        assert!((slope.half_width - normal_quantile(0.975) * 0.1 / 2.0_f64.sqrt()).abs() < 1e-12);
        assert!(found.steady_probability.unwrap() < 1e-12);
        // χ² of 2 with 2 degrees of freedom: e⁻¹.
        let steady = drift(&[0.0, 1.0, 2.0], &values(&[(1.0, 1.0), (0.0, 1.0), (-1.0, 1.0)]), 0.0).unwrap();
        assert!((steady.steady_probability.unwrap() - (-1.0_f64).exp()).abs() < 1e-12);
    }

    #[test]
    fn one_value_or_one_moment_has_no_slope() {
        assert_eq!(drift(&[0.0], &values(&[(1.0, 1.0)]), 0.0), None);
        assert_eq!(drift(&[], &[], 0.0), None);
        let same = drift(&[1.0; 3], &values(&[(1.0, 1.0); 3]), 0.0).unwrap();
        assert_eq!(same.slope, None);
    }
}
