//! Flicker and rate random walk, sample by sample.

use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

/// A standard normal number.
pub(super) fn normal(rng: &mut Xoshiro256PlusPlus) -> f64 {
    StandardNormal.sample(rng)
}

/// What drifts.
pub(super) struct Drift {
    k: f64,
    walk: f64,
    weight: f64,
    /// 1/f noise as relaxations, three a decade: their times, s, and states.
    relax: Vec<(f64, f64)>,
}

impl Drift {
    /// 1/f noise of the one-sided density b²/(2πf), deg/h, and K, deg/h/sqrt(h).
    pub(super) fn new(b: f64, k: f64, rng: &mut Xoshiro256PlusPlus) -> Drift {
        let times = (0..16).map(|i| 0.3 * 10f64.powf(f64::from(i) / 3.0));
        let weight = b * (std::f64::consts::LN_10 / 3.0 / (2.0 * std::f64::consts::PI)).sqrt();
        let relax = times.map(|t| (t, weight * normal(rng))).collect();
        Drift { k, walk: 0.0, weight, relax }
    }

    /// The drift of the next sample, deg/h, after so many seconds.
    pub(super) fn next(&mut self, dt: f64, rng: &mut Xoshiro256PlusPlus) -> f64 {
        self.walk += self.k * (dt / 3600.0).sqrt() * normal(rng);
        let mut sum = self.walk;
        for (tau, x) in &mut self.relax {
            let r = (-dt / *tau).exp();
            *x = r * *x + self.weight * (1.0 - r * r).sqrt() * normal(rng);
            sum += *x;
        }
        sum
    }
}
