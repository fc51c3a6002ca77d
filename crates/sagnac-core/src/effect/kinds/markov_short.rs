//! Exponentially correlated noise whose correlation time is a few samples.

use crate::effect::shared::markov::{SHORT_SAMPLES, densities, process, starts_between};
use crate::effect::shared::search::log_grid;
use crate::effect::{
    Domain, Family, ModeBin, Param, Place, SpectralContext, SpectralSizing, Spectrum, SpectrumAct, Value,
    Values, number,
};
use crate::noise::composite::{Composite, Damped};
use crate::numeric::range::Bounds;

pub struct MarkovShort;

static PARAMS: [Param; 2] = [
    Param::reported("correlation_time_s", "s", 1e-6, 1e7),
    Param::reported("sigma_deg_h", "deg/h", 0.0, 1e6),
];

describe! {
    MarkovShort, "markov_short", Spectrum in Lag, needs [],
    confusers ["excess_arw", "bandwidth_filter", "markov_long"],
    with {
        fn family(&self) -> Option<Family> {
            Some(Family::Spectrum)
        }
    }
}

impl Spectrum for MarkovShort {
    fn act(&self) -> SpectrumAct {
        SpectrumAct::Adds
    }

    fn scales_with(&self, parameter: usize) -> Option<f64> {
        (parameter == 1).then_some(2.0)
    }

    fn is_relaxation(&self) -> bool {
        true
    }

    fn values_of(&self, process: &Damped, dt_s: f64) -> Option<Values> {
        let time = process.decay_time_s;
        let own = process.frequency_hz == 0.0 && time < SHORT_SAMPLES * dt_s;
        let values = [time, process.rms_deg_h].map(Value::Number);
        own.then(|| PARAMS.iter().map(|p| p.name.to_owned()).zip(values).collect())
    }

    fn density(&self, fitted: &[f64], bin: &ModeBin) -> f64 {
        self.densities(fitted, &[*bin])[0]
    }

    fn densities(&self, fitted: &[f64], bins: &[ModeBin]) -> Vec<f64> {
        densities(&process(fitted), bins)
    }

    fn starts(&self, context: &SpectralContext<'_>) -> Vec<Vec<f64>> {
        let Bounds { low, high } = self.bounds(context)[0];
        starts_between(2.0 * low, high, context)
    }

    fn bounds(&self, context: &SpectralContext<'_>) -> Vec<Bounds> {
        let dt = context.bins.first().map_or(1.0, |b| b.dt_s);
        vec![Bounds::new(0.25 * dt, SHORT_SAMPLES * dt), Bounds::new(1e-9, 1e9)]
    }

    fn trials(&self, _look: &SpectralContext<'_>) -> f64 {
        2.0
    }

    fn parameters(&self, fitted: &[f64]) -> Vec<f64> {
        fitted.to_vec()
    }

    fn stated(&self, values: &Values) -> Option<Vec<f64>> {
        Some(vec![number(values, PARAMS[0].name)?, number(values, PARAMS[1].name)?])
    }

    fn compose(&self, fitted: &[f64], _dt_s: f64, noise: &mut Composite) {
        noise.markov.push(process(fitted));
    }

    fn sizing(&self, context: &SpectralContext<'_>) -> Option<SpectralSizing> {
        let Bounds { low, high } = self.bounds(context)[0];
        let places = log_grid(2.0 * low, 0.9 * high, 4).into_iter().map(|time| vec![time, 1.0]).collect();
        Some(SpectralSizing { parameter: &PARAMS[1], position: 1, falls: false, places })
    }

    fn places(&self, fitted: &[f64], context: &SpectralContext<'_>) -> Vec<Place> {
        let time = process(fitted).decay_time_s;
        let dt = context.bins.first().map_or(1.0, |b| b.dt_s);
        let corner = 1.0 / (2.0 * std::f64::consts::PI * time);
        let nyquist = 0.5 / dt;
        vec![
            Place { domain: Domain::Lag, from: dt, to: (3.0 * time).max(2.0 * dt) },
            Place {
                domain: Domain::Frequency,
                from: (0.1 * corner).min(0.5 * nyquist),
                to: (3.0 * corner).min(nyquist),
            },
        ]
    }
}
