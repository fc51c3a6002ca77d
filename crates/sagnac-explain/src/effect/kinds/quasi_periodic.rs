//! A narrow-band disturbance of finite coherence.

use crate::effect::shared::search::{log_grid, peaks};
use crate::effect::{
    Domain, ModeBin, Param, Place, SpectralContext, SpectralSizing, Spectrum, Value, Values,
};
use crate::noise::composite::{Composite, Damped, Sampling};
use crate::numeric::order::SortByNumber;
use crate::numeric::range::Bounds;
use std::f64::consts::PI;

pub struct QuasiPeriodic;

static PARAMS: [Param; 3] = [
    Param::reported("frequency_hz", "Hz", 0.0, 1e6),
    Param::reported("amplitude_rms_deg_h", "deg/h", 0.0, 1e6),
    Param::reported("coherence_time_s", "s", 1e-6, 1e8),
];

describe! {
    QuasiPeriodic, "quasi_periodic", Spectrum in Frequency, needs [],
    confusers [Line, MarkovLong, TableHarmonic],
    properties [carried_over, family Spectrum, if_few_cycles UnobservedDriver]
}

fn process(fitted: &[f64]) -> Damped {
    match fitted {
        [frequency, rms, time] => {
            Damped { rms_deg_h: *rms, frequency_hz: *frequency, decay_time_s: time.max(1e-12) }
        }
        _ => Damped { rms_deg_h: 0.0, frequency_hz: 0.0, decay_time_s: 1.0 },
    }
}

/// Lower and upper edge of a bin, Hz.
fn edges(bin: &ModeBin) -> Bounds {
    let spacing = 0.5 / (bin.samples as f64 * bin.dt_s);
    let low = (bin.mode as f64 - 0.5) * spacing;
    Bounds::new(low, low + bin.modes as f64 * spacing)
}

impl Spectrum for QuasiPeriodic {
    fn scales_with(&self, parameter: usize) -> Option<f64> {
        (parameter == 1).then_some(2.0)
    }

    fn repeats(&self) -> bool {
        true
    }

    fn values_of(&self, process: &Damped, _dt_s: f64) -> Option<Values> {
        let values = [process.frequency_hz, process.rms_deg_h, process.decay_time_s].map(Value::Number);
        let own = process.frequency_hz > 0.0;
        own.then(|| PARAMS.iter().map(|p| p.name.to_owned()).zip(values).collect())
    }

    /// Exact in single modes. A wide bin has the mean over it, which a resonance inside it needs.
    fn densities(&self, fitted: &[f64], bins: &[ModeBin]) -> Vec<f64> {
        let Some(first) = bins.first() else { return vec![] };
        let process = process(fitted);
        let modes = process.modes(first.samples, first.dt_s, Sampling::Averaging);
        let exact = process.densities(first.dt_s, Sampling::Averaging);
        let half_width = 0.5 / (PI * process.decay_time_s);
        // One resonance on each side of zero; each falls off as 1/(1 + (Δf/h)²).
        let lorentz = |f: f64| 1.0 / (1.0 + (f / half_width).powi(2));
        let primitive = |f: f64| half_width * (f / half_width).atan();
        let one = |bin: &ModeBin| {
            if bin.modes == 1 {
                return modes.power(bin.mode);
            }
            let Bounds { low, high } = edges(bin);
            let (mut point, mut mean) = (0.0, 0.0);
            for center in [process.frequency_hz, -process.frequency_hz] {
                point += lorentz(bin.frequency_hz - center);
                mean += (primitive(high - center) - primitive(low - center)) / (high - low);
            }
            let exact = exact.at(bin.frequency_hz);
            if point > 0.0 { exact * mean / point } else { exact }
        };
        bins.iter().map(one).collect()
    }

    /// Coherent for one of its periods at least: anything shorter is correlated noise.
    fn plausible(&self, fitted: &[f64]) -> bool {
        matches!(fitted, [frequency, _, time] if frequency * time >= 1.0)
    }

