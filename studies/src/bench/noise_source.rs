//! Noise of known strength, by sums that share nothing with the analysis.
//!
//! Two-sided densities in (deg/h)²/Hz as IEEE Std 952 defines them: white 3600 N², flicker B²/(2πf), random walk
//! K²/(3600 (2πf)²).

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

/// A seeded source of normal deviates and of noise made from them.
pub struct NoiseSource {
    rng: Xoshiro256PlusPlus,
}

impl NoiseSource {
    /// A source of its own for every seed.
    pub fn new(seed: u64) -> NoiseSource {
        NoiseSource { rng: Xoshiro256PlusPlus::seed_from_u64(seed) }
    }

    /// A standard normal deviate.
    pub fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.rng)
    }

    /// A deviate that is uniform between two bounds.
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        use rand::RngExt;
        low + (high - low) * self.rng.random::<f64>()
    }

    /// White noise of coefficient `n` in deg/√h, in deg/h, sampled every `dt_s`.
    pub fn white(&mut self, n: f64, dt_s: f64, len: usize) -> Vec<f64> {
        let sigma = 60.0 * n / dt_s.sqrt();
        (0..len).map(|_| sigma * self.normal()).collect()
    }

    /// A random walk of coefficient `k` in deg/h/√h that starts at zero.
    pub fn walk(&mut self, k: f64, dt_s: f64, len: usize) -> Vec<f64> {
        let step = k * (dt_s / 3600.0).sqrt();
        let mut level = 0.0;
        (0..len)
            .map(|_| {
                level += step * self.normal();
                level
            })
            .collect()
    }

    /// A Gauss-Markov process of standard deviation `sigma` and correlation time `tau_s`, stationary from the start.
    pub fn markov(&mut self, sigma: f64, tau_s: f64, dt_s: f64, len: usize) -> Vec<f64> {
        let keep = (-dt_s / tau_s).exp();
        let fresh = sigma * (1.0 - keep * keep).sqrt();
        let mut level = sigma * self.normal();
        (0..len)
            .map(|_| {
                let now = level;
                level = keep * level + fresh * self.normal();
                now
            })
            .collect()
    }

    /// Flicker of coefficient `b` in deg/h: a ladder of Markov processes, four to the octave in correlation time, from half
    /// a sample to thirty times the record. The density of a continuum of processes with equal variance
    /// per logarithm of correlation time is `∫ 2σ²τ/(1+(2πfτ)²) dln τ = σ²/(2f)` two-sided, so that `σ² = B²/π` for
    /// each unit of ln τ.
    pub fn flicker(&mut self, b: f64, dt_s: f64, len: usize) -> Vec<f64> {
        let step = 2f64.ln() / 4.0;
        let sigma = b * (step / std::f64::consts::PI).sqrt();
        let longest = 30.0 * dt_s * len as f64;
        let mut sum = vec![0.0; len];
        let mut tau = 0.5 * dt_s;
        while tau < longest {
            for (s, x) in sum.iter_mut().zip(self.markov(sigma, tau, dt_s, len)) {
                *s += x;
            }
            tau *= step.exp();
        }
        sum
    }
}

/// Adds one series to another.
pub fn add(to: &mut [f64], what: &[f64]) {
    for (t, w) in to.iter_mut().zip(what) {
        *t += w;
    }
}

/// The text of a recording: a header and rows of columns, with as many digits as a double holds to 1e-9 of its size.
pub fn csv(header: &str, columns: &[&[f64]]) -> String {
    use std::fmt::Write;
    let mut text = format!("{header}\n");
    for row in 0..columns.first().map_or(0, |c| c.len()) {
        for (i, column) in columns.iter().enumerate() {
            let comma = if i == 0 { "" } else { "," };
            let _ = write!(text, "{comma}{:.9}", column[row]);
        }
        text.push('\n');
    }
    text
}
