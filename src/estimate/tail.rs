//! Probabilities far out in the tails, where a table ends.

use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};
use statrs::function::gamma::ln_gamma;

/// Probability that χ² with `dof` degrees of freedom exceeds `value`; 1e-300 stands for less.
pub fn chi_square_tail(value: f64, dof: f64) -> f64 {
    if value.is_nan() || value <= 0.0 || dof <= 0.0 {
        return 1.0;
    }
    let exact = ChiSquared::new(dof).map_or(1.0, |d| d.sf(value));
    if exact > 1e-290 {
        return exact.min(1.0);
    }
    // The first term of the asymptotic series of the incomplete gamma function.
    let half = 0.5 * dof;
    let log = (half - 1.0) * (0.5 * value).ln() - 0.5 * value - ln_gamma(half);
    log.exp().clamp(1e-300, 1.0)
}

/// Probability that χ² with `dof` degrees of freedom lies as far from its middle as `value`, on either side.
pub fn chi_square_two_sided(value: f64, dof: f64) -> f64 {
    if dof < 1e4 {
        let below = ChiSquared::new(dof).map_or(1.0, |d| d.cdf(value));
        return (2.0 * chi_square_tail(value, dof).min(below)).clamp(1e-300, 1.0);
    }
    // The cube root is normal to 1e-7 there (Wilson and Hilferty 1931).
    let spread = 2.0 / (9.0 * dof);
    normal_two_sided(((value / dof).cbrt() - 1.0 + spread) / spread.sqrt())
}

/// Probability that a standard normal number is as far from 0 as `z`.
pub fn normal_two_sided(z: f64) -> f64 {
    (2.0 * Normal::standard().sf(z.abs())).clamp(1e-300, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails_have_their_published_values() {
        // Abramowitz and Stegun, tables 26.7 and 26.8; two degrees of freedom are an exponential.
        assert!((chi_square_tail(3.841_459, 1.0) - 0.05).abs() < 1e-7);
        assert!((chi_square_tail(18.307_04, 10.0) - 0.05).abs() < 1e-7);
        assert!((chi_square_tail(1000.0, 2.0).ln() + 500.0).abs() < 1e-6);
        assert!((chi_square_tail(1360.0, 2.0).ln() + 680.0).abs() < 1e-6);
        assert!((normal_two_sided(1.959_964) - 0.05).abs() < 1e-7);
        let both = chi_square_two_sided(20_000.0 + 1.959_964 * 200.0, 20_000.0);
        assert!((both - 0.05).abs() < 2e-3, "{both}");
    }

    #[test]
    fn nothing_is_certain_without_a_value() {
        assert_eq!(chi_square_tail(f64::NAN, 3.0), 1.0);
        assert_eq!(chi_square_tail(-1.0, 3.0), 1.0);
        assert_eq!(chi_square_tail(1e9, 4.0), 1e-300);
    }
}
