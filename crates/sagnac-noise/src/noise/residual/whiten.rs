//! The record with everything that the model explains taken out: cosine modes of its block means over the root of
//! their expected power, transformed back.

use super::super::spectral_record::SpectralRecord;
use super::jump::{self, Jump};
use super::spectrum::ModelSpectrum;
use crate::noise::composite::Composite;
use crate::numeric::cosine::{dct2, inverse_dct2};

/// Fewest block means that are whitened.
const MIN_BLOCK_MEANS: usize = 256;
/// Means in which a jump in place of slow noise is looked for, at most.
const MAX_MEANS_OF_JUMP: usize = 4096;
/// Share of a block that its samples must fill.
const MIN_FILLED_SHARE: f64 = 0.5;

/// A whitened series: white noise of variance 1 when the model is right.
#[derive(Debug, Clone, PartialEq)]
pub struct Whitened {
    /// Averaging time of the means that were whitened, s.
    pub step_s: f64,
    /// The series.
    pub values: Vec<f64>,
    /// Modes that carry it: those at lines are left out.
    pub modes: usize,
    /// Share of the block means that it holds: its longest stretch without a gap.
    pub share: f64,
    /// The block means of the same stretch less their mean, deg/h.
    pub means: Vec<f64>,
    /// Begin of the stretch since the recording began, s.
    pub from_s: f64,
    /// Its largest jump beside the noise of the model.
    pub jump: Option<Jump>,
    /// The jump that explains the record better than slow terms of the model do.
    pub jump_instead: Option<JumpInstead>,
}

/// A single jump in place of slow terms of the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JumpInstead {
    /// The jump, under the model without these terms.
    pub jump: Jump,
    /// Averaging time of the means that it was looked for in, s.
    pub step_s: f64,
    /// Log-likelihood that it adds beyond what they add, nats; the search over all places is charged.
    pub advantage: f64,
}

/// Whitens the longest stretch of a record; `None` when that is too short or the model has no power.
pub fn whitened(record: &SpectralRecord<'_>, model: &Composite) -> Option<Whitened> {
    let blocks = record.without_lines(record.lines);
    let full = blocks.block_len.max(1) as f64;
    let means = blocks.about_first();
    let present: Vec<bool> = means
        .iter()
        .zip(&blocks.count)
        .map(|(m, c)| m.is_finite() && f64::from(*c) >= MIN_FILLED_SHARE * full)
        .collect();
    let range = longest(&present);
    if range.len() < MIN_BLOCK_MEANS {
        return None;
    }
    let total = present.iter().filter(|p| **p).count();
    let step_s = full * record.tau0_s;
    let (from, count) = (range.start, range.len());
    // The ramp is no noise: it is taken out of the means.
    let slope = model.terms.r * step_s / 3600.0;
    let series: Vec<f64> =
        means.get(range)?.iter().enumerate().map(|(i, m)| m - slope * (from + i) as f64).collect();
    let mean = series.iter().sum::<f64>() / count as f64;
    let series: Vec<f64> = series.iter().map(|v| v - mean).collect();
    let used = used_modes(record, count, step_s);
    let modes = Modes { values: dct2(&series), used: &used, step_s, tau0_s: record.tau0_s };
    let powers = modes.powers(model);
    let whitened: Vec<f64> =
        modes.values.iter().zip(&powers).map(|(c, p)| if *p > 0.0 { c / p.sqrt() } else { 0.0 }).collect();
    let carried = powers.iter().filter(|p| **p > 0.0).count();
    if carried < MIN_BLOCK_MEANS / 2 {
        return None;
    }
    let values = inverse_dct2(&whitened);
    let sound = values.iter().all(|v| v.is_finite());
    sound.then(|| Whitened {
        step_s,
        values,
        modes: carried,
        share: count as f64 / total.max(1) as f64,
        jump: jump::largest(&modes.values, &powers),
        jump_instead: jump_instead(record, model, &series, step_s),
        from_s: blocks.first_index as f64 * record.tau0_s + from as f64 * step_s,
        means: series,
    })
}

/// True for every cosine mode that no line hides.
fn used_modes(record: &SpectralRecord<'_>, count: usize, step_s: f64) -> Vec<bool> {
    let masks = record.masks();
    let step_hz = 0.5 / (count as f64 * step_s);
    (0..count)
        .map(|k| k > 0 && !masks.iter().any(|m| m.hides(k as f64 * step_hz, step_hz, step_s, false)))
        .collect()
}

