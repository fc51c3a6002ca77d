//! The output is low-pass filtered.

use crate::effect::shared::search::log_grid;
use crate::effect::{
    Domain, LowPass, ModeBin, Param, Place, SpectralContext, SpectralSizing, Spectrum, SpectrumAct, Values,
    number,
};
use crate::noise::composite::{Bandwidth, Composite, Sampling, averaged_white_mode, filtered_white};
use crate::numeric::optimize::bisect;
use crate::numeric::range::Bounds;
use std::f64::consts::PI;

pub struct BandwidthFilter;

static PARAMS: [Param; 2] =
    [Param::reported("cutoff_hz", "Hz", 1e-9, 1e9), Param::inner("form", "", 1.0, 7.0)];

/// A filter of the output. Claimed by number: 1 first order before the samples are averaged, 2 first order on
/// the spectrum of the samples, 3 second order (Butterworth) on it, 4 moving average of whole samples, 5 exponential
/// smoothing of the samples, 6 first and 7 second order (Butterworth) by the bilinear transform.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    BeforeSampling,
    FirstOrder,
    SecondOrder,
    MovingAverage,
    Smoothing,
    BilinearFirst,
    BilinearSecond,
}

const FILTER_FORMS: [Form; 7] = [
    Form::BeforeSampling,
    Form::FirstOrder,
    Form::SecondOrder,
    Form::MovingAverage,
    Form::Smoothing,
    Form::BilinearFirst,
    Form::BilinearSecond,
];
/// Least factor of a power: a smaller one is rounding.
const MIN_POWER: f64 = 1e-9;
/// Observed over expected power, times the samples, below which bins hold the ends of the record and not what a filter does.
const MIN_OBSERVED_RATIO: f64 = 30.0;
/// Number of rounds in which the first cutoff of a fit is refined.
const CUTOFF_REFINEMENTS: i32 = 3;
/// Longest moving average that is tried, samples.
const MAX_AVERAGE_SAMPLES: usize = 64;

fn form(fitted: &[f64]) -> Form {
    let number = fitted.get(1).copied().unwrap_or(1.0).round().clamp(1.0, FILTER_FORMS.len() as f64);
    FILTER_FORMS[number as usize - 1]
}

/// The filter of samples, of the forms that act on them.
fn of_samples(fitted: &[f64], dt_s: f64) -> Option<LowPass> {
    let cutoff = fitted.first().copied().unwrap_or(1e9).max(1e-12) * dt_s;
    match form(fitted) {
        Form::BeforeSampling | Form::MovingAverage => None,
        Form::FirstOrder => Some(LowPass::ideal(cutoff, 1)),
        Form::SecondOrder => Some(LowPass::ideal(cutoff, 2)),
        Form::Smoothing => Some(LowPass::smoothing(cutoff)),
        Form::BilinearFirst => Some(LowPass::bilinear(cutoff)),
        Form::BilinearSecond => Some(LowPass::butterworth(cutoff)),
    }
}

/// Cutoff of a moving average of so many samples: where (sin nx/(n sin x))² is a half, Hz.
fn average_cutoff_hz(samples: usize, dt_s: f64) -> f64 {
    let n = samples as f64;
    let response = |x: f64| ((n * x).sin() / (n * x.sin())).powi(2);
    bisect(1e-9, PI / (n + 0.5), 60, |x| response(x) > 0.5).inside / (PI * dt_s)
}

/// The moving average whose cutoff is nearest.
fn average_samples(cutoff_hz: f64, dt_s: f64) -> usize {
    (2..=MAX_AVERAGE_SAMPLES)
        .min_by(|a, b| {
            let off = |n: usize| (average_cutoff_hz(n, dt_s) / cutoff_hz).ln().abs();
            off(*a).total_cmp(&off(*b))
        })
        .unwrap_or(2)
}

describe! {
    BandwidthFilter, "bandwidth_filter", Spectrum in Frequency, needs [],
    confusers [MarkovShort, ExcessArw, TimeOffset],
    properties [carried_over, family Spectrum]
}

/// Offsets in half widths of a bin, and weights, that average a density within it: about the zeros of a moving average it
/// is a parabola, which three points of Gauss do exactly.
const GAUSS_POINTS: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 18.0), (0.0, 8.0 / 18.0), (0.774_596_669_241_483_4, 5.0 / 18.0)];

/// Mean over the modes of a bin of a function of the order of a mode.
fn mean_within(bin: &ModeBin, of: impl Fn(f64) -> f64) -> f64 {
    let half = 0.5 * (bin.modes.max(1) - 1) as f64;
    let middle = bin.mode as f64 + half;
    if bin.modes < 3 { of(middle) } else { GAUSS_POINTS.iter().map(|(x, w)| w * of(middle + x * half)).sum() }
}

