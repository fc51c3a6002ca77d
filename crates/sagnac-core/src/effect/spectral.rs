//! Effects that change the spectrum of the noise.

use super::{LowPass, Place, SpectralSizing, Values};
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
    /// How many modes it holds.
    pub modes: usize,
    /// Samples of the record.
    pub samples: usize,
    /// Sample interval, s.
    pub dt_s: f64,
    /// True where the ends of the record were replaced by a draw of noise that is even about them, so that what a filter does
    /// at the ends leaks into no mode.
    pub even_ends: bool,
}

/// What a search for spectral effects may use.
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

/// How an effect changes the spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpectrumAct {
    /// Adds a density.
    Adds,
    /// Multiplies the density of everything else.
    Filters,
    /// Sets N, B or K of the claim free; its parameter is the whole coefficient.
    Frees(NoiseType),
}

/// An effect that changes the spectrum of the noise. Its parameters are positive and are fitted by their logarithms.
pub trait Spectrum: Sync {
    /// How it acts.
    fn act(&self) -> SpectrumAct;

    /// Two-sided density of a bin, (deg/h)²/Hz, or the factor of a filter, for fitted parameters. Unused for
    /// [`SpectrumAct::Frees`].
    fn density(&self, fitted: &[f64], bin: &ModeBin) -> f64;

    /// [`Spectrum::density`] of many bins.
    fn densities(&self, fitted: &[f64], bins: &[ModeBin]) -> Vec<f64> {
        bins.iter().map(|b| self.density(fitted, b)).collect()
    }

    /// Samples at either end of a record that a filter makes unlike noise that is even about the ends. They leak into the modes
    /// that the filter leaves next to nothing, the same few samples into all of them.
    fn unlike_at_ends(&self, _fitted: &[f64], _dt_s: f64) -> usize {
        0
    }

    /// Frequencies below the Nyquist frequency at which a filter of samples leaves nothing, Hz.
    fn zeros_hz(&self, _fitted: &[f64], _dt_s: f64) -> Vec<f64> {
        vec![]
    }

    /// The power of a parameter that the whole density is proportional to; `None` for one that changes its shape.
    fn scales_with(&self, _parameter: usize) -> Option<f64> {
        None
    }

    /// Whether a fit moves a parameter from where it began.
    fn moves(&self, _fitted: &[f64], _parameter: usize) -> bool {
        true
    }

    /// False where a fit ended at parameters that are another effect.
    fn plausible(&self, _fitted: &[f64]) -> bool {
        true
    }

    /// Parameters that a fit begins from, several.
    fn starts(&self, context: &SpectralContext<'_>) -> Vec<Vec<f64>>;

    /// Bounds of the fitted parameters.
    fn bounds(&self, context: &SpectralContext<'_>) -> Vec<Bounds>;

    /// Independent points that the search looks at: the p-value is multiplied by their number.
    fn trials(&self, context: &SpectralContext<'_>) -> f64;

    /// The parameters in the order of [`super::Effect::params`]; NaN for one not determined.
    fn parameters(&self, fitted: &[f64]) -> Vec<f64>;

    /// The fitted parameters of stated ones; `None` where one is missing.
    fn stated(&self, values: &Values) -> Option<Vec<f64>>;

    /// Adds the effect to a noise model for simulation of samples of `dt_s`.
    fn compose(&self, fitted: &[f64], dt_s: f64, noise: &mut Composite);

    /// The filter that simulated samples go through, where the noise model has none for it.
    fn low_pass(&self, _fitted: &[f64], _dt_s: f64) -> Option<LowPass> {
        None
    }

    /// Where it shows, principal place first, at most three.
    fn places(&self, fitted: &[f64], context: &SpectralContext<'_>) -> Vec<Place>;

    /// How large it is and where that is asked, to tell which size would have been noticed; `None` for one whose size no
    /// single number tells.
    fn sizing(&self, _context: &SpectralContext<'_>) -> Option<SpectralSizing> {
        None
    }

    /// True for one of which a record can hold several, each with parameters of its own.
    fn repeats(&self) -> bool {
        false
    }

    /// True for exponentially correlated noise, which has the spectrum of independent jumps between two levels.
    fn is_relaxation(&self) -> bool {
        false
    }

    /// What a claim states of a process that was identified in samples of `dt_s`; `None` for one of another kind.
    fn values_of(&self, _process: &Damped, _dt_s: f64) -> Option<Values> {
        None
    }

    /// True when the course of the process can be estimated sample by sample (slow or narrow-band).
    fn has_course(&self) -> bool {
        false
    }
}
