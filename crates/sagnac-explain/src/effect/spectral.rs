//! The spectrum that effects on the noise change, and the ways in which they do.

use crate::noise::data::NoiseType;

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
