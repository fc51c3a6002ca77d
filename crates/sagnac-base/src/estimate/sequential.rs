//! Looks at a growing test: how much of a risk each may spend, and the normal score that decides at it.
//!
//! Sources: K. K. G. Lan, D. L. DeMets, Biometrika 70 (1983) 659 (spending functions); P. C. O'Brien, T. R. Fleming, Biometrics 35
//! (1979) 549 (shape); P. Armitage, C. K. McPherson, B. C. Rowe, J. R. Stat. Soc. A 132 (1969) 235 (recursive integration).

use super::distribution::{normal_probability, normal_quantile};
use super::tail::normal_two_sided;

/// Smallest probability that a look spends, and so the largest score asked of it, 7.0.
const LEAST_SPENT: f64 = 1e-12;

/// Normal score below which the density of a test that goes on is nothing.
const LOWEST_SCORE: f64 = 8.5;

/// Points of a density; even.
const DENSITY_STEPS: usize = 1600;

/// Least gain of information between looks, as a share of all, that the points resolve.
const LEAST_GAIN: f64 = 2e-4;

/// How the scores of the looks of one quantity hang together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dependence {
    /// What a look adds is independent of what was known: the correlation of two scores is the root of the ratio of their
    /// information.
    IndependentGains,
    /// Nothing is known of it. The looks share the risk, so that no dependence exceeds it.
    Unknown,
}

/// Risk that the O'Brien-Fleming spending function has spent at a share `t` of the information, of `risk` in all:
/// 2 - 2 Φ(z / √t) with Φ(z) = 1 - `risk` / 2. It is used here for one side, with the one-sided risk.
pub fn spent(risk: f64, t: f64) -> f64 {
    if t <= 0.0 {
        return 0.0;
    }
    normal_two_sided(normal_quantile(1.0 - 0.5 * risk) / t.min(1.0).sqrt())
}

/// The scores that decide at looks with these shares of the information, of which the last is 1; infinite where a look has
/// nothing to spend. `None` where the shares do not rise, or the risk is none.
///
/// A quantity exactly at its limit reaches one of them with the probability `risk`, on one side; with [`Dependence::Unknown`] with at
/// most that.
pub fn deciding_scores(risk: f64, shares: &[f64], dependence: Dependence) -> Option<Vec<f64>> {
    let rises = shares.windows(2).all(|pair| pair[0] < pair[1]);
    let sound = rises && shares.first()? > &0.0 && (shares.last()? - 1.0).abs() < 1e-9;
    if !(sound && risk > 0.0 && risk < 0.5) {
        return None;
    }
    let resolved = shares.windows(2).all(|pair| pair[1] - pair[0] >= LEAST_GAIN);
    let by_itself = dependence == Dependence::Unknown || !resolved;
    let mut scores = Vec::with_capacity(shares.len());
    let (mut before, mut left) = (0.0, 0.0);
    let mut going_on: Option<Density> = None;
    for t in shares {
        let total = spent(risk, *t);
        // What a look could not spend is left to the next one.
        let to_spend = total - before + left;
        before = total;
        if to_spend < LEAST_SPENT {
            left = to_spend;
            scores.push(f64::INFINITY);
            continue;
        }
        left = 0.0;
        match &going_on {
            None => scores.push(-normal_quantile(to_spend)),
            Some(_) if by_itself => scores.push(-normal_quantile(to_spend)),
            Some(density) => scores.push(density.score_that_spends(to_spend, *t)),
        }
        let score = *scores.last()?;
        going_on = Some(match &going_on {
            Some(density) if !by_itself => density.next(*t, score),
            _ => Density::first(*t, score),
        });
    }
    Some(scores)
}

/// Density of score times root of information, where the test went on: below the bound of the look.
struct Density {
    /// Share of the information.
    t: f64,
    /// Points with their weighted densities.
    points: Vec<(f64, f64)>,
}

impl Density {
    /// The density after the first look.
    fn first(t: f64, score: f64) -> Density {
        let root = t.sqrt();
        Density::over(t, score, |x| normal_density(x / root) / root)
    }

    /// The density after a further look.
    fn next(&self, t: f64, score: f64) -> Density {
        let step = (t - self.t).sqrt();
        Density::over(t, score, |x| {
            self.points.iter().map(|(y, w)| w * normal_density((x - y) / step) / step).sum()
        })
    }

