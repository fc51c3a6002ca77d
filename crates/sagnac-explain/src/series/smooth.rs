//! A column freed from the noise of its sensor as far as its spectrum tells the two apart.

use crate::numeric::cosine::{dct2, inverse_dct2};
use crate::recording::sensor;

/// Modes over which a power is averaged before it is judged.
const NEIGHBOURS: usize = 4;

/// Power over the floor from which it is no chance: white noise exceeds it in 4 of 100,000 modes.
const DISTINCT: f64 = 4.0;

/// A column without the white noise of its sensor, as far as the spectrum tells them apart.
///
/// Modes are judged by their power against the white floor of the sensor, which the upper half of them shows: each is kept by the
/// share of it that is above the floor. A slow sensor without a white floor is left as it is, and of one that reads in coarse
/// steps the course between them is taken.
pub fn smooth(values: &[f64]) -> Vec<f64> {
    if let Some(course) = sensor::between_steps(values) {
        return course;
    }
    let n = values.len();
    if n < 64 {
        return values.to_vec();
    }
    // Without the straight line between its ends, whose modes fall off slowly.
    let ends = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
    let m = (n / 100).max(8);
    let (first, last) = (ends(&values[..m]), ends(&values[n - m..]));
    let line = |i: usize| first + (last - first) * (i as f64 - 0.5 * (m - 1) as f64) / (n - m) as f64;
    let rest: Vec<f64> = values.iter().enumerate().map(|(i, v)| v - line(i)).collect();
    let mut modes = dct2(&rest);
    let mut upper: Vec<f64> = modes[n / 2..].iter().map(|c| c * c).collect();
    let middle = upper.len() / 2;
    // The median of χ² with one degree of freedom is 0.4549 of its mean.
    let floor = *upper.select_nth_unstable_by(middle, f64::total_cmp).1 / 0.4549;
    if floor.is_nan() || floor <= 0.0 {
        return values.to_vec();
    }
    let powers: Vec<f64> = modes.iter().map(|c| c * c).collect();
    for (k, mode) in modes.iter_mut().enumerate().skip(1) {
        let around = &powers[k.saturating_sub(NEIGHBOURS).max(1)..(k + NEIGHBOURS + 1).min(n)];
        let power = around.iter().sum::<f64>() / around.len() as f64;
        *mode *= if power < DISTINCT * floor { 0.0 } else { 1.0 - floor / power };
    }
    inverse_dct2(&modes).into_iter().enumerate().map(|(i, v)| v + line(i)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slow_sine_comes_out_of_white_noise() {
        let n = 4096;
        let mut state = 1u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let clean: Vec<f64> = (0..n).map(|i| 20.0 + (6.0 * i as f64 / n as f64).sin()).collect();
        let noisy: Vec<f64> = clean.iter().map(|v| v + 0.5 * uniform()).collect();
        let rms = |of: &[f64]| {
            let sum: f64 = of.iter().zip(&clean).map(|(a, b)| (a - b).powi(2)).sum();
            (sum / n as f64).sqrt()
        };
        // Uniform numbers of width 0.5 have a deviation of 0.144.
        assert!((rms(&noisy) - 0.144).abs() < 0.01 && rms(&smooth(&noisy)) < 0.03);
    }

    #[test]
    fn short_and_steady_columns_stay_as_they_are() {
        assert_eq!(smooth(&[1.0, 5.0, 2.0]), [1.0, 5.0, 2.0]);
        assert_eq!(smooth(&[3.0; 100]), [3.0; 100]);
    }
}
