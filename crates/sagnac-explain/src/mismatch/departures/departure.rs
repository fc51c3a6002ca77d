//! The result of a test of the residual, and the whitened residual that tests look at.

use crate::effect::Place;
use crate::mismatch::fitted_hypothesis::{FittedHypothesis, SpectralDataSet};
use crate::numeric::cosine::inverse_dct2;
use rand::SeedableRng as _;
use rand_distr::{Distribution as _, StandardNormal};
use statrs::distribution::{DiscreteCDF as _, Poisson};

/// Seed of the draws for modes that are left out: a report is a function of recording and claim alone.
const UNSEEN_SEED: u64 = 0x5a67_6e61_6320_0008;

/// The largest departure of one test.
#[derive(Debug, Clone, PartialEq)]
pub struct Departure {
    /// Id of the test.
    pub test: &'static str,
    /// Place of the departure.
    pub place: Place,
    /// Its place in another view.
    pub beside: Option<Place>,
    /// Logarithm of the probability of as large a departure anywhere in the test. Of strong departures the probabilities
    /// are all too small to be told; which is the strongest is not.
    pub ln_p: f64,
    /// Its shape, where the test determines one.
    pub shape: Option<Shape>,
}

/// Shape of a departure.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Shape {
    /// Events that stand out by themselves.
    pub count: Option<usize>,
    /// About how long each is, s.
    pub each_s: Option<f64>,
    /// Standard deviation of what it adds at its place, deg/h.
    pub rms_deg_h: Option<f64>,
}

impl Departure {
    /// Probability of as large a departure anywhere in the test.
    pub fn p_value(&self) -> f64 {
        self.ln_p.exp().clamp(1e-300, 1.0)
    }

    /// True for a test that looks where others see the whole: their places come before its own.
    pub fn narrows(&self) -> bool {
        self.test == "track"
    }

    /// True for a test that looks for a repetition, of which single lines are parts.
    pub fn is_periodic(&self) -> bool {
        self.test == "comb"
    }

    /// True where it is below a probability in a family of so many tests.
    pub fn below(&self, probability: f64, tests: usize) -> bool {
        self.ln_p + (tests.max(1) as f64).ln() < probability.ln()
    }
}

/// Whitened residual of a fit.
pub struct White {
    /// Modes over their expected deviation.
    pub modes: Vec<f64>,
    /// The same in time.
    pub series: Vec<f64>,
    /// Expected deviation of each mode, deg/h.
    pub roots: Vec<f64>,
}

impl White {
    /// Whitens what a fitted hypothesis leaves.
    pub fn of(tried: &FittedHypothesis, spectra: &SpectralDataSet) -> White {
        let mut roots = tried.powers(spectra);
        roots.iter_mut().for_each(|p| *p = p.sqrt());
        let mut modes = tried.residual(spectra);
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(UNSEEN_SEED);
        for (k, (x, root)) in modes.iter_mut().zip(&roots).enumerate() {
            // A sample left out of the fit is no departure either: a draw stands for it.
            *x = if k == 0 || root.is_finite() { *x / root } else { StandardNormal.sample(&mut rng) };
        }
        let series = inverse_dct2(&modes);
        White { modes, series, roots }
    }
}

/// Natural logarithm of the probability that a Poisson number is at least as large as it was seen.
pub fn ln_at_least(seen: usize, expected: f64) -> f64 {
    let k = seen as f64;
    if seen == 0 || k <= expected {
        return 0.0;
    }
    // The number is as large where a gamma variable of that order is below what is expected.
    let exact = Poisson::new(expected).map_or(1.0, |law| law.sf(seen as u64 - 1));
    // Where the law ends, the bound of Chernoff.
    if exact > 1e-290 { exact.ln() } else { k * (expected / k).ln() + k - expected }
}

/// Dyadic windows of `values` positions from `shortest` up, each overlapping the next by half.
pub fn windows(values: usize, shortest: usize, mut see: impl FnMut(usize, usize)) {
    let mut length = shortest;
    while length <= values {
        let step = (length / 2).max(1);
        let mut from = 0;
        while from + length <= values {
            see(from, from + length);
            from += step;
        }
        length *= 2;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Domain;

    #[test]
    fn many_of_what_is_seldom_is_improbable() {
        // 1 − e^−0.1 (1 + 0.1 + 0.005) for three or more of 0.1.
        let three = 1.0 - (-0.1f64).exp() * 1.105;
        assert!((ln_at_least(3, 0.1) - three.ln()).abs() < 1e-9);
        assert_eq!((ln_at_least(0, 0.1), ln_at_least(2, 3.0)), (0.0, 0.0));
        // 400 (ln 0.01 − ln 400) + 400, which the sum itself is below by few nats.
        let bound = ln_at_least(400, 0.01);
        assert!((bound - (400.0 * (0.01f64 / 400.0).ln() + 400.0 - 0.01)).abs() < 1e-6, "{bound}");
    }

    #[test]
    fn windows_double_and_overlap_by_half() {
        let mut seen = vec![];
        windows(9, 2, |from, to| seen.push((from, to)));
        let twos: Vec<(usize, usize)> = (0..8).map(|i| (i, i + 2)).collect();
        assert_eq!(seen, [twos, vec![(0, 4), (2, 6), (4, 8), (0, 8)]].concat());
        windows(3, 4, |from, to| panic!("{from} {to}"));
    }

    #[test]
    fn departures_too_strong_for_a_double_are_ordered_by_their_logarithm() {
        let place = Place { domain: Domain::Time, from: 0.0, to: 1.0 };
        let of = |ln_p: f64| Departure { test: "level", place, beside: None, ln_p, shape: None };
        assert_eq!(of(-5000.0).p_value(), 1e-300);
        assert!((of(0.05f64.ln()).p_value() - 0.05).abs() < 1e-12);
        // Among ten tests a probability is worth ten times as much.
        assert!(of(0.0009f64.ln()).below(0.01, 10) && !of(0.0011f64.ln()).below(0.01, 10));
    }
}
