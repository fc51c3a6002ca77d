//! Cosine modes of a record, and Gaussian series of a given spectrum.

use super::draw::Draw;
use sagnac_fft::{Complex, real_forward, real_inverse};
use std::f64::consts::PI;

/// Orthonormal DCT-II: the modes 0 … n − 1 of `x`.
pub fn cosine_modes(x: &[f64]) -> Vec<f64> {
    let n = x.len();
    let mut folded: Vec<f64> = x.iter().step_by(2).copied().collect();
    folded.extend(x.iter().skip(1).step_by(2).rev());
    let plan = real_forward(n);
    let mut spectrum = plan.make_output_vec();
    plan.process(&mut folded, &mut spectrum).expect("lengths agree");
    let scale = (2.0 / n as f64).sqrt();
    (0..n)
        .map(|k| {
            let v = if k <= n / 2 { spectrum[k] } else { spectrum[n - k].conj() };
            let turn = Complex::from_polar(1.0, -PI * k as f64 / (2.0 * n as f64));
            let value = scale * (turn * v).re;
            if k == 0 { value / 2f64.sqrt() } else { value }
        })
        .collect()
}

/// Frequency of cosine mode `k` of `n` samples, Hz.
pub fn mode_frequency(k: usize, n: usize, rate_hz: f64) -> f64 {
    k as f64 * rate_hz / (2.0 * n as f64)
}

/// A Gaussian series of `n` samples with the two-sided density `density(f)`, unit² / Hz: a stretch cut out of a periodic
/// series at least four times as long, its mean over the long period zero.
pub fn gaussian(draw: &mut Draw, n: usize, rate_hz: f64, density: impl Fn(f64) -> f64) -> Vec<f64> {
    let length = (4 * n).next_power_of_two();
    let plan = real_inverse(length);
    let mut spectrum = plan.make_input_vec();
    let half = length / 2;
    for (k, value) in spectrum.iter_mut().enumerate().skip(1) {
        let f = k as f64 * rate_hz / length as f64;
        let size = (density(f).max(0.0) * rate_hz * length as f64).sqrt();
        *value = if k == half {
            Complex::new(size * draw.normal(), 0.0)
        } else {
            Complex::new(size * draw.normal(), size * draw.normal()) / 2f64.sqrt()
        };
    }
    let mut series = plan.make_output_vec();
    plan.process(&mut spectrum, &mut series).expect("lengths agree");
    let from = draw.below(length - n);
    series[from..from + n].iter().map(|x| x / length as f64).collect()
}

/// sin(πx)/(πx).
pub fn sinc(x: f64) -> f64 {
    if x.abs() < 1e-8 { 1.0 } else { (PI * x).sin() / (PI * x) }
}
