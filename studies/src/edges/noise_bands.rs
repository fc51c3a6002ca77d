//! What is true of a unit at rest in bands of frequency, from the closed forms of its sampled noise.

use super::case::Truth;
use super::rest::{N, Part, Rest};
use std::f64::consts::{PI, TAU};

/// Measurands of the noise in bands.
const IDS: [&str; 3] = ["output_noise_rms", "rate_noise_density", "spectral_mask"];
/// Ends of the band and of the mask, as shares of the sample rate.
const BAND: (f64, f64) = (0.06, 0.45);
const MASK: (f64, f64) = (0.1, 0.45);
/// Samples about whose mean the rms is taken.
const BLOCK: f64 = 1024.0;
/// Points of an integral over a band.
const POINTS: usize = 400;

/// The table of the procedure where one of `ids` needs it; the mask is the density of the white noise alone.
pub fn table(dt_s: f64, ids: &[String]) -> String {
    if !ids.iter().any(|id| IDS.contains(&id.as_str())) {
        return String::new();
    }
    let corner = |share: f64| {
        format!(
            "[[noise_test.mask]]\nfrequency = \"{} Hz\"\ndensity = \"{} deg/h/sqrt(Hz)\"\n",
            share / dt_s,
            white_density()
        )
    };
    let (from, to) = (BAND.0 / dt_s, BAND.1 / dt_s);
    let band = format!("[[noise_test.band]]\nfrom = \"{from} Hz\"\nto = \"{to} Hz\"\n");
    band + &corner(MASK.0) + &corner(MASK.1)
}

/// One-sided density of the white noise of every unit, (deg/h)/√Hz.
fn white_density() -> f64 {
    2f64.sqrt() * 60.0 * N
}

/// Rms, density and ratio to the mask of a unit.
pub fn truths(unit: &Rest) -> Vec<Truth> {
    let rate = 1.0 / unit.dt_s;
    let density = |f: f64| {
        unit.parts.iter().map(|p| 2.0 * part_density(unit, p, f)).sum::<f64>() + white_density().powi(2)
    };
    let mean = |from: f64, to: f64| {
        let at = |i: usize| from + (to - from) * (i as f64 + 0.5) / POINTS as f64;
        (0..POINTS).map(|i| density(at(i))).sum::<f64>() / POINTS as f64
    };
    let of_band = mean(BAND.0 * rate, BAND.1 * rate).sqrt();
    let step = 2f64.powf(1.0 / 6.0);
    let (mut low, mut largest) = (MASK.0 * rate, 0f64);
    while low < MASK.1 * rate {
        let high = (low * step).min(MASK.1 * rate);
        largest = largest.max(mean(low, high).sqrt() / white_density());
        low = high * (1.0 + 1e-12);
    }
    let variance =
        3600.0 * N * N / unit.dt_s + unit.parts.iter().map(|p| part_variance(unit, p)).sum::<f64>();
    let samples = unit.samples as f64;
    vec![
        Truth::new(IDS[0], variance.sqrt()).oracle(1.96 * (variance / (2.0 * samples)).sqrt()),
        Truth::new(IDS[1], of_band).oracle(1.96 * of_band / (4.0 * samples * (BAND.1 - BAND.0)).sqrt()),
        Truth::new(IDS[2], largest),
    ]
}

/// Two-sided density of a part as it is sampled, (deg/h)²/Hz; lines have none.
fn part_density(unit: &Rest, part: &Part, hz: f64) -> f64 {
    let dt_s = unit.dt_s;
    let turn = TAU * hz * dt_s;
    let step = 4.0 * (0.5 * turn).sin().powi(2);
    match *part {
        Part::Flicker(b) => ladder(unit, b)
            .map(|(variance, keep)| {
                variance * dt_s * (1.0 - keep * keep) / (1.0 - 2.0 * keep * turn.cos() + keep * keep)
            })
            .sum(),
        Part::Walk(k) => k * k * dt_s / 3600.0 * dt_s / step,
        Part::Quantized(q) => q * q / dt_s * step,
        Part::Line { .. } | Part::Ramp(_) => 0.0,
        Part::Markov { .. } | Part::Periodic { .. } => f64::NAN,
    }
}

/// Expected variance of a part about the means of blocks.
fn part_variance(unit: &Rest, part: &Part) -> f64 {
    match *part {
        Part::Flicker(b) => ladder(unit, b)
            .map(|(variance, keep)| {
                let shared = (1..BLOCK as i32).map(|k| (BLOCK - f64::from(k)) * keep.powi(k)).sum::<f64>();
                variance * (1.0 - 2.0 * shared / (BLOCK * (BLOCK - 1.0)))
            })
            .sum(),
        Part::Walk(k) => k * k * unit.dt_s / 3600.0 * (BLOCK + 1.0) / 6.0,
        Part::Quantized(q) => 2.0 * q * q / (unit.dt_s * unit.dt_s),
        Part::Line { amplitude, .. } => 0.5 * amplitude * amplitude,
        Part::Ramp(_) => 0.0,
        Part::Markov { .. } | Part::Periodic { .. } => f64::NAN,
    }
}

/// The Markov processes that make flicker: the variance of each, and what a sample keeps of the one before.
fn ladder(unit: &Rest, b: f64) -> impl Iterator<Item = (f64, f64)> {
    let step = 2f64.ln() / 4.0;
    let variance = b * b * step / PI;
    let longest_s = unit.dt_s * unit.samples as f64;
    let dt_s = unit.dt_s;
    let times = std::iter::successors(Some(0.5 * dt_s), move |tau| Some(tau * step.exp()));
    times.take_while(move |tau| *tau < longest_s).map(move |tau| (variance, (-dt_s / tau).exp()))
}
