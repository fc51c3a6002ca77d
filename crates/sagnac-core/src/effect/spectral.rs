//! Effects that change the spectrum of the noise.

use super::shared::power_law::power_law_places;
use super::{Effect, LowPass, Place, SpectralSizing, Values, number};
use crate::noise::composite::{Composite, Damped};
use crate::noise::data::NoiseType;
use crate::numeric::range::Bounds;

/// Neighbouring cosine modes (DCT-II) of a record that are taken together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeBin {
    /// Mean frequency of its modes, Hz.
    pub frequency_hz: f64,
    /// Order of its first mode.
    pub mode: usize,
    /// Number of modes.
    pub modes: usize,
    /// Samples of the record.
    pub samples: usize,
    /// Sample interval, s.
    pub dt_s: f64,
    /// True where the ends of the record were replaced by a draw of noise that is even about them, so that what a filter does
    /// at the ends leaks into no mode.
    pub even_ends: bool,
}

/// Data for a search of spectral effects.
pub struct SpectralContext<'a> {
    /// The bins, by frequency.
    pub bins: &'a [ModeBin],
    /// Mean square of the modes of the residual in each, as a two-sided density, (deg/h)²/Hz.
    pub observed: &'a [f64],
    /// Density of the current noise, (deg/h)²/Hz.
    pub expected: &'a [f64],
    /// Step that the values were found to be rounded to, as an angle increment, arcsec.
    pub grid_step_arcsec: Option<f64>,
}

/// The way in which an effect changes the spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpectrumAct {
    /// Adds a density.
    Adds,
    /// Multiplies the density of everything else.
    Filters,
    /// Unconstrains N, B or K of the claim; its parameter is the whole coefficient.
    Unconstrains(NoiseType),
}

/// An effect that changes the spectrum of the noise. Its parameters are positive and are fitted by their logarithms.
///
/// The defaults are those of the plainest effect, an unconstrained coefficient of the claim, which has only its `act`. A density
/// or a filter has its own `densities`, `starts`, `bounds`, `trials`, `compose` and `places`.
pub trait Spectrum: Effect {
    /// The way in which it acts.
    fn act(&self) -> SpectrumAct {
        SpectrumAct::Adds
    }

    /// Two-sided density of each bin, (deg/h)²/Hz, or the factor of a filter, for fitted parameters. Unused for
    /// [`SpectrumAct::Unconstrains`].
    fn densities(&self, _fitted: &[f64], bins: &[ModeBin]) -> Vec<f64> {
        vec![0.0; bins.len()]
    }

    /// [`Spectrum::densities`] of one bin.
    fn density(&self, fitted: &[f64], bin: &ModeBin) -> f64 {
        self.densities(fitted, &[*bin]).first().copied().unwrap_or(0.0)
    }

    /// Adds the effect to a noise model for simulation of samples of `dt_s`: an unconstrained coefficient replaces that of the
    /// model.
    fn compose(&self, fitted: &[f64], _dt_s: f64, noise: &mut Composite) {
        if let (SpectrumAct::Unconstrains(term), [coefficient]) = (self.act(), fitted) {
            noise.terms = noise.terms.with(term, *coefficient);
        }
    }

    /// Intervals in which it shows, principal one first, at most three: those of its term, for an unconstrained coefficient.
    fn places(&self, fitted: &[f64], context: &SpectralContext<'_>) -> Vec<Place> {
        match self.act() {
            SpectrumAct::Unconstrains(term) => power_law_places(term, fitted, context),
            SpectrumAct::Adds | SpectrumAct::Filters => vec![],
        }
    }

    /// Parameters that a fit begins from, several.
    fn starts(&self, _context: &SpectralContext<'_>) -> Vec<Vec<f64>> {
        vec![vec![]]
    }

    /// Bounds of the fitted parameters.
    fn bounds(&self, _context: &SpectralContext<'_>) -> Vec<Bounds> {
        vec![]
    }

    /// Independent points that the search looks at: the p-value is multiplied by their number.
    fn trials(&self, _context: &SpectralContext<'_>) -> f64 {
        1.0
    }

    /// The parameters in the order of [`Effect::params`](super::Effect::params); NaN for one not determined.
    fn parameters(&self, fitted: &[f64]) -> Vec<f64> {
        fitted.to_vec()
    }

    /// The fitted parameters of claimed ones; `None` where one is missing.
    fn claimed_parameters(&self, values: &Values) -> Option<Vec<f64>> {
        self.params().iter().map(|p| number(values, p.name)).collect()
    }

    /// The power of a parameter that the whole density is proportional to; `None` for one that changes its shape.
    fn scales_with(&self, _parameter: usize) -> Option<f64> {
        None
    }

    /// False for a parameter that a fit leaves where it began.
    fn is_refined(&self, _fitted: &[f64], _parameter: usize) -> bool {
        true
    }

    /// False where a fit ended at parameters that are another effect.
    fn plausible(&self, _fitted: &[f64]) -> bool {
        true
    }

    /// Samples at either end of a record that a filter makes different from noise that is even about the ends. They leak into
    /// the modes that the filter suppresses, the same few samples into all of them.
    fn edge_effect(&self, _fitted: &[f64], _dt_s: f64) -> usize {
        0
    }

    /// Frequencies below the Nyquist frequency at which a filter of samples leaves nothing, Hz.
    fn zeros_hz(&self, _fitted: &[f64], _dt_s: f64) -> Vec<f64> {
        vec![]
    }

    /// The filter that simulated samples go through, where the noise model has none for it.
    fn low_pass(&self, _fitted: &[f64], _dt_s: f64) -> Option<LowPass> {
        None
    }

    /// Size to ask for when it is determined which size would have been noticed; `None` for an effect whose size is no single
    /// number.
    fn sizing(&self, _context: &SpectralContext<'_>) -> Option<SpectralSizing> {
        None
    }

    /// True for an effect of which a record can hold several, each with parameters of its own.
    fn repeats(&self) -> bool {
        false
    }

    /// True for exponentially correlated noise, which has the spectrum of independent jumps between two levels.
    fn is_relaxation(&self) -> bool {
        false
    }

    /// Values by which a claim states a process that was identified in samples of `dt_s`; `None` for one of another kind.
    fn values_of(&self, _process: &Damped, _dt_s: f64) -> Option<Values> {
        None
    }

    /// True when the course of the process can be estimated sample by sample (slow or narrow-band).
    fn has_course(&self) -> bool {
        false
    }
}
