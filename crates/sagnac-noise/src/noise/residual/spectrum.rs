//! The spectrum of a whole description, as transforms of a record show it.

use super::super::composite::{Bandwidth, Composite, Damped, Described, Sampling};
use super::super::data::NoiseType;
use super::super::model::{Bin, Spectral, TERMS};

/// Modes for which the finite length of the record is counted in damped processes.
const EXACT_MODES: usize = 1024;
/// Smooth terms are computed at modes this far apart, relative, and interpolated between.
const GRID_RATIO: f64 = 1.005;
/// Modes that are computed one by one.
const SINGLE_MODES: usize = 200;

/// A composite as one term of coefficient 1.
pub(super) struct ModelSpectrum<'a> {
    pub model: &'a Composite,
    /// Sample interval, s: what a moving average is counted in.
    pub tau0_s: f64,
}

impl ModelSpectrum<'_> {
    fn smooth(&self, bin: &Bin) -> f64 {
        let model = self.model;
        let terms =
            TERMS.iter().filter(|t| model.terms.coefficient(**t) != 0.0 && **t != NoiseType::RateRamp);
        terms
            .map(|term| {
                let plain = term.density(bin);
                let shaped = match &model.bandwidth {
                    None if model.sampling == Sampling::Averaging => plain,
                    // A moving average is counted in samples, whatever the blocks.
                    Some(filter @ Bandwidth::MovingAverage { .. }) => {
                        let at =
                            |b: Option<&Bandwidth>| sampled(*term, bin.frequency_hz, self.tau0_s, b, model);
                        let bare = at(None);
                        if bare > 0.0 { plain * at(Some(filter)) / bare } else { plain }
                    }
                    filter => {
                        let at =
                            |b: Option<&Bandwidth>| sampled(*term, bin.frequency_hz, bin.tau_s, b, model);
                        let bare = sampled_averaging(*term, bin);
                        if bare > 0.0 { plain * at(filter.as_ref()) / bare } else { plain }
                    }
                };
                model.terms.coefficient(*term).powi(2) * shaped
            })
            .sum()
    }

    fn damped(&self) -> impl Iterator<Item = &Damped> {
        self.model.markov.iter().chain(&self.model.quasi_periodic)
    }

    /// E\[c_k²\] τ of every cosine mode from 1 on of `blocks` whole means over `tau_s`; the first is mode 1.
    pub fn modes(&self, blocks: usize, tau_s: f64) -> Vec<f64> {
        let step_hz = 0.5 / (blocks as f64 * tau_s);
        let bin = |k: usize| Bin {
            frequency_hz: k as f64 * step_hz,
            tau_s,
            filling: 1.0,
            mode: k,
            blocks,
            segment: 0,
        };
        let mut power = Vec::with_capacity(blocks.saturating_sub(1));
        let (mut from, mut value) = (0usize, 0.0);
        for k in 1..blocks {
            if k <= SINGLE_MODES || blocks < 4 * SINGLE_MODES {
                value = self.smooth(&bin(k));
                power.push(value);
                from = k;
                continue;
            }
            if power.len() >= k {
                continue;
            }
            let to = ((from as f64 * GRID_RATIO).ceil() as usize).clamp(from + 1, blocks - 1);
            let next = self.smooth(&bin(to));
            for j in from + 1..=to {
                let share = (j - from) as f64 / (to - from) as f64;
                power.push(value + share * (next - value));
            }
            (from, value) = (to, next);
        }
        for (i, p) in power.iter_mut().enumerate() {
            let b = bin(i + 1);
            *p += self.damped().map(|d| damped_power(d, &b, self.model.sampling)).sum::<f64>();
        }
        power
    }
}

fn damped_power(d: &Damped, bin: &Bin, sampling: Sampling) -> f64 {
    if bin.blocks > 0 && bin.mode <= EXACT_MODES {
        d.mode_power(bin.mode, bin.blocks, bin.tau_s, sampling)
    } else {
        d.density(bin.frequency_hz, bin.tau_s, sampling)
    }
}

fn sampled(term: NoiseType, f: f64, tau_s: f64, filter: Option<&Bandwidth>, model: &Composite) -> f64 {
    match filter {
        Some(filter) => filter.unit_density(term, f, tau_s, model.sampling),
        None => super::super::composite::sampled_density(term, f, tau_s, model.sampling),
    }
}

fn sampled_averaging(term: NoiseType, bin: &Bin) -> f64 {
    super::super::composite::sampled_density(term, bin.frequency_hz, bin.tau_s, Sampling::Averaging)
}

impl Spectral for ModelSpectrum<'_> {
    fn density(&self, bin: &Bin) -> f64 {
        self.smooth(bin) + self.damped().map(|d| damped_power(d, bin, self.model.sampling)).sum::<f64>()
    }
}

/// Relative change of `quantity` with each parameter of a description: ∂ ln q/∂p times a step that makes the
/// derivatives of different parameters comparable (the parameter itself).
pub(super) fn log_gradients(
    described: &Described,
    quantity: impl Fn(&Composite) -> Vec<f64>,
) -> Vec<Vec<f64>> {
    const RELATIVE_STEP: f64 = 1e-3;
    let positive = |v: &f64| *v > 0.0 && v.is_finite();
    described
        .parameters
        .iter()
        .map(|p| {
            let at = described.model.value(*p);
            let up = quantity(&described.model.with(*p, at * (1.0 + RELATIVE_STEP)));
            let down = quantity(&described.model.with(*p, at * (1.0 - RELATIVE_STEP)));
            let pairs = up.iter().zip(&down);
            pairs
                .map(
                    |(u, d)| {
                        if positive(u) && positive(d) { (u / d).ln() / (2.0 * RELATIVE_STEP) } else { 0.0 }
                    },
                )
                .collect()
        })
        .collect()
}
