//! A recording as cosine modes (DCT-II): nearly independent, each of the variance of the density at its frequency.

use sagnac_fft::{Complex, real_forward, real_inverse};
use std::f64::consts::PI;

/// Cosine modes of a series.
#[derive(Debug, Clone)]
pub struct Modes {
    /// Frequency of each mode from the first on, Hz; the mean is left out.
    pub frequency_hz: Vec<f64>,
    /// Value, orthonormal: white noise of variance 1 gives variance 1.
    pub value: Vec<f64>,
}

impl Modes {
    /// Modes of a uniformly sampled series.
    pub fn of(series: &[f64], rate_hz: f64) -> Modes {
        let value = cosine_transform(series);
        let n = series.len() as f64;
        let frequency_hz = (1..series.len()).map(|k| k as f64 * rate_hz / (2.0 * n)).collect();
        Modes { frequency_hz, value: value[1..].to_vec() }
    }
}

/// Orthonormal DCT-II, by a transform of the even samples followed by the odd ones backwards (J. Makhoul, IEEE Trans. ASSP
/// 28 (1980) 27).
fn cosine_transform(series: &[f64]) -> Vec<f64> {
    let n = series.len();
    let mut folded: Vec<f64> = series.iter().step_by(2).copied().collect();
    folded.extend(series.iter().skip(1).step_by(2).rev());
    let mut spectrum = vec![Complex::new(0.0, 0.0); n / 2 + 1];
    let plan = real_forward(n);
    // The lengths fit by construction, so the transform cannot fail; were it to, every mode would be zero.
    if plan.process(&mut folded, &mut spectrum).is_err() {
        return vec![0.0; n];
    }
    let mut modes = vec![0.0; n];
    for (k, z) in spectrum.iter().enumerate() {
        let (sin, cos) = (PI * k as f64 / (2.0 * n as f64)).sin_cos();
        let norm = if k == 0 { (1.0 / n as f64).sqrt() } else { (2.0 / n as f64).sqrt() };
        modes[k] = norm * (z.re * cos + z.im * sin);
        if k > 0 {
            modes[n - k] = norm * (z.re * sin - z.im * cos);
        }
    }
    modes
}

/// Inverse of the modes, the mean being zero.
pub fn series_of(value: &[f64]) -> Vec<f64> {
    let n = value.len() + 1;
    let mut spectrum: Vec<Complex<f64>> = (0..=n / 2)
        .map(|k| {
            let at = |i: usize| if i == 0 || i >= n { 0.0 } else { value[i - 1] };
            let (sin, cos) = (PI * k as f64 / (2.0 * n as f64)).sin_cos();
            let (a, b) = (at(k), if k == 0 { 0.0 } else { at(n - k) });
            Complex::new(a * cos + b * sin, a * sin - b * cos) / (2.0 / n as f64).sqrt()
        })
        .collect();
    spectrum[0].im = 0.0;
    if n.is_multiple_of(2) {
        spectrum[n / 2].im = 0.0;
    }
    let mut folded = vec![0.0; n];
    let plan = real_inverse(n);
    if plan.process(&mut spectrum, &mut folded).is_err() {
        return vec![0.0; n];
    }
    let mut series = vec![0.0; n];
    let even = n.div_ceil(2);
    for (i, x) in folded.iter().enumerate() {
        let at = if i < even { 2 * i } else { 2 * (n - 1 - i) + 1 };
        series[at] = x / n as f64;
    }
    series
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_transform_is_the_sum_that_defines_it_and_its_inverse_returns() {
        for n in [9usize, 12] {
            let x: Vec<f64> = (0..n).map(|i| ((i * i * 7 + 3) % 11) as f64 - 4.0).collect();
            let fast = cosine_transform(&x);
            for (k, value) in fast.iter().enumerate() {
                let norm = if k == 0 { (1.0 / n as f64).sqrt() } else { (2.0 / n as f64).sqrt() };
                let slow: f64 =
                    (0..n).map(|j| x[j] * (PI * k as f64 * (j as f64 + 0.5) / n as f64).cos()).sum();
                assert!((value - norm * slow).abs() < 1e-10, "{n} {k}: {value} {}", norm * slow);
            }
            let mean = x.iter().sum::<f64>() / n as f64;
            for (a, b) in series_of(&fast[1..]).iter().zip(&x) {
                assert!((a - (b - mean)).abs() < 1e-10, "{a} {b}");
            }
        }
    }
}
