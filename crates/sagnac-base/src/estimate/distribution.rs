//! Distributions that confidence is read from: normal, χ², Student's t.
//!
//! Student's t is needed at any probability and any degrees of freedom. The library that gives its probabilities inverts
//! them by an iteration that need not end, so the inverse is here, in a bounded number of steps.

use crate::numeric::optimize::bisect;
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal, StudentsT};

/// The standard normal quantile of a probability.
pub fn normal_quantile(probability: f64) -> f64 {
    Normal::standard().inverse_cdf(probability.clamp(1e-15, 1.0 - 1e-15))
}

/// The standard normal cumulative probability.
pub fn normal_probability(z: f64) -> f64 {
    Normal::standard().cdf(z)
}

/// The quantile of χ² with `dof` degrees of freedom (not necessarily whole).
pub fn chi_square_quantile(probability: f64, dof: f64) -> f64 {
    // Exact inversion takes seconds there; the cube root (Wilson and Hilferty 1931) is right to 1e-7.
    if dof > 1e5 {
        let spread = 2.0 / (9.0 * dof);
        let z = normal_quantile(probability.clamp(1e-12, 1.0 - 1e-12));
        return dof * (1.0 - spread + z * spread.sqrt()).powi(3);
    }
    match ChiSquared::new(dof.max(1e-3)) {
        Ok(d) => d.inverse_cdf(probability.clamp(1e-12, 1.0 - 1e-12)),
        Err(_) => f64::NAN,
    }
}

/// Degrees of freedom from which the expansion about the normal distribution is used: its error is below 1e-9 there.
const EXPANSION_DOF: f64 = 1000.0;

/// Upper tail beyond `t`.
pub(super) fn student_upper_tail(t: f64, dof: f64) -> f64 {
    let dof = dof.max(1.0);
    if dof >= EXPANSION_DOF {
        // Wallace, Annals of Mathematical Statistics 30 (1959) 1121.
        let size = if dof.is_finite() { (dof * (t * t / dof).ln_1p()).sqrt() } else { t.abs() };
        let ratio = if dof.is_finite() { (8.0 * dof + 1.0) / (8.0 * dof + 3.0) } else { 1.0 };
        return normal_probability(-t.signum() * size * ratio);
    }
    StudentsT::new(0.0, 1.0, dof).map_or(f64::NAN, |d| d.sf(t))
}

/// The quantile of a probability.
pub fn student_quantile(probability: f64, dof: f64) -> f64 {
    let (dof, p) = (dof.max(1.0), probability.clamp(1e-15, 1.0 - 1e-15));
    if dof >= EXPANSION_DOF {
        // Abramowitz and Stegun 26.7.5.
        let z = normal_quantile(p);
        let (z2, inverse) = (z * z, 1.0 / dof);
        let first = z * (z2 + 1.0) / 4.0;
        let second = z * ((5.0 * z2 + 16.0) * z2 + 3.0) / 96.0;
        let third = z * (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) / 384.0;
        return z + inverse * (first + inverse * (second + inverse * third));
    }
    let tail = p.min(1.0 - p);
    if tail == 0.5 {
        return 0.0;
    }
    let (mut low, mut high) = (0.0, 1.0);
    while student_upper_tail(high, dof) > tail && high < 1e300 {
        (low, high) = (high, 2.0 * high);
    }
    let t = bisect(low, high, 80, |t| student_upper_tail(t, dof) > tail).middle();
    if p < 0.5 { -t } else { t }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_agree_with_tables() {
        // NIST/SEMATECH e-Handbook of Statistical Methods, table 1.3.6.7.2, with more digits from the closed forms for
        // 1, 2 and 4 degrees of freedom.
        for (p, dof, t) in [
            (0.975, 1.0, 12.706_204_736),
            (0.95, 2.0, 2.919_985_580),
            (0.975, 5.0, 2.570_581_836),
            (0.95, 10.0, 1.812_461_123),
            (0.995, 30.0, 2.749_995_654),
            (0.975, 100.0, 1.983_971_519),
            (0.975, 1000.0, 1.962_339_081),
            (0.975, f64::INFINITY, 1.959_963_985),
        ] {
            assert!(
                (student_quantile(p, dof) / t - 1.0).abs() < 1e-8,
                "{p} {dof}: {}",
                student_quantile(p, dof)
            );
            assert_eq!(student_quantile(1.0 - p, dof).signum(), -1.0);
        }
        assert_eq!(student_quantile(0.5, 5.0), 0.0);
        // The two ways meet.
        for p in [0.6, 0.9, 0.975, 0.999] {
            assert!((student_quantile(p, 999.999) / student_quantile(p, 1000.0) - 1.0).abs() < 1e-8, "{p}");
        }
    }

    #[test]
    fn every_probability_and_every_number_of_degrees_ends_and_comes_back() {
        let mut dof = 0.5;
        while dof < 1e30 {
            for p in [0.0, 1e-15, 1e-6, 0.01, 0.05, 0.3, 0.5, 0.7, 0.95, 0.975, 0.999_999, 1.0] {
                let t = student_quantile(p, dof);
                assert!(t.is_finite(), "{p} {dof}");
                if (1e-6..=0.999_999).contains(&p) {
                    assert!((student_upper_tail(t, dof) - (1.0 - p)).abs() < 1e-7, "{p} {dof}: {t}");
                }
            }
            dof *= 1.7;
        }
        assert!(student_quantile(0.95, f64::NAN).is_finite());
    }
}
