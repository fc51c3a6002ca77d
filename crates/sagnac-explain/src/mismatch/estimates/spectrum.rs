//! Parameters of a spectral effect.

use super::estimated::{Estimated, interval};
use crate::effect::{Effect, Model, SpectrumAct, Value};
use crate::estimate::SCORE_TWO_SIDED_95;
use crate::mismatch::contribution::added_rms;
use crate::mismatch::finding::ParameterValue;
use crate::mismatch::fitted_hypothesis::{FittedHypothesis, SpectralDataSet};
use crate::mismatch::noise_fit::{Which, base_index};

/// Relative deviation of a number that a fit does not move, as of a whole number of samples.
const FIXED_DEVIATION: f64 = 1e-6;

/// As the fit of the noise tells them.
pub(super) fn of_spectrum(
    effect: &'static dyn Effect,
    index: usize,
    best: &FittedHypothesis,
    spectra: &SpectralDataSet,
) -> Estimated {
    let spectral = &spectra.full;
    let Model::Spectrum(spectrum) = effect.model() else { return Estimated::default() };
    let noise = &best.hypothesis.noise;
    let part = &noise.spectra[index];
    let which: Vec<Option<usize>> = (0..part.fitted.len())
        .map(|p| {
            let wanted = match spectrum.act() {
                SpectrumAct::Unconstrains(term) => Which::Base(base_index(term).unwrap_or(0)),
                _ => Which::Effect(index, p),
            };
            best.fit.noise.which.iter().position(|w| *w == wanted)
        })
        .collect();
    let covariance = |i: usize, j: usize| match (which[i], which[j]) {
        (Some(a), Some(b)) => best.fit.noise.covariance[(a, b)],
        _ => 0.0,
    };
    let residual = &best.residual(spectra);
    let all = |fitted: &[f64]| {
        let mut out = spectrum.parameters(fitted);
        out.push(added_rms(noise, index, fitted, spectral, residual).rms_deg_h);
        out
    };
    let values = all(&part.fitted);
    let p = part.fitted.len();
    let slopes: Vec<Vec<f64>> = (0..p)
        .map(|i| {
            let moved = |step: f64| {
                let mut fitted = part.fitted.clone();
                fitted[i] *= step.exp();
                all(&fitted)
            };
            moved(1e-3).iter().zip(&moved(-1e-3)).map(|(a, b)| (a - b) / 2e-3).collect()
        })
        .collect();
    let deviation = |k: usize| {
        let mut sum = 0.0;
        for i in 0..p {
            for j in 0..p {
                sum += slopes[i][k] * covariance(i, j) * slopes[j][k];
            }
        }
        f64::max(sum, 0.0).sqrt()
    };
    let mut out = Estimated::default();
    for (i, (param, value)) in effect.params().iter().zip(&values).enumerate() {
        if !value.is_finite() {
            continue;
        }
        out.stated.insert(param.name.to_owned(), Value::Number(*value));
        if param.reported
            && let Some(ci95) = interval(param, *value, deviation(i).max(FIXED_DEVIATION * value.abs()))
        {
            let unit = param.unit.to_owned();
            out.reported.insert(param.name.to_owned(), ParameterValue { value: *value, unit, ci95 });
        }
    }
    let chance = added_rms(noise, index, &part.fitted, spectral, residual).deviation_deg_h;
    // What is added to a coefficient of the claim is known no better than the claim states that.
    let of_claim = match spectrum.act() {
        SpectrumAct::Unconstrains(term) => base_index(term).map_or(0.0, |i| {
            let moved = |step: f64| {
                let mut other = noise.clone();
                other.claimed[i] *= step.exp();
                added_rms(&other, index, &part.fitted, spectral, residual).rms_deg_h
            };
            noise.deviation[i] * (moved(1e-3) - moved(-1e-3)) / 2e-3
        }),
        _ => 0.0,
    };
    let (spread, last) =
        (values[values.len() - 1], deviation(values.len() - 1).hypot(chance).hypot(of_claim));
    if spread > 0.0 && spread.is_finite() {
        let factor = (SCORE_TWO_SIDED_95 * last / spread).min(30.0).exp();
        let ci95 = [spread / factor, spread * factor];
        out.reported
            .insert("rms_deg_h".to_owned(), ParameterValue { value: spread, unit: "deg/h".to_owned(), ci95 });
    }
    out
}
