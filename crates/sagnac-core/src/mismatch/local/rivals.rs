//! What explains a record of two levels by its spectrum alone.

use crate::effect::{EFFECTS, Model, SpectralContext, SpectrumAct};
use crate::mismatch::departures::White;
use crate::mismatch::noise_fit::{self, Noise};
use crate::mismatch::problem::Problem;
use crate::mismatch::terms::SpectrumIn;
use crate::mismatch::tried::Tried;

/// Gain of the best spectral effect of some kinds, and the noise beside it.
pub fn rival(problem: &Problem, tried: &Tried, kinds: &[&str]) -> Option<(f64, Noise)> {
    let spectral = &problem.spectra.full;
    let observed = &tried.fit.observed;
    let before = tried.fit.noise.log_likelihood;
    let context = SpectralContext {
        bins: &spectral.bins,
        observed,
        expected: &tried.fit.densities,
        grid_step_arcsec: problem.spectra.grid_step_arcsec,
    };
    let mut best: Option<(f64, Noise)> = None;
    for effect in EFFECTS.iter().filter(|e| kinds.contains(&e.kind())) {
        let Model::Spectrum(spectrum) = effect.model() else { continue };
        if spectrum.act() != SpectrumAct::Adds {
            continue;
        }
        let bounds = spectrum.bounds(&context);
        for start in spectrum.starts(&context) {
            let mut noise = tried.hypothesis.noise.clone();
            let fitted = start.iter().zip(&bounds).map(|(x, b)| b.clamp(*x)).collect();
            noise.spectra.push(SpectrumIn { effect: *effect, fitted, stated: false });
            let gain = noise_fit::fit(&mut noise, spectral, observed).log_likelihood - before;
            if best.as_ref().is_none_or(|b| gain > b.0) {
                noise.spectra.pop();
                best = Some((gain, noise));
            }
        }
    }
    best
}

/// Gain of flicker or random walk set free.
pub fn freed(problem: &Problem, tried: &Tried) -> f64 {
    let spectral = &problem.spectra.full;
    let observed = &tried.fit.observed;
    let mut best = 0.0f64;
    for i in 1..3 {
        for level in [1.0, 6.0, 33.0, 200.0] {
            let mut noise = tried.hypothesis.noise.clone();
            let beside = (noise.base[0] * 0.01).max(1e-9);
            noise.base[i] = noise.base[i].max(beside) * level;
            noise.freed[i] = true;
            let fitted = noise_fit::fit(&mut noise, spectral, observed).log_likelihood;
            best = best.max(fitted - tried.fit.noise.log_likelihood);
        }
    }
    best
}

/// Gain of the best line: half the power of the whitened residual in a pair of neighbouring modes, which hold nearly
/// all of a line.
pub fn line(problem: &Problem, tried: &Tried) -> f64 {
    let white = White::of(tried, &problem.spectra);
    white.modes.windows(4).map(|w| 0.5 * w.iter().map(|u| u * u).sum::<f64>()).fold(0.0, f64::max)
}