/// Power of white noise behind a moving average in a bin.
fn averaged(samples: usize, bin: &ModeBin) -> f64 {
    if !bin.even_ends {
        return mean_within(bin, |mode| averaged_white_mode(samples as u32, mode, bin.samples));
    }
    let n = samples as f64;
    mean_within(bin, |mode| {
        let x = 0.5 * PI * mode / bin.samples as f64;
        if x.sin().abs() < 1e-12 { 1.0 } else { ((n * x).sin() / (n * x.sin())).powi(2) }
    })
}

/// Time constant of a filter of first order, s.
fn time_constant_s(fitted: &[f64]) -> f64 {
    let cutoff = fitted.first().copied().unwrap_or(1e9).max(1e-12);
    1.0 / (2.0 * PI * cutoff)
}

impl Spectrum for BandwidthFilter {
    fn act(&self) -> SpectrumAct {
        SpectrumAct::Filters
    }

    /// Factors for white noise: slower noise lies where the filter passes everything.
    fn densities(&self, fitted: &[f64], bins: &[ModeBin]) -> Vec<f64> {
        let Some(first) = bins.first() else { return vec![] };
        let cutoff = fitted.first().copied().unwrap_or(1e9).max(1e-12);
        match of_samples(fitted, first.dt_s) {
            Some(low_pass) => {
                let frequencies = bins.iter().map(|b| b.frequency_hz * b.dt_s);
                if first.even_ends {
                    return frequencies.map(|x| low_pass.power(x).max(MIN_POWER)).collect();
                }
                let powers = low_pass.mode_powers(frequencies, first.samples);
                powers.into_iter().map(|p| p.max(MIN_POWER)).collect()
            }
            None if form(fitted) == Form::MovingAverage => {
                let samples = average_samples(cutoff, first.dt_s);
                bins.iter().map(|b| averaged(samples, b).max(MIN_POWER)).collect()
            }
            None => {
                let white =
                    filtered_white(time_constant_s(fitted)).densities(first.dt_s, Sampling::Averaging);
                bins.iter().map(|b| (white.at(b.frequency_hz) / 3600.0).max(MIN_POWER)).collect()
            }
        }
    }

    fn edge_effect(&self, fitted: &[f64], dt_s: f64) -> usize {
        // The covariance of noise that is even about an end differs from that of filtered noise where two distances
        // from the end add up to less than the memory.
        let memory = match of_samples(fitted, dt_s) {
            Some(low_pass) => low_pass.counted_memory(),
            None if form(fitted) == Form::MovingAverage => {
                average_samples(fitted.first().copied().unwrap_or(1e9).max(1e-12), dt_s)
            }
            None => 0,
        };
        memory.div_ceil(2)
    }

    fn zeros_hz(&self, fitted: &[f64], dt_s: f64) -> Vec<f64> {
        if form(fitted) != Form::MovingAverage {
            return vec![];
        }
        let samples = average_samples(fitted.first().copied().unwrap_or(1e9).max(1e-12), dt_s);
        (1..=samples / 2).map(|k| k as f64 / (samples as f64 * dt_s)).collect()
    }

    /// The form is chosen among the starts, and the cutoff of a whole number of samples with it.
    fn is_refined(&self, fitted: &[f64], parameter: usize) -> bool {
        parameter == 0 && form(fitted) != Form::MovingAverage
    }

