//! What a random contribution was in this very record: its best estimate given the recording, and what that leaves open.

use super::noise_fit::{Noise, base_index};
use super::spectral_data::SpectralData;
use crate::effect::{Model, SpectrumAct};

/// Root mean square of what a spectral effect added to the record, deg/h, and the standard deviation of it that the
/// recording leaves open. 0 for one that takes away, or filters.
///
/// A mode x of variance P holds a part of variance S: x S/P on average, with a variance of S (1 − S/P) about it.
pub fn added_rms(
    noise: &Noise,
    index: usize,
    fitted: &[f64],
    spectral: &SpectralData,
    residual: &[f64],
) -> (f64, f64) {
    let mut noise = noise.clone();
    let mut base = None;
    if let Some(part) = noise.spectra.get_mut(index) {
        part.fitted = fitted.to_vec();
        if let Model::Spectrum(s) = part.effect.model()
            && let SpectrumAct::Frees(term) = s.act()
        {
            base = base_index(term);
        }
    }
    if let (Some(i), Some(value)) = (base, fitted.first()) {
        noise.base[i] = *value;
    }
    let (own, whole) = (noise.added_densities(index, spectral), noise.densities(spectral));
    let n = spectral.drivers.samples.max(1) as f64;
    let (mut square, mut variance) = (0.0, 0.0);
    for ((bin, s), p) in spectral.bins.iter().zip(&own).zip(&whole) {
        let share = (s / p).clamp(0.0, 1.0);
        let open = share * (1.0 - share) * p / bin.dt_s;
        for x in residual.get(bin.mode..bin.mode + bin.modes).unwrap_or_default() {
            let estimate = x * share;
            square += estimate * estimate + open;
            variance += 2.0 * open * open + 4.0 * estimate * estimate * open;
        }
    }
    let rms = (square / n).sqrt();
    // d√(q/n) = dq/(2n rms).
    let deviation = if rms > 0.0 { variance.sqrt() / (2.0 * n * rms) } else { 0.0 };
    (rms, deviation)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::{Drivers, find};
    use crate::mismatch::terms::SpectrumIn;
    use crate::numeric::cosine::dct2;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn the_interval_of_an_added_walk_holds_what_was_added() {
        let (n, runs) = (2000, 200);
        // White noise of 1 deg/h and a walk of 0.03 deg/h a step, of which the claim knows nothing.
        let k = 0.03 * 60.0;
        let mut held = 0;
        for seed in 0..runs {
            let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(seed);
            let mut draw = || -> f64 { StandardNormal.sample(&mut rng) };
            let mut level = 0.0;
            let walk: Vec<f64> = (0..n)
                .map(|_| {
                    level += 0.03 * draw();
                    level
                })
                .collect();
            let series: Vec<f64> = walk.iter().map(|w| w + draw()).collect();
            let drivers = Drivers { dt_s: 1.0, samples: n, averaged: 1, ..Drivers::default() };
            let spectral = SpectralData::new(drivers, &series, &[]);
            let effect = find("excess_rrw").expect("in the catalogue");
            let noise = Noise {
                base: [1.0 / 60.0, 0.0, k],
                claimed: [1.0 / 60.0, 0.0, 0.0],
                bound: [0.0; 3],
                deviation: [0.0; 3],
                freed: [false, false, true],
                quantization_arcsec: 0.0,
                spectra: vec![SpectrumIn { effect, fitted: vec![k], stated: false }],
            };
            let (rms, deviation) = added_rms(&noise, 0, &[k], &spectral, &dct2(&series));
            let mean = walk.iter().sum::<f64>() / n as f64;
            let truth = (walk.iter().map(|w| (w - mean).powi(2)).sum::<f64>() / n as f64).sqrt();
            held += i32::from((truth - rms).abs() < 1.96 * deviation);
        }
        // 190 of 200 on average, give or take 3.1.
        assert!((178..=199).contains(&held), "{held} of {runs}");
    }
}
