//! Probabilities far out in the tails, where a table ends.

use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};
use statrs::function::gamma::ln_gamma;

/// Probabilities below this are computed by their logarithms.
const MIN_DIRECT_PROBABILITY: f64 = 1e-290;
/// The least probability that is reported.
const MIN_PROBABILITY: f64 = 1e-300;

/// Probability that χ² with `dof` degrees of freedom exceeds `value`; 1e-300 stands for less.
pub fn chi_square_tail(value: f64, dof: f64) -> f64 {
    ln_chi_square_tail(value, dof).exp().clamp(MIN_PROBABILITY, 1.0)
}

/// Natural logarithm of [`chi_square_tail`], without a floor.
pub fn ln_chi_square_tail(value: f64, dof: f64) -> f64 {
    if value.is_nan() || value <= 0.0 || dof <= 0.0 {
        return 0.0;
    }
    let exact = ChiSquared::new(dof).map_or(1.0, |d| d.sf(value));
    if exact > MIN_DIRECT_PROBABILITY {
        return exact.min(1.0).ln();
    }
    // The continued fraction of the incomplete gamma function (Abramowitz and Stegun 6.5.31) by Lentz's method.
    let (a, z) = (0.5 * dof, 0.5 * value);
    let mut b = z + 1.0 - a;
    let (mut c, mut d) = (1e300, 1.0 / b);
    let mut h = d;
    for i in 1..1000 {
        let an = -f64::from(i) * (f64::from(i) - a);
        b += 2.0;
        d = 1.0 / (an * d + b);
        c = b + an / c;
        let factor = c * d;
        h *= factor;
        if (factor - 1.0).abs() < 1e-12 {
            break;
        }
    }
    a * z.ln() - z - ln_gamma(a) + h.max(f64::MIN_POSITIVE).ln()
}

/// ln of the probability that χ² with `dof` degrees of freedom is below `value`.
fn ln_chi_square_below(value: f64, dof: f64) -> f64 {
    let below = ChiSquared::new(dof).map_or(1.0, |d| d.cdf(value));
    if below > MIN_DIRECT_PROBABILITY {
        return below.ln();
    }
    // The series of the incomplete gamma function (Abramowitz and Stegun 6.5.29).
    let (a, z) = (0.5 * dof, 0.5 * value.max(f64::MIN_POSITIVE));
    let (mut term, mut sum) = (1.0 / a, 1.0 / a);
    for i in 1..1000 {
        term *= z / (a + f64::from(i));
        sum += term;
        if term < 1e-12 * sum {
            break;
        }
    }
    a * z.ln() - z - ln_gamma(a) + sum.ln()
}

/// Probability that χ² with `dof` degrees of freedom lies as far from its middle as `value`, on either side.
pub fn chi_square_two_sided(value: f64, dof: f64) -> f64 {
    ln_chi_square_two_sided(value, dof).exp().clamp(MIN_PROBABILITY, 1.0)
}

/// Natural logarithm of [`chi_square_two_sided`], without a floor.
pub fn ln_chi_square_two_sided(value: f64, dof: f64) -> f64 {
    if dof < 1e4 {
        let nearer = ln_chi_square_tail(value, dof).min(ln_chi_square_below(value, dof));
        return (std::f64::consts::LN_2 + nearer).min(0.0);
    }
    // The cube root is normal to 1e-7 there (Wilson and Hilferty 1931).
    let spread = 2.0 / (9.0 * dof);
    ln_normal_two_sided(((value / dof).cbrt() - 1.0 + spread) / spread.sqrt())
}

/// Probability that a standard normal number is as far from 0 as `z`.
pub fn normal_two_sided(z: f64) -> f64 {
    ln_normal_two_sided(z).exp().clamp(MIN_PROBABILITY, 1.0)
}

/// Natural logarithm of [`normal_two_sided`], without a floor.
pub fn ln_normal_two_sided(z: f64) -> f64 {
    let exact = 2.0 * Normal::standard().sf(z.abs());
    if exact > MIN_DIRECT_PROBABILITY { exact.min(1.0).ln() } else { ln_chi_square_tail(z * z, 1.0) }
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
    fn logarithms_go_on_where_probabilities_end() {
        // Two degrees of freedom: e^(−x/2). Four: e^(−x/2)(1 + x/2). One: Mills' ratio of the normal law.
        assert!((ln_chi_square_tail(1e5, 2.0) + 5e4).abs() < 1e-6);
        assert!((ln_chi_square_tail(1e5, 4.0) - (-5e4 + 50_001f64.ln())).abs() < 1e-6);
        let z = 100.0f64;
        let mills =
            -0.5 * z * z - (z * (0.5 * std::f64::consts::PI).sqrt()).ln() + (1.0 - 1.0 / (z * z)).ln();
        assert!((ln_normal_two_sided(z) - mills).abs() < 1e-6);
        // Ten million times less than the mean of six degrees of freedom: x³/48.
        let x = 1e-120f64;
        assert!((ln_chi_square_below(x, 6.0) - (3.0 * x.ln() - 48f64.ln())).abs() < 1e-6);
        // Both sides of the change of formula agree with one another.
        let at = |x: f64| ln_chi_square_tail(x, 7.0);
        assert!((at(1370.0) - 0.5 * (at(1360.0) + at(1380.0))).abs() < 1e-3);
    }

    #[test]
    fn nothing_is_certain_without_a_value() {
        assert_eq!(chi_square_tail(f64::NAN, 3.0), 1.0);
        assert_eq!(chi_square_tail(-1.0, 3.0), 1.0);
        assert_eq!(chi_square_tail(1e9, 4.0), 1e-300);
    }
}
