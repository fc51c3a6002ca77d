//! The record with everything that the model explains taken out: cosine modes of its block means over the root of
//! their expected power, transformed back.

use super::super::spectral_record::SpectralRecord;
use super::jump::{self, Jump};
use super::spectrum::ModelSpectrum;
use crate::noise::composite::Composite;
use crate::numeric::cosine::{dct2, inverse_dct2};

/// Fewest block means that are whitened.
const MIN_BLOCK_MEANS: usize = 256;
/// Share of a block that its samples must fill.
const FILLED: f64 = 0.5;

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
}

/// Whitens the longest stretch of a record; `None` when that is too short or the model has no power.
pub fn whitened(record: &SpectralRecord<'_>, model: &Composite) -> Option<Whitened> {
    let blocks = record.without_lines(record.lines);
    let full = blocks.block_len.max(1) as f64;
    let means = blocks.about_first();
    let present: Vec<bool> = means
        .iter()
        .zip(&blocks.count)
        .map(|(m, c)| m.is_finite() && f64::from(*c) >= FILLED * full)
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
    let power = ModelSpectrum { model, tau0_s: record.tau0_s }.modes(count, step_s);
    let mut modes = dct2(&series);
    let plain = modes.clone();
    let masks = record.masks();
    let step_hz = 0.5 / (count as f64 * step_s);
    let mut used = 0;
    let mut powers = vec![0.0; count];
    for (k, c) in modes.iter_mut().enumerate() {
        let expected = k.checked_sub(1).and_then(|i| power.get(i)).map_or(0.0, |p| p / step_s);
        let left_out =
            expected <= 0.0 || masks.iter().any(|m| m.hides(k as f64 * step_hz, step_hz, step_s, false));
        if !left_out {
            powers[k] = expected;
        }
        *c = if left_out { 0.0 } else { *c / expected.sqrt() };
        used += usize::from(!left_out);
    }
    if used < MIN_BLOCK_MEANS / 2 {
        return None;
    }
    let values = inverse_dct2(&modes);
    let sound = values.iter().all(|v| v.is_finite());
    sound.then(|| Whitened {
        step_s,
        values,
        modes: used,
        share: count as f64 / total.max(1) as f64,
        means: series,
        from_s: blocks.first_index as f64 * record.tau0_s + from as f64 * step_s,
        jump: jump::largest(&plain, &powers),
    })
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
