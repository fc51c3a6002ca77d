//! Exponentially correlated noise whose correlation time is many samples.

use crate::effect::{
    Domain, Effect, ModeBin, Model, Param, Place, SpectralContext, Spectrum, SpectrumAct, Values, number,
};
use crate::noise::composite::{Composite, Damped, Sampling};
use crate::numeric::range::Bounds;

pub struct MarkovLong;

static PARAMS: [Param; 2] = [
    Param::reported("correlation_time_s", "s", 1e-6, 1e7),
    Param::reported("sigma_deg_h", "deg/h", 0.0, 1e6),
];

impl Effect for MarkovLong {
    fn kind(&self) -> &'static str {
        "markov_long"
    }
    fn params(&self) -> &'static [Param] {
        &PARAMS
    }
    fn domain(&self) -> Domain {
        Domain::Lag
    }
    fn confusers(&self) -> &'static [&'static str] {
        &["excess_flicker", "excess_rrw", "random_telegraph"]
    }
    fn model(&self) -> Model {
        Model::Spectrum(&MarkovLong)
    }
}

/// Correlation time, in samples, that divides short from long.
pub(super) const SHORT_SAMPLES: f64 = 10.0;

/// The process of fitted parameters (correlation time s, standard deviation deg/h).
pub(super) fn process(fitted: &[f64]) -> Damped {
    let (time, sigma) = (fitted.first().copied().unwrap_or(1.0), fitted.get(1).copied().unwrap_or(0.0));
    Damped { rms_deg_h: sigma, frequency_hz: 0.0, decay_time_s: time }
}

/// Densities of a Markov process or an oscillation: exact in single modes, which a record shorter than some correlation
/// times needs.
pub(super) fn densities(process: &Damped, bins: &[ModeBin]) -> Vec<f64> {
    let Some(first) = bins.first() else { return vec![] };
    let modes = process.modes(first.samples, first.dt_s, Sampling::Averaging);
    let far = process.densities(first.dt_s, Sampling::Averaging);
    // Far above 1/(record length) the modes hold what the density says.
    let exact = |b: &ModeBin| b.modes == 1 && b.mode < 64;
    bins.iter().map(|b| if exact(b) { modes.power(b.mode) } else { far(b.frequency_hz) }).collect()
}

/// Starts over correlation times from `low` to `high`, each with the level that the excess at its corner asks for.
pub(super) fn starts_between(low: f64, high: f64, context: &SpectralContext<'_>) -> Vec<Vec<f64>> {
    let mut out = vec![];
    let mut time = low;
    while time <= high {
        let corner = 1.0 / (2.0 * std::f64::consts::PI * time);
        let below = context
            .bins
            .iter()
            .enumerate()
            .filter(|(_, b)| b.frequency_hz > corner / 4.0 && b.frequency_hz < corner * 2.0);
        let (mut excess, mut count, mut level) = (0.0, 0.0, 0.0);
        for (i, b) in below {
            excess += b.modes as f64 * (context.observed[i] - context.expected[i]);
            level += b.modes as f64 * context.expected[i];
            count += b.modes as f64;
        }
        if count > 0.0 {
            let density = (excess / count).max(0.1 * level / count);
            // Of a plateau 2σ²T about a half is left around the corner.
            out.push(vec![time, (density / time).sqrt()]);
        }
        time *= 4.0;
    }
    out
}

impl Spectrum for MarkovLong {
    fn act(&self) -> SpectrumAct {
        SpectrumAct::Adds
    }

    fn scales_with(&self, parameter: usize) -> Option<f64> {
        (parameter == 1).then_some(2.0)
    }

    fn density(&self, fitted: &[f64], bin: &ModeBin) -> f64 {
        self.densities(fitted, &[*bin])[0]
    }

    fn densities(&self, fitted: &[f64], bins: &[ModeBin]) -> Vec<f64> {
        densities(&process(fitted), bins)
    }

    fn starts(&self, context: &SpectralContext<'_>) -> Vec<Vec<f64>> {
        let Bounds { low, high } = self.bounds(context)[0];
        starts_between(low * 1.5, high / 1.5, context)
    }

    fn bounds(&self, context: &SpectralContext<'_>) -> Vec<Bounds> {
        let (dt, n) = context.bins.first().map_or((1.0, 1), |b| (b.dt_s, b.samples));
        vec![Bounds::new(SHORT_SAMPLES * dt, 0.5 * n as f64 * dt), Bounds::new(1e-9, 1e9)]
    }

    fn trials(&self, context: &SpectralContext<'_>) -> f64 {
        let Bounds { low, high } = self.bounds(context)[0];
        (high / low).ln().max(1.0)
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

    fn places(&self, fitted: &[f64], context: &SpectralContext<'_>) -> Vec<Place> {
        let time = process(fitted).decay_time_s;
        let (dt, n) = context.bins.first().map_or((1.0, 1), |b| (b.dt_s, b.samples));
        let lowest = 0.5 / (n as f64 * dt);
        let highest = (3.0 / (2.0 * std::f64::consts::PI * time)).min(0.5 / dt);
        vec![
            Place { domain: Domain::Lag, from: dt, to: (3.0 * time).min(n as f64 * dt) },
            Place { domain: Domain::Frequency, from: lowest.min(highest), to: highest },
        ]
    }

    fn has_course(&self) -> bool {
        true
    }
}
