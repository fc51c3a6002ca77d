//! Sizes of effects on the spectrum that would have been noticed.

use super::draws::{Draws, Rival};
use super::gate::Gate;
use super::null_model::{NullModel, fit_expected};
use super::places::{At, Placed, summary};
use super::solve;
use crate::effect::{Effect, SpectralContext, SpectralSizing, Spectrum, SpectrumAct};
use crate::estimate::SCORE_ONE_SIDED_95;
use crate::mismatch::fitted_hypothesis::{FittedHypothesis, SpectralDataSet};
use crate::mismatch::noise_fit::{Noise, Which, base_index, whittle};
use crate::mismatch::noticeable_record::{Basis, NoticeableSize, WhyNot};
use crate::mismatch::spectral_data::SpectralData;
use crate::mismatch::terms::SpectralTerm;
use crate::noise::data::NoiseType;

/// Largest size of an effect on the spectrum, in its unit.
const MAX_SIZE: f64 = 1e9;

/// Sizes, over the true one, at which an effect is fitted.
const SIZE_GRID: [f64; 10] = [0.35, 0.5, 0.65, 0.8, 0.9, 1.0, 1.1, 1.25, 1.5, 2.0];

/// The spectrum before which effects would have to show.
pub(super) struct Expected<'a> {
    pub best: &'a FittedHypothesis,
    pub spectra: &'a SpectralDataSet,
    /// Log-likelihood of the expected spectrum of the hypothesis when it is fitted, over that of its values as they are.
    pub gained: f64,
    draws: Draws,
}

impl<'a> Expected<'a> {
    pub fn new(
        best: &'a FittedHypothesis,
        spectra: &'a SpectralDataSet,
        null_model: &NullModel<'_>,
    ) -> Expected<'a> {
        let densities = &best.fit.densities;
        let fitted = whittle(&spectra.full, densities, densities) + best.hypothesis.noise.prior();
        Expected {
            best,
            spectra,
            gained: (null_model.top - fitted).max(0.0),
            draws: Draws::new(&spectra.full),
        }
    }

    fn noise(&self) -> &Noise {
        &self.best.hypothesis.noise
    }

    fn spectral(&self) -> &SpectralData {
        &self.spectra.full
    }

    /// Twice what the hypothesis loses against itself with one more effect on the spectrum.
    pub fn gain_with(&self, effect: SpectralTerm) -> f64 {
        self.gain(&self.noise_with(effect))
    }

    fn noise_with(&self, effect: SpectralTerm) -> Noise {
        let mut truth = self.noise().clone();
        truth.spectra.push(effect);
        truth
    }

    /// Twice what the hypothesis loses against a noise that is the true one, on average.
    fn gain(&self, truth: &Noise) -> f64 {
        let densities = truth.densities(self.spectral());
        let with = whittle(self.spectral(), &densities, &densities) + truth.prior() + self.gained;
        let without = fit_expected(&mut self.noise().clone(), self.spectral(), &densities);
        2.0 * (with - without.log_likelihood)
    }

    /// Twice what the hypothesis loses at least in 95 of 100 records against an effect of a size; `spread` as in
    /// [`Gate::needed`]. The effect is fitted by its size alone, and each of its other parameters gains 1 on average.
    fn low(&self, truth: &dyn Fn(f64) -> Noise, size: f64, parameters: usize, spread: f64) -> f64 {
        let at = |times: f64| {
            let noise = truth(times * size);
            Rival { densities: noise.densities(self.spectral()), prior: noise.prior() + self.gained }
        };
        let densities = at(1.0).densities;
        let mut without = self.noise().clone();
        fit_expected(&mut without, self.spectral(), &densities);
        let over = Rival { densities: without.densities(self.spectral()), prior: without.prior() };
        let rivals: Vec<Rival> = SIZE_GRID.into_iter().map(at).collect();
        let lowest = self.draws.lowest(&densities, &rivals, &over);
        // The noise without the effect is fitted to each record as well.
        lowest + parameters.saturating_sub(1) as f64 - SCORE_ONE_SIDED_95.powi(2) * (1.0 - spread * spread)
    }
}

/// Of a process, a filter or a coefficient.
pub(super) fn size(
    effect: &'static dyn Effect,
    spectrum: &'static dyn Spectrum,
    expected: &Expected<'_>,
    gate: &Gate,
) -> Result<NoticeableSize, WhyNot> {
    if let SpectrumAct::Unconstrains(term) = spectrum.act() {
        return coefficient(effect, term, expected, gate).ok_or(WhyNot::NeverLargeEnough);
    }
    let context = SpectralContext {
        bins: &expected.spectral().bins,
        observed: &expected.best.fit.observed,
        expected: &expected.best.fit.densities,
        grid_step_arcsec: None,
    };
    let sizing = spectrum.sizing(&context).ok_or(WhyNot::NoSingleSize)?;
    let trials = spectrum.trials(&context);
    let placed = sizing.places.iter().filter_map(|place| {
        let size = at_place(effect, &sizing, place, expected, gate, trials)?;
        Some(Placed { size, rms_deg_h: None, at: told(effect, spectrum, &sizing, place) })
    });
    let found = summary(placed.collect(), sizing.falls).ok_or(WhyNot::NeverLargeEnough)?;
    Ok(NoticeableSize {
        kind: effect.kind().to_owned(),
        column: None,
        parameter: sizing.parameter.name.to_owned(),
        unit: sizing.parameter.unit.to_owned(),
        size: found.typical.size,
        claimed: None,
        below: sizing.falls,
        rms_deg_h: None,
        at: found.typical.at,
        worst: found.worst,
        basis: Basis::Spectrum,
    })
}

