//! Spectra drawn from an expected one: how far the gain of an effect falls below its mean where few modes tell of it.

use crate::mismatch::spectral_data::SpectralData;
use rand::SeedableRng as _;
use rand_distr::{ChiSquared, Distribution as _};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Spectra that are drawn.
const DRAWS: usize = 400;
/// Seed of the spectra: a report is a function of recording and claim alone.
const SEED: u64 = 0x5a67_6e61_6320_0008;

/// Mean squares of the modes over what is expected of them: for each bin those of all spectra side by side.
pub(super) struct Draws(Vec<Vec<f64>>);

/// A spectrum that may be the true one: its densities, and what stands beside them in the log-likelihood.
pub(super) struct Rival {
    pub densities: Vec<f64>,
    pub prior: f64,
}

impl Draws {
    pub fn new(spectral: &SpectralData) -> Draws {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(SEED);
        let one = |bin| {
            let weight = spectral.weight(bin);
            let law = ChiSquared::new(weight).ok();
            (0..DRAWS).map(|_| law.map_or(1.0, |l| l.sample(&mut rng) / weight)).collect()
        };
        Draws(spectral.bins.iter().map(one).collect())
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
        let mut each: Vec<Vec<f64>> = rivals.iter().map(|(constant, _)| vec![*constant; DRAWS]).collect();
        // Bin by bin, so that the spectra of a bin are read once for all rivals.
        for (bin, drawn) in self.0.iter().enumerate() {
            for (gains, (_, factors)) in each.iter_mut().zip(&rivals) {
                let factor = factors.get(bin).copied().unwrap_or(0.0);
                gains.iter_mut().zip(drawn).for_each(|(g, x)| *g += factor * x);
            }
        }
        let best =
            |draw: usize| each.iter().filter_map(|g| g.get(draw)).copied().fold(f64::NEG_INFINITY, f64::max);
        let mut gains: Vec<f64> = (0..DRAWS).map(best).collect();
        gains.sort_by(f64::total_cmp);
        gains.get(DRAWS / 20).copied().unwrap_or(f64::NAN)
    }
}