    /// A density on the points of Simpson's rule.
    fn over(t: f64, score: f64, density: impl Fn(f64) -> f64) -> Density {
        let root = t.sqrt();
        let (low, high) = (-LOWEST_SCORE * root, score.min(LOWEST_SCORE) * root);
        let width = (high - low) / DENSITY_STEPS as f64;
        let points = (0..=DENSITY_STEPS).map(|i| {
            let weight = match i {
                0 | DENSITY_STEPS => 1.0,
                odd if odd % 2 == 1 => 4.0,
                _ => 2.0,
            };
            let x = low + i as f64 * width;
            (x, weight * width / 3.0 * density(x))
        });
        Density { t, points: points.collect() }
    }

    /// Probability of a score above `score` at share `t` after going on so far.
    fn beyond(&self, score: f64, t: f64) -> f64 {
        let (bound, step) = (score * t.sqrt(), (t - self.t).sqrt());
        self.points.iter().map(|(y, w)| w * normal_probability((y - bound) / step)).sum()
    }

    fn score_that_spends(&self, probability: f64, t: f64) -> f64 {
        let (mut low, mut high) = (-LOWEST_SCORE, LOWEST_SCORE);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.beyond(middle, t) > probability { low = middle } else { high = middle }
        }
        high
    }
}

fn normal_density(x: f64) -> f64 {
    (-0.5 * x * x).exp() / (2.0 * std::f64::consts::PI).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spending_function_ends_at_the_risk_and_spends_little_before() {
        assert!((spent(0.05, 1.0) - 0.05).abs() < 1e-9);
        // 2 - 2 Φ(1.959964 / √0.5) by a table of the normal law.
        assert!((spent(0.05, 0.5) - 0.005575).abs() < 1e-5, "{}", spent(0.05, 0.5));
        assert!(spent(0.05, 0.02) < 1e-40 && spent(0.05, 0.0) == 0.0);
    }

    #[test]
    fn published_bounds_are_found() {
        // Lan and DeMets, two-sided 5 % as one side at 2.5 %: five equal looks, O'Brien-Fleming type.
        let published = [4.8769, 3.3569, 2.6803, 2.2898, 2.0310];
        let found = deciding_scores(0.025, &[0.2, 0.4, 0.6, 0.8, 1.0], Dependence::IndependentGains).unwrap();
        for (p, f) in published.iter().zip(&found) {
            assert!((p - f).abs() < 2e-3, "{found:?}");
        }
    }

    #[test]
    fn the_bounds_are_reached_as_often_as_stated_by_a_walk_of_random_numbers() {
        let shares = [0.1, 0.25, 0.5, 1.0];
        let scores = deciding_scores(0.05, &shares, Dependence::IndependentGains).unwrap();
        let shared = deciding_scores(0.05, &shares, Dependence::Unknown).unwrap();
        assert!(scores.iter().zip(&shared).all(|(s, h)| s <= h), "{scores:?} {shared:?}");
        // Sums of uniform numbers, from a generator of two lines.
        let mut state = 88_172_645_463_325_252_u64;
        let mut uniform = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let walks = 40_000;
        let mut reached = 0;
        for _ in 0..walks {
            let (mut sum, mut at) = (0.0, 0.0);
            let mut any = false;
            for (t, score) in shares.iter().zip(&scores) {
                let gain: f64 = (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
                sum += gain * (t - at).sqrt();
                at = *t;
                any |= sum / t.sqrt() >= *score;
            }
            reached += u32::from(any);
        }
        let share = f64::from(reached) / f64::from(walks);
        assert!((share - 0.05).abs() < 0.004, "{share}");
    }

    #[test]
    fn looks_too_close_to_be_told_apart_share_the_risk_and_wrong_shares_are_refused() {
        let close = deciding_scores(0.05, &[0.5, 0.50001, 1.0], Dependence::IndependentGains).unwrap();
        let total: f64 = close.iter().map(|s| normal_probability(-s)).sum();
        assert!(total <= 0.05 + 1e-9, "{close:?}");
        for shares in [&[0.5, 0.4, 1.0][..], &[0.5][..], &[0.0, 1.0][..], &[][..]] {
            assert_eq!(deciding_scores(0.05, shares, Dependence::IndependentGains), None);
        }
        assert_eq!(deciding_scores(0.5, &[1.0], Dependence::IndependentGains), None);
    }
}
