//! The strongest spectral line.
//!
//! Where block means follow it, it is a sinusoid fitted to the whole record, with the Cramér-Rao variances of one in
//! noise of the level about it. Elsewhere it comes from the averaged periodogram. Its power stands over white noise of the
//! level of the local floor. To first order its variance over overlapping
//! Hann segments is that of an efficient estimate, with the square of the noise added for weak lines. Its frequency has
//! the Cramér-Rao variance of a sinusoid in white noise for each segment, over the number of averages, with a factor
//! for the interpolation between bins. Validated by simulation from 5 to 1000 times the floor.

use super::{GyroEvidence, Measurand, Options};
use crate::estimate::{Estimate, Spread};
use crate::message::Note;
use crate::noise::lines::SpectralLine as Line;
use std::f64::consts::PI;

pub(super) struct SpectralLine;

/// Variance of the interpolated frequency over that of an efficient estimate: for a strong line, and what is added for
/// one unit of peak over floor.
const INTERPOLATION_LOSS: (f64, f64) = (1.1, 7.0);
/// Noise power squared in the five bins of a Hann lobe, with their correlations, in units of one bin.
const LOBE_NOISE: f64 = 9.0;

impl Measurand for SpectralLine {
    fn ids(&self) -> &'static [&'static str] {
        &["line_frequency", "line_amplitude"]
    }

    fn evaluate(&self, id: &str, gyro: &GyroEvidence, _: &Options) -> Option<Estimate> {
        let frequency = id == "line_frequency";
        let (id, unit) = if frequency { ("line_frequency", "Hz") } else { ("line_amplitude", "deg/h") };
        let strongest = gyro.lines.iter().max_by(|a, b| a.amplitude_deg_h.total_cmp(&b.amplitude_deg_h));
        let Some(line) = strongest else {
            let none = Estimate::not_identifiable(id, &gyro.channel, None, unit, "welch");
            return Some(none.note(gyro.withheld_line.clone().unwrap_or(Note::new("note.no_line"))));
        };
        let averages = gyro.spectrum().effective_averages;
        let value = if frequency { line.frequency_hz } else { line.amplitude_deg_h };
        let (standard_uncertainty, method) = match (line.sinusoid.filter(|s| s.skirt_deg_h == 0.0), frequency)
        {
            (Some(fitted), true) => (fitted.frequency_deviation_hz, "sinusoid"),
            (Some(fitted), false) => (fitted.amplitude_deviation_deg_h, "sinusoid"),
            (None, true) => (frequency_uncertainty_hz(line, averages), "welch"),
            (None, false) => (amplitude_uncertainty(line, averages), "welch"),
        };
        let estimate = Estimate::measured(
            id,
            &gyro.channel,
            value,
            unit,
            Spread::Normal { standard_uncertainty },
            method,
        );
        Some(estimate.note(Note::new("note.line").with("resolution_hz", line.resolution_hz)))
    }
}

fn amplitude_uncertainty(line: &Line, averages: f64) -> f64 {
    let e = (line.excess - 1.0).max(1e-6);
    // The whole lobe holds 1.5 times the power of the peak when the line lies on a bin, more when it lies between two.
    let bins = line.frequency_hz / line.resolution_hz;
    let offset = (bins - bins.round()).abs().min(0.5);
    let sinc = if offset > 1e-9 { (PI * offset).sin() / (PI * offset) } else { 1.0 };
    let lobe = 1.5 * e / (sinc / (1.0 - offset * offset)).powi(2);
    0.5 * line.amplitude_deg_h * ((4.0 * lobe + LOBE_NOISE) / averages).sqrt() / lobe
}

fn frequency_uncertainty_hz(line: &Line, averages: f64) -> f64 {
    // The peak of a Hann periodogram of L samples stands at A²L/(6S) over a two-sided floor S (per sample), and the
    // signal-to-noise ratio of a sample is A²/(2S); var f = 12/((2π)² snr L³) in cycles a sample.
    let e = (line.excess - 1.0).max(1e-6);
    let loss = INTERPOLATION_LOSS.0 + INTERPOLATION_LOSS.1 / e;
    line.resolution_hz * (loss * 12.0 / ((2.0 * PI).powi(2) * 3.0 * e * averages)).sqrt()
}
