//! The hypothesis before which an effect would have to show: its noise, which gives way within its priors, and its columns.
//!
//! The expected gain of an effect is that on the expected data (Cowan, Cranmer, Gross and Vitells, Eur. Phys. J. C 71,
//! 2011, 1554): the spectrum that the record would have on average with the effect in it, with the noise of the
//! hypothesis fitted to that as it would be fitted to a record.

use crate::effect::{MeanModel, Resolution};
use crate::mismatch::fitted_hypothesis::{FittedHypothesis, SpectralDataSet};
use crate::mismatch::hypothesis::{PartModes, columns, kept};
use crate::mismatch::noise_fit::{self, Noise, NoiseFit};
use crate::mismatch::spectral_data::SpectralData;
use crate::numeric::least_squares::{Normal, subtract};

/// Steps of a fit to expected data, which begins near its end.
const FIT_STEPS: usize = 20;

/// A hypothesis at one resolution.
pub(super) struct NullModel<'a> {
    best: &'a FittedHypothesis,
    spectra: &'a SpectralDataSet,
    spectral: &'a SpectralData,
    parts: Vec<PartModes>,
    powers: Vec<f64>,
    /// Penalised log-likelihood of the expected spectrum without an effect.
    pub top: f64,
    /// Part of the samples that hold what the gyro gave.
    usable: f64,
}

/// Expected gain of a course that the noise and the columns of the hypothesis do not take up.
pub(super) struct ResidualGain {
    /// Twice the expected gain, from the spectrum of the course and with the noise free.
    pub gain: f64,
    /// Standard deviation of the root of twice the gain.
    pub spread: f64,
}

impl<'a> NullModel<'a> {
    pub fn new(
        best: &'a FittedHypothesis,
        spectra: &'a SpectralDataSet,
        resolution: Resolution,
        usable: f64,
    ) -> NullModel<'a> {
        let spectral = spectra.of(resolution);
        let parts = spectra.part_modes(resolution, &best.hypothesis.courses);
        let powers = spectral.powers(&best.hypothesis.noise.densities(spectral));
        let top = fit_expected(&mut best.hypothesis.noise.clone(), &spectra.full, &best.fit.densities)
            .log_likelihood;
        NullModel { best, spectra, spectral, parts, powers, top, usable }
    }

    /// The data that it is at.
    pub fn spectral(&self) -> &SpectralData {
        self.spectral
    }

    /// Expected gain of a course, deg/h, one value a sample.
    pub fn of_course(&self, series: &[f64], model: &dyn MeanModel) -> ResidualGain {
        let mut modes = self.spectral.transform(series);
        let nuisances = kept(self.spectral, &self.best.hypothesis.courses);
        let all = columns(&nuisances, &self.parts);
        let (coefficients, _, left) = Normal::new(&all, &modes, &self.powers).solve();
        let spread = match model.replaces() {
            Some(own) if left > 0.0 => {
                let others: Vec<_> = nuisances.iter().copied().filter(|n| n.nuisance != own).collect();
                let free = Normal::new(&columns(&others, &self.parts), &modes, &self.powers).solve().2;
                (left / free.max(left)).sqrt()
            }
            _ => 1.0,
        };
        for ((column, _), c) in all.iter().zip(&coefficients) {
            subtract(&mut modes, column, *c);
        }
        let squares = |((_, deviation), c): (&(&[f64], f64), &f64)| (c / deviation).powi(2);
        let penalty: f64 = all.iter().zip(&coefficients).map(squares).sum();
        let excess: Vec<f64> = self.in_bins(&modes).into_iter().map(|e| self.usable * e).collect();
        ResidualGain { gain: self.of_excess(&excess) + self.usable * penalty, spread }
    }

    /// Density of modes of this resolution in the bins of the full one, (deg/h)²/Hz.
    fn in_bins(&self, modes: &[f64]) -> Vec<f64> {
        let full = &self.spectra.full;
        let each = self.spectral.drivers.averaged as f64 / full.drivers.averaged.max(1) as f64;
        let mut all = vec![0.0; full.length];
        all.iter_mut().zip(modes).for_each(|(a, m)| *a = m * each.sqrt());
        full.observed(&all)
    }

    /// Twice the log-likelihood that the hypothesis loses by so much more in each bin of its spectrum than it contains.
    fn of_excess(&self, excess: &[f64]) -> f64 {
        let expected: Vec<f64> = self.best.fit.densities.iter().zip(excess).map(|(s, e)| s + e).collect();
        let without = fit_expected(&mut self.best.hypothesis.noise.clone(), &self.spectra.full, &expected);
        2.0 * (self.top - without.log_likelihood)
    }
}

/// Fits a noise to an expected spectrum.
pub(super) fn fit_expected(noise: &mut Noise, spectral: &SpectralData, expected: &[f64]) -> NoiseFit {
    noise_fit::fit_in(noise, spectral, expected, FIT_STEPS)
}
