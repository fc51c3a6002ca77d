//! The output is quantised in angle.

use crate::effect::{Domain, ModeBin, Param, Place, SpectralContext, Spectrum, SpectrumAct, Values, number};
use crate::noise::composite::Composite;
use crate::noise::data::NoiseType;
use crate::noise::model::unit_density;
use crate::numeric::range::Bounds;

pub struct Quantization;

static PARAMS: [Param; 1] = [Param::reported("lsb_arcsec", "arcsec", 0.0, 1e6)];

describe! {
    Quantization, "quantization", Spectrum in Amplitude, needs [],
    confusers ["excess_arw", "dead_zone"]
}

impl Spectrum for Quantization {
    fn act(&self) -> SpectrumAct {
        SpectrumAct::Adds
    }

    fn scales_with(&self, parameter: usize) -> Option<f64> {
        (parameter == 0).then_some(2.0)
    }

    fn density(&self, fitted: &[f64], bin: &ModeBin) -> f64 {
        let lsb = fitted.first().copied().unwrap_or(0.0);
        lsb * lsb / 12.0 * unit_density(NoiseType::Quantization, bin.frequency_hz, bin.dt_s)
    }

    fn starts(&self, context: &SpectralContext<'_>) -> Vec<Vec<f64>> {
        if let Some(quantization_grid) = context.grid_step_arcsec.filter(|l| *l > 0.0) {
            return vec![vec![quantization_grid]];
        }
        // Least squares of the excess on the shape, weighted by the expected scatter.
        let (mut both, mut square, mut level) = (0.0, 0.0, f64::INFINITY);
        for (i, bin) in context.bins.iter().enumerate() {
            let unit = unit_density(NoiseType::Quantization, bin.frequency_hz, bin.dt_s);
            let weight = bin.modes as f64 / context.expected[i].powi(2);
            both += weight * unit * (context.observed[i] - context.expected[i]);
            square += weight * unit * unit;
            if bin.frequency_hz * bin.dt_s > 0.25 {
                level = level.min(context.expected[i] / unit);
            }
        }
        if square <= 0.0 || !level.is_finite() {
            return vec![];
        }
        vec![vec![(12.0 * (both / square).max(0.01 * level)).sqrt()]]
    }

    fn bounds(&self, _look: &SpectralContext<'_>) -> Vec<Bounds> {
        vec![Bounds::new(1e-9, 1e6)]
    }

    fn trials(&self, _look: &SpectralContext<'_>) -> f64 {
        1.0
    }

    fn parameters(&self, fitted: &[f64]) -> Vec<f64> {
        fitted.to_vec()
    }

    fn stated(&self, values: &Values) -> Option<Vec<f64>> {
        number(values, PARAMS[0].name).map(|lsb| vec![lsb])
    }

    fn compose(&self, fitted: &[f64], _dt_s: f64, noise: &mut Composite) {
        let q = fitted.first().copied().unwrap_or(0.0) / 12f64.sqrt();
        noise.terms.q = noise.terms.q.hypot(q);
    }

    fn places(&self, fitted: &[f64], context: &SpectralContext<'_>) -> Vec<Place> {
        let (Some(lsb), Some(bin)) = (fitted.first(), context.bins.first()) else { return vec![] };
        vec![
            Place { domain: Domain::Amplitude, from: 0.0, to: lsb / bin.dt_s },
            Place { domain: Domain::Frequency, from: 0.25 / bin.dt_s, to: 0.5 / bin.dt_s },
        ]
    }
}
