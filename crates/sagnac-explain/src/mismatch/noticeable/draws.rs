//! Spectra drawn from an expected one: how far the gain of an effect falls below its mean where few modes tell of it.

use crate::mismatch::spectral_data::SpectralData;
use crate::numeric::order::SortNumbers;
use rand::SeedableRng as _;
use rand_distr::{ChiSquared, Distribution as _};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Spectra that are drawn.
const SPECTRUM_DRAWS: usize = 400;
/// Of them in a group.
const SIDE_BY_SIDE: usize = 16;
/// Largest share of the variance of a gain that bins have together which are held at their means.
const MAX_FIXED_SHARE: f64 = 1e-3;
/// Seed of the spectra: a report is a function of recording and claim alone.
const DRAW_SEED: u64 = 0x5a67_6e61_6320_0008;

/// Mean squares of the modes over what is expected of them, of the spectra of a group side by side.
struct Group {
    /// One entry a bin.
    bins: Vec<[f64; SIDE_BY_SIDE]>,
}

/// Spectra drawn from one that is 1 everywhere.
pub(super) struct Draws {
    groups: Vec<Group>,
    /// Degrees of freedom of each bin.
    weights: Vec<f64>,
}

/// A spectrum that may be the true one: its densities, and what stands beside them in the log-likelihood.
pub(super) struct Rival {
    pub densities: Vec<f64>,
    pub prior: f64,
}

/// Contribution of a bin to the gains of all rivals.
struct Telling {
    bin: usize,
    /// Gain of each rival for a mean square of 1 in this bin.
    factors: Vec<f64>,
}

impl Draws {
    pub fn new(spectral: &SpectralData) -> Draws {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(DRAW_SEED);
        let weights: Vec<f64> = spectral.bins.iter().map(|b| spectral.weight(b)).collect();
        let mut groups: Vec<Group> =
            (0..SPECTRUM_DRAWS / SIDE_BY_SIDE).map(|_| Group { bins: vec![] }).collect();
        for weight in &weights {
            let law = ChiSquared::new(*weight).ok();
            for group in &mut groups {
                group.bins.push(std::array::from_fn(|_| law.map_or(1.0, |l| l.sample(&mut rng) / weight)));
            }
        }
        Draws { groups, weights }
    }

    /// Twice the gain of the best of some rivals over another, which 95 of 100 spectra drawn from `truth` exceed.
    pub fn lowest(&self, truth: &[f64], rivals: &[Rival], over: &Rival) -> f64 {
        // Linear in the mean squares: a constant and a factor for each bin.
        let constant = |rival: &Rival| {
            let terms = rival.densities.iter().zip(&over.densities).zip(&self.weights);
            terms.map(|((s, o), n)| n * (o / s).ln()).sum::<f64>() + 2.0 * (rival.prior - over.prior)
        };
        let mut constants: Vec<f64> = rivals.iter().map(constant).collect();
        let telling = self.telling(truth, rivals, over, &mut constants);
        let mut gains = Vec::with_capacity(SPECTRUM_DRAWS);
        for group in &self.groups {
            let mut best = [f64::NEG_INFINITY; SIDE_BY_SIDE];
            for (rival, constant) in constants.iter().enumerate() {
                let mut gain = [*constant; SIDE_BY_SIDE];
                for Telling { bin, factors } in &telling {
                    let factor = factors[rival];
                    gain.iter_mut().zip(&group.bins[*bin]).for_each(|(g, x)| *g += factor * x);
                }
                best.iter_mut().zip(gain).for_each(|(b, g)| *b = b.max(g));
            }
            gains.extend(best);
        }
        gains.sort_ascending();
        gains.get(SPECTRUM_DRAWS / 20).copied().unwrap_or(f64::NAN)
    }

    /// The bins whose scatter makes that of a gain. What the others gain on average is added to the constants.
    fn telling(&self, truth: &[f64], rivals: &[Rival], over: &Rival, constants: &mut [f64]) -> Vec<Telling> {
        let factor = |rival: &Rival, bin: usize| {
            self.weights[bin] * truth[bin] * (1.0 / over.densities[bin] - 1.0 / rival.densities[bin])
        };
        let variance = |factor: f64, bin: usize| 2.0 * factor * factor / self.weights[bin];
        let all: Vec<Vec<f64>> =
            (0..self.weights.len()).map(|bin| rivals.iter().map(|r| factor(r, bin)).collect()).collect();
        let of_rival = |rival: usize| all.iter().enumerate().map(|(bin, f)| variance(f[rival], bin)).sum();
        let totals: Vec<f64> = (0..rivals.len()).map(of_rival).collect();
        let share = MAX_FIXED_SHARE / all.len().max(1) as f64;
        let mut telling = vec![];
        for (bin, factors) in all.into_iter().enumerate() {
            let tells = |(f, total): (&f64, &f64)| variance(*f, bin) > share * total;
            if factors.iter().zip(&totals).any(tells) {
                telling.push(Telling { bin, factors });
            } else {
                constants.iter_mut().zip(&factors).for_each(|(c, f)| *c += f);
            }
        }
        telling
    }
}
