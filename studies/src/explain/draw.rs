//! Random draws from named streams, so that a change of one part of a case leaves the others as they were.

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal, StandardUniform};
use rand_xoshiro::Xoshiro256PlusPlus;

/// A stream of random numbers.
pub struct Draw(Xoshiro256PlusPlus);

/// FNV-1a over the bytes of a label, begun at a seed.
pub fn mixed(seed: u64, label: &str) -> u64 {
    let start = 0xcbf2_9ce4_8422_2325 ^ seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    label.bytes().fold(start, |h, b| (h ^ u64::from(b)).wrapping_mul(0x0000_0100_0000_01b3))
}

impl Draw {
    /// The stream called `label` of a seed.
    pub fn new(seed: u64, label: &str) -> Draw {
        Draw(Xoshiro256PlusPlus::seed_from_u64(mixed(seed, label)))
    }

    /// Evenly between two values.
    pub fn uniform(&mut self, from: f64, to: f64) -> f64 {
        let u: f64 = StandardUniform.sample(&mut self.0);
        from + (to - from) * u
    }

    /// Evenly in the logarithm between two positive values.
    pub fn log_uniform(&mut self, from: f64, to: f64) -> f64 {
        self.uniform(from.ln(), to.ln()).exp()
    }

    /// Standard normal.
    pub fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    /// Standard normal, values beyond two taken as two.
    pub fn clipped_normal(&mut self) -> f64 {
        self.normal().clamp(-2.0, 2.0)
    }

    /// Exponential of mean 1.
    pub fn exponential(&mut self) -> f64 {
        -(1.0 - self.uniform(0.0, 1.0)).ln()
    }

    /// An integer from 0 to `count` − 1.
    pub fn below(&mut self, count: usize) -> usize {
        (self.uniform(0.0, count as f64) as usize).min(count.saturating_sub(1))
    }

    /// True with a probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.uniform(0.0, 1.0) < probability
    }

    /// −1 or +1.
    pub fn sign(&mut self) -> f64 {
        if self.chance(0.5) { 1.0 } else { -1.0 }
    }

    /// One of several.
    pub fn pick<'a, T>(&mut self, of: &'a [T]) -> &'a T {
        &of[self.below(of.len())]
    }
}
