//! How much slow noise a record allows that it does not show, for the uncertainty of its mean.
//!
//! A random walk or flicker too weak to be seen beneath the white noise may still move the mean by several of its standard
//! deviations. Neither the largest likelihood nor an upper limit tells how far: each size that the record allows counts by
//! its likelihood. Beforehand every size counts alike by its logarithm, from a hundredth of the variance that white
//! noise gives the mean.

use super::fit::{Likelihood, Structure, toggled};
use super::model::NoiseModel;
use crate::estimate::{normal_probability, normal_quantile};

/// Sizes of a term: variance of the mean by it over that by white noise, least and largest.
const SIZES: (f64, f64) = (0.01, 1e5);
/// Share of confidence beforehand that there is no such noise. More of it makes the interval of pure white noise narrower and
/// takes from the coverage where a walk hides beneath the noise (simulated: without, 2.1 times the white noise alone and .94 at a
/// walk of ten times its variance; with a third, 1.5 times and .86).
const ABSENT: f64 = 0.1;
/// How many are tried.
const TRIED: usize = 36;
/// Largest size at which the steps between those tried are fine enough.
const FINE: f64 = 1e3;
/// Variance of the mean of flicker over B², above the lowest frequency it is counted from (1 over 2π lengths).
const FLICKER: f64 = 0.306;

/// Descriptions with their weights; each list varies one term.
pub type Allowed = Vec<Vec<(f64, NoiseModel)>>;

/// The sizes of flicker and random walk that a record allows; empty where the slow noise is large, and known.
pub fn allowed(likelihood: &Likelihood, supported: &Structure, found: &NoiseModel, length_s: f64) -> Allowed {
    let hours = length_s / 3600.0;
    let white = found.n * found.n / hours;
    let per_square = [(1usize, FLICKER), (2, hours / 3.0)];
    let shown = FLICKER * found.b * found.b + found.k * found.k * hours / 3.0;
    if !(white > 0.0 && white.is_finite()) || shown > FINE * white {
        return vec![];
    }
    let ratio = (SIZES.1 / SIZES.0).powf(1.0 / (TRIED - 1) as f64);
    let mut out = vec![];
    for (term, variance) in per_square {
        let structure = toggled(&toggled(supported, 1, true), 2, true);
        let mut points: Vec<(f64, f64, NoiseModel)> = vec![];
        let mut start = None;
        if let Some(without) = likelihood.maximise(&toggled(&structure, term, false), None, None) {
            points.push((ABSENT, without.deviance, without.model()));
        }
        let each = (1.0 - ABSENT) / TRIED as f64;
        for i in 0..TRIED {
            let size = (SIZES.0 * ratio.powi(i as i32) * white / variance).sqrt();
            let Some(point) = likelihood.maximise(&structure, Some((term, size)), start.as_ref()) else {
                continue;
            };
            points.push((each, point.deviance, point.model()));
            start = Some(point);
        }
        let least = points.iter().map(|p| p.1).fold(f64::INFINITY, f64::min);
        let weight = |prior: f64, deviance: f64| prior * (0.5 * (least - deviance)).exp();
        let total: f64 = points.iter().map(|p| weight(p.0, p.1)).sum();
        if !(total > 0.0 && total.is_finite()) {
            return vec![];
        }
        out.push(points.into_iter().map(|(prior, d, model)| (weight(prior, d) / total, model)).collect());
    }
    out
}

/// The deviation from zero that a mixture of normal laws stays below with the probability of a normal score. `laws`:
/// weights and standard deviations.
pub fn mixed_quantile(laws: &[(f64, f64)], score: f64) -> f64 {
    let wanted = normal_probability(score.abs());
    let largest = laws.iter().map(|l| l.1).fold(0.0, f64::max);
    let below = |x: f64| -> f64 {
        laws.iter().map(|(w, sd)| w * if *sd > 0.0 { normal_probability(x / sd) } else { 1.0 }).sum()
    };
    let (mut low, mut high) = (0.0, largest * (score.abs() + 1.0).max(normal_quantile(wanted) + 1.0));
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if below(middle) < wanted { low = middle } else { high = middle }
    }
    0.5 * (low + high) * score.signum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mixture_of_one_law_is_that_law() {
        for score in [-2.0, -0.5, 0.5, 1.96] {
            assert!((mixed_quantile(&[(0.4, 3.0), (0.6, 3.0)], score) - 3.0 * score).abs() < 1e-9);
        }
        let wide = mixed_quantile(&[(0.9, 1.0), (0.1, 5.0)], 1.96);
        assert!((2.0..9.8).contains(&wide), "{wide}");
    }
}
