//! Realisations of the noise terms, each as means over the sampling interval, and the variances of their modes.

use super::draw::Draw;
use super::modes::{gaussian, sinc};
use std::f64::consts::PI;

/// Seconds in an hour.
pub const HOUR_S: f64 = 3600.0;

/// White rate noise of density 3600 N², deg/h.
pub fn white(draw: &mut Draw, n: usize, rate_hz: f64, arw: f64) -> Vec<f64> {
    let sigma = 60.0 * arw * rate_hz.sqrt();
    (0..n).map(|_| sigma * draw.normal()).collect()
}

/// Flicker of density B²/(2πf), deg/h.
pub fn flicker(draw: &mut Draw, n: usize, rate_hz: f64, b: f64) -> Vec<f64> {
    if b == 0.0 {
        return vec![0.0; n];
    }
    gaussian(draw, n, rate_hz, |f| b * b / (2.0 * PI * f))
}

/// Means over the sampling interval of a walk that begins at zero, deg/h.
pub fn random_walk(draw: &mut Draw, n: usize, rate_hz: f64, k: f64) -> Vec<f64> {
    let step = k / (rate_hz * HOUR_S).sqrt();
    let mut at = 0.0;
    (0..n)
        .map(|_| {
            let next = at + step * draw.normal();
            let mean = 0.5 * (at + next) + step / 12f64.sqrt() * draw.normal();
            at = next;
            mean
        })
        .collect()
}

/// Means over the sampling interval of a stationary process with covariance σ² e^(−|t|/T).
pub fn markov(draw: &mut Draw, n: usize, rate_hz: f64, sigma: f64, time_s: f64) -> Vec<f64> {
    let a = 1.0 / (rate_hz * time_s);
    let rho = (-a).exp();
    let within =
        if a < 1e-3 { a.powi(3) * (2.0 / 3.0 - a / 2.0) } else { 2.0 * a - 3.0 + 4.0 * rho - rho * rho }
            / (a * a);
    let end = 1.0 - rho * rho;
    let both = (1.0 - rho).powi(2) / a;
    let rest = (within - both * both / end).max(0.0).sqrt();
    let mut at = draw.normal();
    (0..n)
        .map(|_| {
            let e = draw.normal();
            let mean = at * (1.0 - rho) / a + both / end.sqrt() * e + rest * draw.normal();
            at = rho * at + end.sqrt() * e;
            sigma * mean
        })
        .collect()
}

/// Variance of a cosine mode at `f` of that process: its spectrum, aliases included.
pub fn markov_variance(f: f64, rate_hz: f64, sigma: f64, time_s: f64) -> f64 {
    let a = 1.0 / (rate_hz * time_s);
    let rho = (-a).exp();
    let zero = if a < 1e-3 { 1.0 - a / 3.0 } else { 2.0 * (a - 1.0 + rho) / (a * a) };
    let factor = (1.0 - rho).powi(2) / (a * a * rho);
    let c = (2.0 * PI * f / rate_hz).cos();
    let sum = (rho * c - rho * rho) / (1.0 - 2.0 * rho * c + rho * rho);
    sigma * sigma * (zero + 2.0 * factor * sum)
}

/// Parts a sampling interval is cut into for a resonance.
const PARTS: usize = 8;

/// Means over the sampling interval of a narrow-band process with covariance σ² e^(−|t|/T) cos 2πft.
pub fn resonance(draw: &mut Draw, n: usize, rate_hz: f64, sigma: f64, f_hz: f64, time_s: f64) -> Vec<f64> {
    let h = 1.0 / (rate_hz * PARTS as f64);
    let rho = (-h / time_s).exp();
    let kick = (1.0 - rho * rho).sqrt();
    let (mut re, mut im) = (draw.normal(), draw.normal());
    let turn = 2.0 * PI * f_hz * h;
    (0..n)
        .map(|i| {
            let mut sum = 0.0;
            for part in 0..PARTS {
                re = rho * re + kick * draw.normal();
                im = rho * im + kick * draw.normal();
                let phase = turn * (i * PARTS + part) as f64;
                sum += re * phase.cos() + im * phase.sin();
            }
            sigma * sum / PARTS as f64
        })
        .collect()
}

/// Variance of a cosine mode at `f` of that process.
pub fn resonance_variance(f: f64, rate_hz: f64, sigma: f64, f_hz: f64, time_s: f64) -> f64 {
    let bell = |x: f64| time_s / (1.0 + (2.0 * PI * x * time_s).powi(2));
    sigma * sigma * (bell(f - f_hz) + bell(f + f_hz)) * sinc(f / rate_hz).powi(2) * rate_hz
}

/// The angle is rounded to multiples of `lsb_arcsec`; the rates are its differences. 1 arcsec/s is 1 deg/h.
pub fn quantised(rate: &[f64], rate_hz: f64, lsb_arcsec: f64, start: f64) -> Vec<f64> {
    let mut angle = start * lsb_arcsec;
    let mut before = (angle / lsb_arcsec).round();
    rate.iter()
        .map(|y| {
            angle += y / rate_hz;
            let now = (angle / lsb_arcsec).round();
            let out = (now - before) * lsb_arcsec * rate_hz;
            before = now;
            out
        })
        .collect()
}

/// Variance that rounding of the angle adds to a cosine mode at `f`.
pub fn quantisation_variance(f: f64, rate_hz: f64, lsb_arcsec: f64) -> f64 {
    lsb_arcsec.powi(2) / 12.0 * 4.0 * (PI * f / rate_hz).sin().powi(2) * rate_hz * rate_hz
}
