//! Probabilities of deciding: noncentral χ².

use crate::estimate::chi_square_tail;

/// Terms of the Poisson mixture on either side of its middle, in deviations of it.
const DEVIATIONS: f64 = 9.0;

/// Probability that a noncentral χ² of some degrees of freedom and noncentrality is at least `value`: central laws of
/// dof + 2j, mixed by a Poisson law of half the noncentrality (Johnson, Kotz and Balakrishnan 1995, 29.2).
pub(super) fn noncentral_tail(value: f64, dof: f64, noncentrality: f64) -> f64 {
    if value.is_nan() || value <= 0.0 {
        return 1.0;
    }
    let half = 0.5 * noncentrality.max(0.0);
    // Far above any threshold nothing is left to sum.
    if !half.is_finite() || 2.0 * half > value + 100.0 + 12.0 * (2.0 * half).sqrt() {
        return 1.0;
    }
    let width = DEVIATIONS * half.sqrt() + 12.0;
    let first = (half - width).max(0.0).floor();
    let last = (half + width).ceil();
    // ln of the Poisson weight, from the first term on.
    let mut ln_weight = -half + if first > 0.0 { first * half.ln() - ln_factorial(first) } else { 0.0 };
    let mut sum = 0.0;
    let mut j = first;
    while j <= last {
        sum += ln_weight.exp() * chi_square_tail(value, dof + 2.0 * j);
        j += 1.0;
        ln_weight += half.max(1e-300).ln() - j.ln();
    }
    sum.clamp(0.0, 1.0)
}

/// ln n!, by Stirling's series; exact to 1e-9 from 0 on.
fn ln_factorial(n: f64) -> f64 {
    let mut x = n + 1.0;
    let mut product = 0.0;
    while x < 12.0 {
        product += x.ln();
        x += 1.0;
    }
    let series = 1.0 / (12.0 * x) - 1.0 / (360.0 * x.powi(3)) + 1.0 / (1260.0 * x.powi(5));
    (x - 0.5) * x.ln() - x + 0.5 * (2.0 * std::f64::consts::PI).ln() + series - product
}

/// The value that a χ² law exceeds with some probability.
pub(super) fn quantile(probability: f64, dof: f64) -> f64 {
    bisected(0.0, 2000.0, |x| chi_square_tail(x, dof) <= probability)
}

/// The noncentrality from which on a threshold is exceeded with some probability.
pub(super) fn needed(threshold: f64, dof: f64, probability: f64) -> f64 {
    bisected(0.0, 4000.0, |x| noncentral_tail(threshold, dof, x) >= probability)
}

/// The smallest number between two of which something is true, if it is true of all larger ones.
fn bisected(mut low: f64, mut high: f64, is_true: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if is_true(middle) { high = middle } else { low = middle }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::normal_probability;

    #[test]
    fn one_degree_of_freedom_is_the_square_of_a_shifted_normal_number() {
        for (value, shift) in [(6.0f64, 0.5f64), (6.0, 3.0), (14.0, 5.0), (20.0, 12.0), (400.0, 21.0)] {
            let root = value.sqrt();
            let exact = normal_probability(shift - root) + normal_probability(-shift - root);
            let found = noncentral_tail(value, 1.0, shift * shift);
            assert!((found - exact).abs() < 1e-8, "{value} {shift}: {found} {exact}");
        }
    }

    #[test]
    fn published_values_of_more_degrees_of_freedom() {
        // Patnaik 1949 by Johnson et al., table 29.1: P(χ'² ≤ 1.765) = 0.0500 for 4 degrees and 4; ≤ 17.309 is 0.9500.
        assert!((noncentral_tail(1.765, 4.0, 4.0) - 0.95).abs() < 2e-4);
        assert!((noncentral_tail(17.309, 4.0, 4.0) - 0.05).abs() < 2e-4);
        assert_eq!((noncentral_tail(0.0, 2.0, 1.0), noncentral_tail(9.0, 1.0, 1e9)), (1.0, 1.0));
    }

    #[test]
    fn what_is_needed_gives_what_was_asked_for() {
        let needed = needed(14.0, 2.0, 0.95);
        assert!((noncentral_tail(14.0, 2.0, needed) - 0.95).abs() < 1e-9);
        assert!((chi_square_tail(quantile(1e-4, 3.0), 3.0) - 1e-4).abs() < 1e-9);
    }
}
