//! The output is quantised in angle.

use crate::effect::sizing::numbers;
use crate::effect::{
    Detection, Domain, ModeBin, Param, Place, Reported, Rounding, SpectralContext, SpectralSizing, Spectrum,
    Values, number,
};
use crate::noise::composite::Composite;
use crate::noise::data::NoiseType;
use crate::noise::model::unit_density;
use crate::numeric::range::Bounds;

pub struct Quantization;

static PARAMS: [Param; 1] = [Param::reported("lsb_arcsec", "arcsec", 0.0, 1e6)];

describe! {
    Quantization, "quantization", Spectrum in Amplitude, needs [],
    confusers [ExcessArw, DeadZone],
    properties [carried_over],
    with {
        fn rounding(&self) -> Option<&'static dyn Rounding> {
            Some(&Quantization)
        }
    }
}

impl Rounding for Quantization {
    fn step_arcsec(&self, stated: &Values) -> Option<f64> {
        number(stated, PARAMS[0].name)
    }

    fn detection(&self, step_arcsec: f64, open_arcsec: f64, dt_s: f64) -> Detection {
        let step = step_arcsec / dt_s;
        // Successive errors of the angle are subtracted: twice the variance of a rounding error.
        let rms = step / 6f64.sqrt();
        let ci95 = [step_arcsec - open_arcsec, step_arcsec + open_arcsec];
        Detection {
            reported: vec![
                Reported::new(PARAMS[0].name, PARAMS[0].unit, step_arcsec, ci95),
                Reported::new("rms_deg_h", "deg/h", rms, [rms * 0.999, rms * 1.001]),
            ],
            stated: numbers([(PARAMS[0].name, step_arcsec)]),
            places: vec![Place { domain: Domain::Amplitude, from: 0.0, to: step }],
            parameters: 1,
            ..Detection::default()
        }
    }
}

impl Spectrum for Quantization {
    fn scales_with(&self, parameter: usize) -> Option<f64> {
        (parameter == 0).then_some(2.0)
    }

    fn densities(&self, fitted: &[f64], bins: &[ModeBin]) -> Vec<f64> {
        let lsb = fitted.first().copied().unwrap_or(0.0);
        let one = |bin: &ModeBin| {
            lsb * lsb / 12.0 * unit_density(NoiseType::Quantization, bin.frequency_hz, bin.dt_s)
        };
        bins.iter().map(one).collect()
    }

    fn starts(&self, context: &SpectralContext<'_>) -> Vec<Vec<f64>> {
        if let Some(grid_step) = context.grid_step_arcsec.filter(|l| *l > 0.0) {
            return vec![vec![grid_step]];
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

    fn bounds(&self, _context: &SpectralContext<'_>) -> Vec<Bounds> {
        vec![Bounds::new(1e-9, 1e6)]
    }

    fn compose(&self, fitted: &[f64], _dt_s: f64, noise: &mut Composite) {
        let q = fitted.first().copied().unwrap_or(0.0) / 12f64.sqrt();
        noise.terms.q = noise.terms.q.hypot(q);
    }

    fn sizing(&self, _context: &SpectralContext<'_>) -> Option<SpectralSizing> {
        let places = vec![vec![1.0]];
        Some(SpectralSizing { parameter: &PARAMS[0], position: 0, falls: false, places })
    }

    fn places(&self, fitted: &[f64], context: &SpectralContext<'_>) -> Vec<Place> {
        let (Some(lsb), Some(bin)) = (fitted.first(), context.bins.first()) else { return vec![] };
        vec![
            Place { domain: Domain::Amplitude, from: 0.0, to: lsb / bin.dt_s },
            Place { domain: Domain::Frequency, from: 0.25 / bin.dt_s, to: 0.5 / bin.dt_s },
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_of_the_angle_has_the_rms_of_two_errors_of_an_even_law() {
        let told = Quantization.detection(0.6, 0.01, 0.1);
        // A step of 6 deg/h: each error has step²/12.
        let rms = told.reported("rms_deg_h").unwrap().value;
        assert!((rms - (2.0 * 36.0 / 12.0f64).sqrt()).abs() < 1e-12, "{rms}");
        assert_eq!(told.reported("lsb_arcsec").unwrap().ci95, [0.59, 0.61]);
        assert_eq!(Quantization.step_arcsec(&told.stated), Some(0.6));
        assert!((told.places[0].to - 6.0).abs() < 1e-12);
    }

    #[test]
    fn the_density_of_the_rounding_adds_up_to_its_variance() {
        // Over all frequencies of 4000 modes at 0.1 s: step²/6.
        let n = 4000;
        let bin = |mode: usize| ModeBin {
            frequency_hz: mode as f64 / (2.0 * n as f64 * 0.1),
            mode,
            modes: 1,
            samples: n,
            dt_s: 0.1,
            even_ends: false,
        };
        let sum: f64 = (1..n).map(|k| Quantization.density(&[0.6], &bin(k)) / (0.1 * n as f64)).sum();
        assert!((sum / 6.0 - 1.0).abs() < 1e-3, "{sum}");
    }
}
