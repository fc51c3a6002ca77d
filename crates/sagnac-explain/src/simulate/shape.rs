//! Flicker and rate random walk with the density that a claim states, up to the Nyquist frequency.
//!
//! Means over the sampling interval have less of them at the highest frequencies, flicker by up to a sixth. A claim
//! states what the samples show: B²/(2πf) and K²/(3600 (2πf)²) as they stand. A short symmetrical filter makes the one
//! of the other.

use crate::noise::data::NoiseType;
use crate::noise::model::{NoiseModel, claimed_unit_density, unit_density};
use std::f64::consts::PI;

/// Taps on each side. What is cut off changes the density by 1.3 % at the Nyquist frequency itself and by less
/// than 0.2 % below nine tenths of it.
pub(super) const SIDE: usize = 32;

/// Frequencies at which the filter is laid out, 0 to Nyquist.
const POINTS: usize = 2048;

/// Two-sided density that a claim states at a frequency, (deg/h)²/Hz: 3600 N² + B²/(2πf) + K²/(3600 (2πf)²).
pub fn claimed_density(noise: &NoiseModel, frequency_hz: f64) -> f64 {
    let of = |term| noise.coefficient(term).powi(2) * claimed_unit_density(term, frequency_hz).unwrap_or(0.0);
    of(NoiseType::AngleRandomWalk) + of(NoiseType::Flicker) + of(NoiseType::RateRandomWalk)
}

/// Density of a claim over that of means over the sampling interval, at a frequency in cycles a sample.
fn ratio(term: NoiseType, x: f64) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    let claimed = claimed_density(&NoiseModel::default().with(term, 1.0), x);
    claimed / unit_density(term, x, 1.0)
}

/// The filter of a term.
pub(super) fn taps(term: NoiseType) -> [f64; SIDE + 1] {
    taps_of(|x| ratio(term, x))
}

/// One half of a filter and its middle: h₀, h₁, ..., with h₋ₖ = hₖ. `power` is what it lets through at a frequency in
/// cycles a sample.
pub(super) fn taps_of(power: impl Fn(f64) -> f64) -> [f64; SIDE + 1] {
    let gains: Vec<f64> = (0..POINTS).map(|p| power(0.5 * (p as f64 + 0.5) / POINTS as f64).sqrt()).collect();
    let mut taps = [0.0; SIDE + 1];
    for (k, tap) in taps.iter_mut().enumerate() {
        let sum: f64 = gains
            .iter()
            .enumerate()
            .map(|(p, g)| g * (PI * k as f64 * (p as f64 + 0.5) / POINTS as f64).cos())
            .sum();
        *tap = sum / POINTS as f64;
    }
    // A constant passes unchanged, or a random walk would be scaled.
    let all = taps[0] + 2.0 * taps[1..].iter().sum::<f64>();
    taps[0] += 1.0 - all;
    taps
}

/// Samples that are filtered side by side.
const LANES: usize = 8;

/// A series through the filter: `values` has [`SIDE`] more at each end than comes out.
pub(super) fn filtered(values: &[f64], taps: &[f64; SIDE + 1], out: &mut [f64]) {
    let (many, left) = out.as_chunks_mut::<LANES>();
    let mut at = 0;
    for y in many {
        add_filtered(values.get(at..).unwrap_or_default(), taps, y);
        at += LANES;
    }
    for (i, y) in left.iter_mut().enumerate() {
        add_filtered(values.get(at + i..).unwrap_or_default(), taps, std::array::from_mut(y));
    }
}

/// Adds the next `N` samples; the sums of each are taken in the order of the taps, whatever `N` is.
fn add_filtered<const N: usize>(values: &[f64], taps: &[f64; SIDE + 1], out: &mut [f64; N]) {
    let from = |place: usize| values.get(place..).and_then(|v| v.first_chunk::<N>()).copied();
    // As a sum of nothing begins.
    let mut pairs = [-0.0; N];
    for (k, tap) in taps.iter().enumerate().skip(1) {
        let (Some(before), Some(after)) = (from(SIDE - k), from(SIDE + k)) else { return };
        for (sum, (a, b)) in pairs.iter_mut().zip(before.iter().zip(&after)) {
            *sum += tap * (a + b);
        }
    }
    let Some(here) = from(SIDE) else { return };
    for (y, (value, pairs)) in out.iter_mut().zip(here.iter().zip(&pairs)) {
        *y += taps[0] * value + pairs;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_side_by_side_are_filtered_as_one_by_one() {
        let taps = taps(NoiseType::Flicker);
        let values: Vec<f64> = (0..200).map(|i| f64::from(i * i % 97) - 40.0).collect();
        let mut out = vec![0.5; 200 - 2 * SIDE];
        filtered(&values, &taps, &mut out);
        for (i, y) in out.iter().enumerate() {
            let at = i + SIDE;
            let pairs: f64 = (1..=SIDE).map(|k| taps[k] * (values[at - k] + values[at + k])).sum();
            assert_eq!(*y, 0.5 + (taps[0] * values[at] + pairs), "{i}");
        }
    }

    #[test]
    fn the_filter_gives_the_claimed_density() {
        for term in [NoiseType::Flicker, NoiseType::RateRandomWalk] {
            let taps = taps(term);
            for p in 0..=1000 {
                let x = 0.5 * p as f64 / 1000.0;
                let gain = taps[0]
                    + 2.0 * (1..=SIDE).map(|k| taps[k] * (2.0 * PI * k as f64 * x).cos()).sum::<f64>();
                let error = gain * gain / ratio(term, x) - 1.0;
                let allowed = if x > 0.45 { 0.013 } else { 0.002 };
                assert!(error.abs() < allowed, "{term:?} at {x}: {error}");
            }
        }
    }
}
