//! The improvement by an effect: held-out likelihood, and the share of the misfit that it removes.

use super::heldout::Halves;
use super::hypothesis::Fit;
use super::select::{Chosen, Selection};
use super::spectral_data::SpectralData;
use statrs::function::gamma::digamma;

/// Whittle deviance of a fit from what was observed, less what chance leaves under a true hypothesis: 0 on average there.
///
/// In a bin of n modes of which I is the mean square, the deviance is n (I/S − 1 − ln I/S); under S it is
/// n (ln(n/2) − ψ(n/2)) on average.
fn misfit(spectral: &SpectralData, fit: &Fit) -> f64 {
    let one = |((bin, i), s): ((&crate::effect::ModeBin, &f64), &f64)| {
        let n = spectral.weight(bin);
        let ratio = (i / s).max(1e-300);
        let chance = (0.5 * n).ln() - digamma(0.5 * n);
        n * (ratio - 1.0 - ratio.ln() - chance)
    };
    spectral.bins.iter().zip(&fit.observed).zip(&fit.densities).map(one).sum()
}

/// Figures of one chosen effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Improvement {
    /// Gain of held-out log-likelihood over everything else that was chosen.
    pub heldout_gain: f64,
    /// Share of the misfit of everything else that goes with it, 0 to 1; `None` where there is no misfit to speak of.
    pub removed_share: Option<f64>,
}

/// Of a chosen effect.
pub fn of(
    chosen: &Chosen,
    selection: &Selection,
    spectral: &SpectralData,
    halves: &Halves,
    held_best: f64,
) -> Improvement {
    let heldout_gain = held_best - halves.judge(&chosen.without).log_likelihood;
    let (before, after) = (misfit(spectral, &chosen.without.fit), misfit(spectral, &selection.best.fit));
    // The misfit of a true hypothesis scatters about 0 by the root of twice its bins.
    let noise = (2.0 * spectral.bins.len() as f64).sqrt();
    let removed_share = (before > 2.0 * noise).then(|| (1.0 - after / before).clamp(0.0, 1.0));
    Improvement { heldout_gain, removed_share }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Drivers;
    use crate::mismatch::hypothesis::{Hypothesis, fit};
    use crate::mismatch::noise_fit::Noise;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn the_misfit_of_a_true_hypothesis_is_nothing_on_average() {
        let n = 4096;
        let mut sum = 0.0;
        let mut bins = 0;
        for seed in 0..40 {
            let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(seed);
            let series: Vec<f64> = (0..n).map(|_| StandardNormal.sample(&mut rng)).collect();
            let drivers = Drivers { dt_s: 1.0, samples: n, averaged: 1, ..Drivers::default() };
            let spectral = SpectralData::new(drivers, &series, &[]);
            // White noise of 1 deg/h at 1 Hz is N = 1/60.
            let base = [1.0 / 60.0, 0.0, 0.0];
            let noise = Noise {
                base,
                claimed: base,
                bound: [0.0; 3],
                deviation: [0.0; 3],
                unconstrained: [false; 3],
                quantization_arcsec: 0.0,
                spectra: vec![],
                discrepancy: None,
            };
            let fitted = fit(&mut Hypothesis { noise, courses: vec![] }, &spectral);
            sum += misfit(&spectral, &fitted);
            bins = spectral.bins.len();
        }
        // Each bin scatters by at most that of one mode, whose deviance has a variance of 4.
        let spread = (4.0 * bins as f64 / 40.0).sqrt();
        assert!((sum / 40.0).abs() < 4.0 * spread, "{} of {spread}", sum / 40.0);
    }
}
