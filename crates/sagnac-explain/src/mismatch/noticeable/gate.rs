//! The gate that an effect must pass to be found, and how far beyond it an effect must be to pass it nearly always.
//!
//! Twice the gain of log-likelihood of an effect that is there follows a noncentral χ² law. Its noncentrality is twice the
//! gain that is expected of the effect itself.

use crate::estimate::{SCORE_ONE_SIDED_95, chi_square_tail};
use crate::numeric::optimize::bisect;

/// Probability with which an effect is to be noticed.
const NOTICE_PROBABILITY: f64 = 0.95;
/// The conditions that an effect must pass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Gate {
    /// Tests that everything amounts to that is looked at.
    pub family: f64,
    /// Probability at which a correct claim is called a mismatch.
    pub alpha: f64,
}

impl Gate {
    /// Least value of twice the gain with which an effect of so many parameters, looked for at so many independent
    /// positions, is found.
    pub fn threshold(&self, parameters: usize, trials: f64) -> f64 {
        let chance = self.alpha / (self.family.max(1.0) * trials.max(1.0));
        let free = parameters.max(1) as f64;
        // A quantile so far out is found on the tail itself.
        bisect(0.0, 2000.0, 60, |x| chi_square_tail(x, free) > chance).middle()
    }

    /// Margin of the root of twice a gain of some spread above the gate, to pass it with [`NOTICE_PROBABILITY`].
    pub fn margin(&self, spread: f64) -> f64 {
        SCORE_ONE_SIDED_95 * spread
    }

    /// Twice the expected gain with which such an effect is found in 95 of 100 records. `spread` is the standard deviation
    /// of the root of twice the gain: 1, and less where the claim's own uncertainty weighs against the effect.
    pub fn needed(&self, parameters: usize, trials: f64, spread: f64) -> f64 {
        let threshold = self.threshold(parameters, trials);
        if parameters <= 1 {
            return (threshold.sqrt() + self.margin(spread)).powi(2);
        }
        noncentrality(threshold, parameters)
    }
}

/// Noncentrality at which χ² exceeds a threshold with a probability of 95 %.
fn noncentrality(threshold: f64, dof: usize) -> f64 {
    let high = (threshold.sqrt() + 2.0 * SCORE_ONE_SIDED_95).powi(2);
    bisect(0.0, high, 50, |noncentral| exceeds(threshold, dof, noncentral) < NOTICE_PROBABILITY).middle()
}

/// Probability that noncentral χ² exceeds a value: a Poisson mixture of central ones.
fn exceeds(value: f64, dof: usize, noncentral: f64) -> f64 {
    let half = 0.5 * noncentral;
    let spread = 10.0 * half.sqrt() + 10.0;
    let (first, last) = ((half - spread).max(0.0) as u64, (half + spread) as u64);
    let ln_weight =
        |j: u64| -half + j as f64 * half.max(1e-300).ln() - statrs::function::gamma::ln_gamma(j as f64 + 1.0);
    (first..=last).map(|j| ln_weight(j).exp() * chi_square_tail(value, dof as f64 + 2.0 * j as f64)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    const GATE: Gate = Gate { family: 40.0, alpha: 0.01 };

    #[test]
    fn the_gate_is_that_of_chance() {
        // χ²₁ beyond 13.41 has a probability of 0.01/40.
        assert!((GATE.threshold(1, 1.0) - 13.412).abs() < 1e-2, "{}", GATE.threshold(1, 1.0));
        // Looked for at 10 000 positions: probability 2.5e-8 of χ²₂ is −2 ln 2.5e-8 = 35.01.
        assert!((GATE.threshold(2, 1e4) - 35.008_86).abs() < 1e-3, "{}", GATE.threshold(2, 1e4));
    }

    #[test]
    fn an_effect_beyond_the_gate_passes_it_in_95_of_100() {
        // One degree of freedom in closed form: |x + √λ| > √T.
        let (needed, threshold) = (GATE.needed(1, 1.0, 1.0), GATE.threshold(1, 1.0));
        assert!((needed.sqrt() - threshold.sqrt() - 1.644_854).abs() < 1e-6);
        assert!((exceeds(threshold, 1, needed) - 0.95).abs() < 1e-6);
        assert!(GATE.needed(1, 1.0, 0.2) < needed);
        // Two degrees: Marcum's Q₁(√λ, √T) = 0.95 by its integral over a circle about the effect.
        let needed = GATE.needed(2, 1.0, 1.0);
        let threshold = GATE.threshold(2, 1.0).sqrt();
        let steps = 400;
        let mut inside = 0.0;
        for i in 0..steps {
            for j in 0..steps {
                let at = |k: i32| -8.0 + 16.0 * (f64::from(k) + 0.5) / f64::from(steps);
                let (x, y) = (at(i), at(j));
                if (x + needed.sqrt()).hypot(y) < threshold {
                    inside += (-0.5 * (x * x + y * y)).exp();
                }
            }
        }
        let inside = inside * (16.0 / f64::from(steps)).powi(2) / (2.0 * std::f64::consts::PI);
        assert!((inside - 0.05).abs() < 1e-3, "{inside}");
    }
}