    fn starts(&self, context: &SpectralContext<'_>) -> Vec<Vec<f64>> {
        let Some(first) = context.bins.first() else { return vec![] };
        let length = first.samples as f64 * first.dt_s;
        let bounds = self.bounds(context);
        let weight =
            |b: &ModeBin, i: usize| b.modes as f64 * (context.observed[i] / context.expected[i] - 1.0);
        let excess: Vec<f64> = context.bins.iter().enumerate().map(|(i, b)| weight(b, i)).collect();
        let mut found: Vec<(f64, Vec<f64>)> = vec![];
        for width in [1usize, 3, 7, 15] {
            let window = |i: usize| i.saturating_sub(width / 2)..(i + width / 2 + 1).min(context.bins.len());
            let sure: Vec<f64> = (0..context.bins.len())
                .map(|i| {
                    let modes: usize = context.bins[window(i)].iter().map(|b| b.modes).sum();
                    let inside = context.bins[i].frequency_hz >= bounds[0].low;
                    if inside {
                        excess[window(i)].iter().sum::<f64>() / (2.0 * modes as f64).sqrt()
                    } else {
                        0.0
                    }
                })
                .collect();
            for i in peaks(&sure, 2, 2 * width) {
                let bins = window(i);
                // Power of both sides in the window, two-sided density times twice its width.
                let power: f64 = bins
                    .clone()
                    .map(|j| {
                        (context.observed[j] - context.expected[j]) * context.bins[j].modes as f64 / length
                    })
                    .sum();
                let low = edges(&context.bins[bins.start]).low;
                let high = edges(&context.bins[bins.end - 1]).high;
                let center = context.bins[i].frequency_hz;
                let time = bounds[2].clamp(2.0 / (PI * (high - low)));
                found.push((sure[i], vec![center, power.max(1e-18).sqrt(), time]));
            }
        }
        found.sort_descending_by(|a| a.0);
        found.into_iter().take(4).map(|(_, start)| start).collect()
    }

    fn bounds(&self, context: &SpectralContext<'_>) -> Vec<Bounds> {
        let (dt, n) = context.bins.first().map_or((1.0, 16), |b| (b.dt_s, b.samples));
        let length = n as f64 * dt;
        vec![
            Bounds::new((3.0 / length).min(0.25 / dt), 0.5 / dt),
            Bounds::new(1e-9, 1e9),
            Bounds::new(3.0 * dt, 2.0 * length),
        ]
    }

    fn trials(&self, context: &SpectralContext<'_>) -> f64 {
        context.bins.first().map_or(1.0, |b| b.samples as f64)
    }

    fn compose(&self, fitted: &[f64], _dt_s: f64, noise: &mut Composite) {
        noise.quasi_periodic.push(process(fitted));
    }

    /// Coherent over three and thirty periods, within a third of the record.
    fn sizing(&self, context: &SpectralContext<'_>) -> Option<SpectralSizing> {
        let bounds = self.bounds(context);
        let longest = bounds[2].high / 6.0;
        let at = |f: f64| [3.0, 30.0].map(|periods: f64| vec![f, 1.0, (periods / f).min(longest)]);
        let frequencies = log_grid(3.0 * bounds[0].low, 0.8 * bounds[0].high, 4).into_iter();
        let places = frequencies.flat_map(at).filter(|place| self.plausible(place)).collect();
        Some(SpectralSizing { parameter: &PARAMS[1], position: 1, falls: false, places })
    }

    fn places(&self, fitted: &[f64], context: &SpectralContext<'_>) -> Vec<Place> {
        let process = process(fitted);
        let length = context.bins.first().map_or(1.0, |b| b.samples as f64 * b.dt_s);
        let half = (1.0 / (PI * process.decay_time_s)).max(0.5 / length);
        let f = process.frequency_hz;
        vec![Place { domain: Domain::Frequency, from: (f - half).max(0.0), to: f + half }]
    }

    fn has_course(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbouring_bins_share_an_edge() {
        let bin = |mode, modes| ModeBin {
            frequency_hz: 0.0,
            mode,
            modes,
            samples: 100,
            dt_s: 0.5,
            even_ends: false,
        };
        // Modes lie 0.01 Hz apart.
        let (low, high) = (edges(&bin(10, 4)), edges(&bin(14, 1)));
        assert!((low.low - 0.095).abs() < 1e-12 && (low.high - 0.135).abs() < 1e-12, "{low:?}");
        assert!((low.high - high.low).abs() < 1e-12);
    }

    #[test]
    fn an_identified_oscillation_is_stated_by_its_numbers() {
        let values = QuasiPeriodic.values_of(&process(&[2.0, 0.5, 30.0]), 0.1).unwrap();
        assert_eq!(QuasiPeriodic.claimed_parameters(&values), Some(vec![2.0, 0.5, 30.0]));
        assert!(QuasiPeriodic.values_of(&process(&[0.0, 0.5, 30.0]), 0.1).is_none());
    }
}