    fn starts(&self, context: &SpectralContext<'_>) -> Vec<Vec<f64>> {
        let Some(first) = context.bins.first() else { return vec![] };
        let Bounds { low, high } = self.bounds(context)[0];
        let cost = |start: &[f64]| {
            // The level is left open: without the filter it was drawn down to what the filter leaves.
            let factors = self.densities(start, context.bins);
            let (mut logarithms, mut ratios, mut modes) = (0.0, 0.0, 0.0);
            for (i, (bin, factor)) in context.bins.iter().zip(factors).enumerate() {
                if context.observed[i] * (bin.samples as f64) < MIN_OBSERVED_RATIO * context.expected[i] {
                    continue;
                }
                let s = (context.expected[i] * factor).max(1e-300);
                let weight = bin.modes as f64;
                logarithms += weight * s.ln();
                ratios += weight * context.observed[i] / s;
                modes += weight;
            }
            logarithms + modes * (ratios / modes).ln()
        };
        let best = |candidates: Vec<Vec<f64>>| {
            candidates.into_iter().map(|c| (cost(&c), c)).min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, c)| c)
        };
        let grid = log_grid(2.0 * low, 0.7 * high, 16);
        // Filters of samples pass everything beyond the Nyquist frequency, whatever their cutoff.
        let within = |c: f64, number: f64| number < 4.0 || c < 0.45 / first.dt_s;
        let of = |number: f64| {
            let of = |cutoffs: Vec<f64>| {
                best(cutoffs.into_iter().filter(|c| within(*c, number)).map(|c| vec![c, number]).collect())
            };
            // Steep filters of a long record are fitted from nearby alone.
            (0..CUTOFF_REFINEMENTS).fold(of(grid.clone()), |found, round| {
                let step = 0.2 * 0.3f64.powi(round);
                let near = |c: f64| (-2..=2).map(|i| c * (f64::from(i) * step).exp()).collect();
                of(near(found?[0]))
            })
        };
        let averages =
            (2..=MAX_AVERAGE_SAMPLES).map(|n| vec![average_cutoff_hz(n, first.dt_s), 4.0]).collect();
        let forms = (1..=FILTER_FORMS.len()).filter(|n| FILTER_FORMS[n - 1] != Form::MovingAverage);
        forms.map(|n| of(n as f64)).chain([best(averages)]).flatten().collect()
    }

    fn bounds(&self, context: &SpectralContext<'_>) -> Vec<Bounds> {
        let (dt, n) = context.bins.first().map_or((1.0, 64), |b| (b.dt_s, b.samples));
        vec![
            Bounds::new((10.0 / (n as f64 * dt)).min(0.1 / dt), 3.0 / dt),
            Bounds::new(1.0, FILTER_FORMS.len() as f64),
        ]
    }

    fn trials(&self, context: &SpectralContext<'_>) -> f64 {
        let Bounds { low, high } = self.bounds(context)[0];
        (high / low).ln().max(1.0)
    }

    fn claimed_parameters(&self, values: &Values) -> Option<Vec<f64>> {
        let form = number(values, PARAMS[1].name).unwrap_or(1.0);
        number(values, PARAMS[0].name).filter(|c| *c > 0.0).map(|c| vec![c, form])
    }

    fn compose(&self, fitted: &[f64], dt_s: f64, noise: &mut Composite) {
        noise.bandwidth = match form(fitted) {
            Form::MovingAverage => {
                let cutoff = fitted.first().copied().unwrap_or(1.0);
                Some(Bandwidth::MovingAverage { samples: average_samples(cutoff, dt_s) as u32 })
            }
            Form::BeforeSampling => Some(Bandwidth::FirstOrder { time_constant_s: time_constant_s(fitted) }),
            _ => noise.bandwidth,
        };
    }

    fn low_pass(&self, fitted: &[f64], dt_s: f64) -> Option<LowPass> {
        of_samples(fitted, dt_s)
    }

    /// Of first order, before the samples are averaged.
    fn sizing(&self, context: &SpectralContext<'_>) -> Option<SpectralSizing> {
        let Bounds { high, .. } = self.bounds(context)[0];
        let places = vec![vec![high, 1.0]];
        Some(SpectralSizing { parameter: &PARAMS[0], position: 0, falls: true, places })
    }

    fn places(&self, fitted: &[f64], context: &SpectralContext<'_>) -> Vec<Place> {
        let (Some(cutoff), Some(bin)) = (fitted.first(), context.bins.first()) else { return vec![] };
        let nyquist = 0.5 / bin.dt_s;
        vec![Place { domain: Domain::Frequency, from: (0.5 * cutoff).min(0.5 * nyquist), to: nyquist }]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_of_two_samples_has_half_of_the_power_at_a_quarter_of_the_rate() {
        // cos²(πf dt) = ½.
        assert!((average_cutoff_hz(2, 0.1) - 2.5).abs() < 1e-9);
        for samples in [2, 5, 17] {
            assert_eq!(average_samples(average_cutoff_hz(samples, 0.02), 0.02), samples);
        }
        // sin²(πnx)/(n sin πx)² at the cutoff of 5 samples.
        let x = average_cutoff_hz(5, 1.0);
        let power = ((5.0 * PI * x).sin() / (5.0 * (PI * x).sin())).powi(2);
        assert!((power - 0.5).abs() < 1e-9, "{power}");
    }

    #[test]
    fn three_points_average_a_parabola_exactly() {
        let bin =
            ModeBin { frequency_hz: 0.0, mode: 10, modes: 21, samples: 100, dt_s: 1.0, even_ends: false };
        // Over 20 ± 10 as a continuum: 20² + 10²/3.
        assert!((mean_within(&bin, |k| k * k) - (400.0 + 100.0 / 3.0)).abs() < 1e-9);
        assert_eq!(mean_within(&ModeBin { modes: 1, ..bin }, |k| k), 10.0);
    }
}
