//! What is put into the noise.

use super::records::RATE_HZ;
use rand::{RngExt as _, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

/// A generator of its own for what is put in.
fn random(seed: u64) -> Xoshiro256PlusPlus {
    Xoshiro256PlusPlus::seed_from_u64(seed ^ 0x7e57)
}

/// A standard normal number.
fn normal(rng: &mut Xoshiro256PlusPlus) -> f64 {
    StandardNormal.sample(rng)
}

/// A path of 0 and 1 with exponential dwells of mean `dwell` samples, averaged over each sample.
fn telegraph_path(samples: usize, dwell: f64, seed: u64) -> Vec<f64> {
    let mut rng = random(seed);
    let mut up = rng.random::<f64>() < 0.5;
    let mut left = -dwell * (1.0 - rng.random::<f64>()).ln();
    (0..samples)
        .map(|_| {
            let (mut rest, mut mean) = (1.0, 0.0);
            while left < rest {
                mean += if up { left } else { 0.0 };
                rest -= left;
                up = !up;
                left = -dwell * (1.0 - rng.random::<f64>()).ln();
            }
            left -= rest;
            mean + if up { rest } else { 0.0 }
        })
        .collect()
}

/// A run of samples.
#[derive(Debug, Clone, Copy)]
pub struct Group {
    /// Index of its first sample.
    pub first: usize,
    /// Number of its samples.
    pub samples: usize,
}

impl Group {
    /// Whether a sample belongs to it.
    pub fn holds(&self, index: usize) -> bool {
        (self.first..self.first + self.samples).contains(&index)
    }
}

/// Groups of outliers: `lengths` samples each, at random places that do not touch; deviation `times` the noise's.
pub fn bursts(rate: &mut [f64], sigma: f64, lengths: &[usize], times: f64, seed: u64) -> Vec<Group> {
    let mut rng = random(seed);
    let slot = rate.len() / lengths.len();
    let extra = sigma * (times * times - 1.0).max(0.0).sqrt();
    let mut groups = vec![];
    for (g, length) in lengths.iter().enumerate() {
        let room = slot - 2 * length - 20;
        let first = g * slot + 10 + (rng.random::<f64>() * room as f64) as usize;
        rate[first..first + length].iter_mut().for_each(|y| *y += extra * normal(&mut rng));
        groups.push(Group { first, samples: *length });
    }
    groups
}

/// Makes the deviation of the noise `profile(share of the record)` times what it was.
pub fn level(rate: &mut [f64], sigma: f64, profile: impl Fn(f64) -> f64, seed: u64) {
    let mut rng = random(seed);
    let n = rate.len() as f64;
    for (i, y) in rate.iter_mut().enumerate() {
        let g = profile((i as f64 + 0.5) / n);
        *y += sigma * (g * g - 1.0).max(0.0).sqrt() * normal(&mut rng);
    }
}

/// Adds a telegraph signal with dwells of mean `dwell` samples; the path.
pub fn telegraph(rate: &mut [f64], amplitude: f64, dwell: f64, seed: u64) -> Vec<f64> {
    let path = telegraph_path(rate.len(), dwell, seed);
    rate.iter_mut().zip(&path).for_each(|(y, p)| *y += amplitude * p);
    path
}

/// Adds a Markov process with a correlation time of `samples`.
pub fn markov(rate: &mut [f64], sigma: f64, samples: f64, seed: u64) {
    let mut rng = random(seed);
    let decay = (-1.0 / samples).exp();
    let mut x = sigma * normal(&mut rng);
    for y in rate {
        *y += x;
        x = decay * x + sigma * (1.0 - decay * decay).sqrt() * normal(&mut rng);
    }
}

/// Adds a narrow-band process: frequency in Hz, coherence time in s.
pub fn narrow_band(rate: &mut [f64], rms: f64, frequency_hz: f64, coherence_s: f64, seed: u64) {
    let mut rng = random(seed);
    let decay = (-1.0 / (coherence_s * RATE_HZ)).exp();
    let kick = rms * (1.0 - decay * decay).sqrt();
    let (mut a, mut b) = (rms * normal(&mut rng), rms * normal(&mut rng));
    for (i, y) in rate.iter_mut().enumerate() {
        let (sin, cos) = (std::f64::consts::TAU * frequency_hz * i as f64 / RATE_HZ).sin_cos();
        *y += a * cos + b * sin;
        a = decay * a + kick * normal(&mut rng);
        b = decay * b + kick * normal(&mut rng);
    }
}