fn at_place(
    effect: &'static dyn Effect,
    sizing: &SpectralSizing,
    place: &[f64],
    expected: &Expected<'_>,
    gate: &Gate,
    trials: f64,
) -> Option<f64> {
    let threshold = gate.threshold(place.len(), trials);
    let value = |size: f64| if sizing.falls { 1.0 / size } else { size };
    let truth = |size: f64| {
        let mut fitted = place.to_vec();
        fitted.iter_mut().skip(sizing.position).take(1).for_each(|x| *x = value(size));
        expected.noise_with(SpectralTerm { effect, fitted, stated: false })
    };
    let gain = |size: f64| expected.low(&truth, size, place.len(), 1.0);
    let begin = value(place.get(sizing.position).copied()?);
    let needed = gate.needed(place.len(), trials, 1.0);
    let begin = solve::size(begin, MAX_SIZE, needed, |size| expected.gain(&truth(size)))?;
    solve::size(begin, MAX_SIZE, threshold, gain).map(value)
}

/// N, B or K: how much more than the claim states.
fn coefficient(
    effect: &'static dyn Effect,
    term: NoiseType,
    expected: &Expected<'_>,
    gate: &Gate,
) -> Option<NoticeableSize> {
    let i = base_index(term)?;
    let noise = expected.noise();
    if noise.unconstrained[i] {
        return None;
    }
    let claimed = noise.claimed[i];
    let truth = |size: f64| {
        let mut truth = noise.clone();
        truth.unconstrained[i] = true;
        truth.base[i] = claimed + size;
        truth
    };
    let begin = if claimed > 0.0 { claimed } else { noise.base[i].max(smallest(i, expected)) };
    let deviation = if claimed > 0.0 { noise.deviation[i] } else { 0.0 };
    let of_spread = |spread: f64| {
        let needed = gate.needed(1, 1.0, spread);
        let begin = solve::size(begin, MAX_SIZE, needed, |size| expected.gain(&truth(size)))?;
        let gain = |size: f64| expected.low(&truth, size, 1, spread);
        solve::size(begin, MAX_SIZE, gate.threshold(1, 1.0), gain)
    };
    let mut size = of_spread(1.0)?;
    if deviation > 0.0 {
        size = of_spread(spread(&truth(size), i, deviation, expected))?;
    }
    let parameter = effect.params().first()?;
    Some(NoticeableSize {
        kind: effect.kind().to_owned(),
        column: None,
        parameter: parameter.name.to_owned(),
        unit: parameter.unit.to_owned(),
        size,
        claimed: Some(claimed),
        below: false,
        rms_deg_h: None,
        at: At::new(),
        worst: None,
        basis: Basis::Spectrum,
    })
}

/// A coefficient that is a tenth of the spectrum somewhere.
fn smallest(i: usize, expected: &Expected<'_>) -> f64 {
    let one = |(u, s): (&[f64; 3], &f64)| (0.1 * s / u[i]).sqrt();
    expected.spectral().units.iter().zip(&expected.best.fit.densities).map(one).fold(f64::INFINITY, f64::min)
}

/// Standard deviation of the root of twice the gain of an unconstrained coefficient: the information of the record on its logarithm,
/// over that and the stated deviation together.
fn spread(truth: &Noise, i: usize, deviation: f64, expected: &Expected<'_>) -> f64 {
    let densities = truth.densities(expected.spectral());
    let fit = fit_expected(&mut truth.clone(), expected.spectral(), &densities);
    let own = fit.which.iter().position(|w| *w == Which::Base(i));
    let variance = own.map_or(0.0, |at| fit.covariance[(at, at)]);
    (variance / (variance + deviation * deviation)).sqrt()
}

/// The other reported parameters of a place.
fn told(effect: &dyn Effect, spectrum: &dyn Spectrum, sizing: &SpectralSizing, place: &[f64]) -> At {
    let named = effect.params().iter().zip(spectrum.parameters(place));
    let others =
        named.filter(|(p, v)| p.name != sizing.parameter.name && !p.unit.is_empty() && v.is_finite());
    others.map(|(p, v)| (p.name.to_owned(), v)).collect()
}
