//! Exponentially correlated noise, with a correlation time of a few samples or of many.

use crate::effect::shared::markov::{SHORT_SAMPLES, densities, process, starts_between};
use crate::effect::shared::search::log_grid;
use crate::effect::{
    Domain, Effect, ModeBin, Param, Place, SpectralContext, SpectralSizing, Spectrum, Value, Values,
};
use crate::noise::composite::{Composite, Damped};
use crate::numeric::range::Bounds;
use std::f64::consts::PI;

pub struct MarkovShort;

pub struct MarkovLong;

static PARAMS: [Param; 2] = [
    Param::reported("correlation_time_s", "s", 1e-6, 1e7),
    Param::reported("sigma_deg_h", "deg/h", 0.0, 1e6),
];

describe! {
    MarkovShort, "markov_short", Spectrum in Lag, needs [],
    confusers [ExcessArw, BandwidthFilter, MarkovLong],
    properties [carried_over, family Spectrum]
}

describe! {
    MarkovLong, "markov_long", Spectrum in Lag, needs [],
    confusers [ExcessFlicker, ExcessRrw, RandomTelegraph],
    properties [carried_over, family Spectrum]
}

/// One of the two ranges of correlation times, which [`SHORT_SAMPLES`] divides.
trait Relaxation: Effect {
    /// True for the longer times, up to half of the record.
    const IS_LONG: bool;
}

impl Relaxation for MarkovShort {
    const IS_LONG: bool = false;
}

impl Relaxation for MarkovLong {
    const IS_LONG: bool = true;
}

/// Sample interval, s, and number of samples of the record that a spectrum is of.
fn grid(context: &SpectralContext<'_>) -> (f64, usize) {
    context.bins.first().map_or((1.0, 1), |b| (b.dt_s, b.samples))
}

impl<T: Relaxation> Spectrum for T {
    fn scales_with(&self, parameter: usize) -> Option<f64> {
        (parameter == 1).then_some(2.0)
    }

    fn is_relaxation(&self) -> bool {
        true
    }

    fn values_of(&self, process: &Damped, dt_s: f64) -> Option<Values> {
        let time = process.decay_time_s;
        let values = [time, process.rms_deg_h].map(Value::Number);
        let own = process.frequency_hz == 0.0 && (time >= SHORT_SAMPLES * dt_s) == T::IS_LONG;
        own.then(|| PARAMS.iter().map(|p| p.name.to_owned()).zip(values).collect())
    }

    fn densities(&self, fitted: &[f64], bins: &[ModeBin]) -> Vec<f64> {
        densities(&process(fitted), bins)
    }

    fn starts(&self, context: &SpectralContext<'_>) -> Vec<Vec<f64>> {
        let Bounds { low, high } = self.bounds(context)[0];
        let (low, high) = if T::IS_LONG { (low * 1.5, high / 1.5) } else { (2.0 * low, high) };
        starts_between(low, high, context)
    }

    fn bounds(&self, context: &SpectralContext<'_>) -> Vec<Bounds> {
        let (dt, n) = grid(context);
        let divide = SHORT_SAMPLES * dt;
        let times = match T::IS_LONG {
            true => Bounds::new(divide, 0.5 * n as f64 * dt),
            false => Bounds::new(0.25 * dt, divide),
        };
        vec![times, Bounds::new(1e-9, 1e9)]
    }

    fn trials(&self, context: &SpectralContext<'_>) -> f64 {
        let Bounds { low, high } = self.bounds(context)[0];
        if T::IS_LONG { (high / low).ln().max(1.0) } else { 2.0 }
    }

    fn compose(&self, fitted: &[f64], _dt_s: f64, noise: &mut Composite) {
        noise.markov.push(process(fitted));
    }

    /// Correlation times up to a quarter of the record.
    fn sizing(&self, context: &SpectralContext<'_>) -> Option<SpectralSizing> {
        let Bounds { low, high } = self.bounds(context)[0];
        let times =
            if T::IS_LONG { log_grid(1.5 * low, 0.5 * high, 5) } else { log_grid(2.0 * low, 0.9 * high, 4) };
        let places = times.into_iter().map(|time| vec![time, 1.0]).collect();
        Some(SpectralSizing { parameter: &PARAMS[1], position: 1, falls: false, places })
    }

    fn places(&self, fitted: &[f64], context: &SpectralContext<'_>) -> Vec<Place> {
        let time = process(fitted).decay_time_s;
        let (dt, n) = grid(context);
        let (length, nyquist) = (n as f64 * dt, 0.5 / dt);
        let (longest_lag, lowest, highest) = if T::IS_LONG {
            let highest = (3.0 / (2.0 * PI * time)).min(nyquist);
            ((3.0 * time).min(length), (0.5 / length).min(highest), highest)
        } else {
            let corner = 1.0 / (2.0 * PI * time);
            ((3.0 * time).max(2.0 * dt), (0.1 * corner).min(0.5 * nyquist), (3.0 * corner).min(nyquist))
        };
        vec![
            Place { domain: Domain::Lag, from: dt, to: longest_lag },
            Place { domain: Domain::Frequency, from: lowest, to: highest },
        ]
    }

    /// Only a slow process can be estimated sample by sample.
    fn has_course(&self) -> bool {
        T::IS_LONG
    }
}
