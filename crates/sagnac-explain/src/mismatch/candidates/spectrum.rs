//! A change of the noise's spectrum as an addition.

use crate::effect::{Effect, SpectralContext, Spectrum, SpectrumAct};
use crate::mismatch::fitted_hypothesis::{
    Candidate, FittedHypothesis, SearchEffort, SpectralDataSet, bic_overcharge, own_odds, score_candidate,
};
use crate::mismatch::hypothesis::fit;
use crate::mismatch::noise_fit::{self, Noise, base_index};
use crate::mismatch::spectral_data::SpectralData;
use crate::mismatch::terms::SpectralTerm;
use crate::numeric::order::SortByNumber;

/// The best addition of a process, a filter or an unconstrained coefficient.
pub(super) fn try_spectrum(
    effect: &'static dyn Effect,
    spectrum: &'static dyn Spectrum,
    before: &FittedHypothesis,
    spectra: &SpectralDataSet,
) -> Option<Candidate> {
    let spectral = &spectra.full;
    let act = spectrum.act();
    let observed = &before.fit.observed;
    let context = SpectralContext {
        bins: &spectral.bins,
        observed,
        expected: &before.fit.densities,
        grid_step_arcsec: spectra.grid_step_arcsec,
    };
    if let SpectrumAct::Unconstrains(term) = act {
        let i = base_index(term)?;
        if before.hypothesis.noise.unconstrained[i] {
            return None;
        }
        return free_base(effect, i, before, spectra, observed);
    }
    let repeated =
        before.hypothesis.noise.spectra.iter().any(|s| !s.stated && s.effect.kind() == effect.kind());
    if repeated && !spectrum.repeats() {
        return None;
    }
    let starts = spectrum.starts(&context);
    let bounds = spectrum.bounds(&context);
    let begun = starts.iter().map(|start| {
        let mut noise = before.hypothesis.noise.clone();
        let fitted = start.iter().zip(&bounds).map(|(x, b)| b.clamp(*x)).collect();
        noise.spectra.push(SpectralTerm { effect, fitted, stated: false });
        noise
    });
    let noise = best_of(begun.collect(), spectral, observed)?;
    if noise.spectra.last().is_some_and(|s| !spectrum.plausible(&s.fitted)) {
        return None;
    }
    let parameters = before.parameters + noise.spectra.last().map_or(0, |s| s.fitted.len());
    finish_spectrum(effect, noise, parameters, spectrum.trials(&context), before, spectra)
}

/// The best fit of several beginnings: all for a few steps, then the leading two to the end.
fn best_of(begun: Vec<Noise>, spectral: &SpectralData, observed: &[f64]) -> Option<Noise> {
    const FIRST_STEPS: usize = 5;
    let mut fits: Vec<(Noise, f64)> = begun
        .into_iter()
        .map(|mut noise| {
            let value = noise_fit::fit_in(&mut noise, spectral, observed, FIRST_STEPS).log_likelihood;
            (noise, value)
        })
        .collect();
    fits.sort_descending_by(|a| a.1);
    fits.truncate(2);
    for (noise, value) in &mut fits {
        *value = noise_fit::fit(noise, spectral, observed).log_likelihood;
    }
    fits.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).map(|(noise, _)| noise)
}

/// N, B or K unconstrained, begun at the claim and well above it: a strong prior traps a fit that begins beside it.
fn free_base(
    effect: &'static dyn Effect,
    i: usize,
    before: &FittedHypothesis,
    spectra: &SpectralDataSet,
    observed: &[f64],
) -> Option<Candidate> {
    let spectral = &spectra.full;
    let noise = &before.hypothesis.noise;
    // A coefficient claimed to be zero begins where it would be a tenth of the spectrum somewhere.
    let smallest = spectral
        .units
        .iter()
        .zip(&before.fit.densities)
        .map(|(u, s)| (0.1 * s / u[i]).sqrt())
        .fold(f64::INFINITY, f64::min);
    let begin = if noise.base[i] > 0.0 { noise.base[i] } else { smallest };
    let fits = [1.0, 5.75, 33.0, 0.2].map(|factor| {
        let mut noise = noise.clone();
        noise.unconstrained[i] = true;
        noise.base[i] = begin * factor;
        noise.spectra.push(SpectralTerm { effect, fitted: vec![begin * factor], stated: false });
        noise
    });
    let noise = best_of(fits.to_vec(), spectral, observed)?;
    finish_spectrum(effect, noise, before.parameters + 1, 1.0, before, spectra)
}

fn finish_spectrum(
    effect: &'static dyn Effect,
    noise: Noise,
    parameters: usize,
    trials: f64,
    before: &FittedHypothesis,
    spectra: &SpectralDataSet,
) -> Option<Candidate> {
    let mut hypothesis = before.hypothesis.clone();
    hypothesis.noise = noise;
    let fit = fit(&mut hypothesis, &spectra.full);
    let numbers = parameters - before.parameters;
    // Each mode tells by its share of the power that is new.
    let densities = fit.densities.iter().zip(&before.fit.densities);
    let shares = densities
        .zip(&spectra.full.bins)
        .map(|((s, old), bin)| ((s - old) / s.max(*old)).powi(2) * spectra.full.weight(bin));
    let relief = bic_overcharge(numbers, shares.sum(), spectra.rows);
    let odds = before.odds_with(effect, own_odds(effect) + relief);
    let effort = SearchEffort { numbers, trials };
    let candidate = score_candidate(
        effect,
        FittedHypothesis { hypothesis, fit, parameters, odds },
        before,
        effort,
        spectra.rows,
    );
    (candidate.gain > 0.5).then_some(candidate)
}