/// Cosine modes of block means.
struct Modes<'a> {
    values: Vec<f64>,
    used: &'a [bool],
    step_s: f64,
    tau0_s: f64,
}

impl Modes<'_> {
    /// Expected powers under a model; 0 where a mode is not used.
    fn powers(&self, model: &Composite) -> Vec<f64> {
        let power = ModelSpectrum { model, tau0_s: self.tau0_s }.modes(self.values.len(), self.step_s);
        let of = |k: usize| {
            k.checked_sub(1).and_then(|i| power.get(i)).map_or(0.0, |p| (p / self.step_s).max(0.0))
        };
        self.used.iter().enumerate().map(|(k, used)| if *used { of(k) } else { 0.0 }).collect()
    }

    /// Log-likelihood of the modes for their expected powers, less a constant (Whittle).
    fn log_likelihood(&self, powers: &[f64]) -> f64 {
        let with_power = self.values.iter().zip(powers).filter(|(_, p)| **p > 0.0);
        with_power.map(|(c, p)| -0.5 * (p.ln() + c * c / p)).sum()
    }
}

/// The jump that takes the place of slow terms best; `None` where none is likelier than what it replaces. `series`: block means
/// of one stretch without the ramp of the model, deg/h. They are averaged further: a jump need not be placed to a sample.
fn jump_instead(
    record: &SpectralRecord<'_>,
    model: &Composite,
    series: &[f64],
    step_s: f64,
) -> Option<JumpInstead> {
    let terms = &model.terms;
    let slow = [terms.k > 0.0, terms.b > 0.0, terms.r != 0.0];
    if slow == [false; 3] {
        return None;
    }
    let merged = series.len().div_ceil(MAX_MEANS_OF_JUMP);
    let step_s = merged as f64 * step_s;
    let means: Vec<f64> =
        series.chunks_exact(merged).map(|c| c.iter().sum::<f64>() / merged as f64).collect();
    let with_ramp = || -> Vec<f64> {
        let slope = terms.r * step_s / 3600.0;
        means.iter().enumerate().map(|(i, m)| m + slope * i as f64).collect()
    };
    let used = used_modes(record, means.len(), step_s);
    let modes = |means: &[f64]| Modes { values: dct2(means), used: &used, step_s, tau0_s: record.tau0_s };
    let (flat, ramped) = (modes(&means), (terms.r != 0.0).then(|| modes(&with_ramp())));
    let whole = flat.log_likelihood(&flat.powers(model));
    // Every choice of terms that are there, by the bits of its number.
    let choices = (1..8usize).map(|bits| [0, 1, 2].map(|i| bits >> i & 1 == 1));
    let instead = |[walk, flicker, ramp]: [bool; 3]| {
        let mut rest = model.clone();
        rest.terms.k = if walk { 0.0 } else { terms.k };
        rest.terms.b = if flicker { 0.0 } else { terms.b };
        let kept = if ramp { ramped.as_ref()? } else { &flat };
        let powers = kept.powers(&rest);
        let jump = jump::largest(&kept.values, &powers)?;
        let advantage = kept.log_likelihood(&powers) - jump.ln_p - whole;
        (advantage > 0.0).then_some(JumpInstead { jump, step_s, advantage })
    };
    choices
        .filter(|replaced| replaced.iter().zip(slow).all(|(r, there)| !r || there))
        .filter_map(instead)
        .max_by(|a, b| a.advantage.total_cmp(&b.advantage))
}

fn longest(present: &[bool]) -> std::ops::Range<usize> {
    let (mut best, mut start) = (0..0, 0);
    for (i, p) in present.iter().chain(&[false]).enumerate() {
        if !p {
            if i - start > best.len() {
                best = start..i;
            }
            start = i + 1;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_stretch_is_found() {
        let p = |s: &str| s.chars().map(|c| c == '1').collect::<Vec<bool>>();
        assert_eq!(longest(&p("110111011")), 3..6);
        assert_eq!(longest(&p("0011")), 2..4);
        assert_eq!(longest(&p("000")), 0..0);
        assert_eq!(longest(&[]), 0..0);
    }
}
