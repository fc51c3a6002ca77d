//! Spectra drawn from an expected one: how far the gain of an effect falls below its mean where few modes tell of it.

use crate::mismatch::spectral_data::SpectralData;
use rand::SeedableRng as _;
use rand_distr::{ChiSquared, Distribution as _};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Spectra that are drawn.
const DRAWS: usize = 400;
/// Seed of the spectra: a report is a function of recording and claim alone.
const SEED: u64 = 0x5a67_6e61_6320_0008;

/// Mean squares of the modes of each bin over what is expected of them, spectrum by spectrum.
pub(super) struct Draws(Vec<Vec<f64>>);

/// A spectrum that may be the true one: its densities, and what stands beside them in the log-likelihood.
pub(super) struct Rival {
    pub densities: Vec<f64>,
    pub prior: f64,
}

impl Draws {
    pub fn new(spectral: &SpectralData) -> Draws {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(SEED);
        let laws: Vec<(Option<ChiSquared<f64>>, f64)> =
            spectral.bins.iter().map(|b| spectral.weight(b)).map(|n| (ChiSquared::new(n).ok(), n)).collect();
        let mut one = || laws.iter().map(|(law, n)| law.map_or(1.0, |l| l.sample(&mut rng) / n)).collect();
        Draws((0..DRAWS).map(|_| one()).collect())
    }

    /// Twice the gain of the best of some rivals over another, which 95 of 100 spectra drawn from `truth` exceed.
    pub fn lowest(&self, truth: &[f64], rivals: &[Rival], over: &Rival, spectral: &SpectralData) -> f64 {
        let weights: Vec<f64> = spectral.bins.iter().map(|b| spectral.weight(b)).collect();
        // Linear in the mean squares: a constant and a factor for each bin.
        let of = |rival: &Rival| {
            let terms = rival.densities.iter().zip(&over.densities).zip(&weights);
            let constant: f64 = terms.clone().map(|((s, o), n)| n * (o / s).ln()).sum();
            let factors: Vec<f64> =
                terms.zip(truth).map(|(((s, o), n), t)| n * t * (1.0 / o - 1.0 / s)).collect();
            (constant + 2.0 * (rival.prior - over.prior), factors)
        };
        let rivals: Vec<(f64, Vec<f64>)> = rivals.iter().map(of).collect();
        let gain = |drawn: &Vec<f64>| {
            let of = |(constant, factors): &(f64, Vec<f64>)| {
                constant + factors.iter().zip(drawn).map(|(f, x)| f * x).sum::<f64>()
            };
            rivals.iter().map(of).fold(f64::NEG_INFINITY, f64::max)
        };
        let mut gains: Vec<f64> = self.0.iter().map(gain).collect();
        gains.sort_by(f64::total_cmp);
        gains.get(DRAWS / 20).copied().unwrap_or(f64::NAN)
    }
}
