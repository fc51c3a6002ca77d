//! The strongest spectral line.
//!
//! Where block means follow it, it is a sinusoid fitted to the whole record, with the Cramér-Rao variances of one in
//! noise of the level about it. Elsewhere it comes from the averaged periodogram. Its power stands over white noise of the
//! level of the local floor. To first order its variance over overlapping
//! Hann segments is that of an efficient estimate, with the square of the noise added for weak lines. Its frequency has
//! the Cramér-Rao variance of a sinusoid in white noise for each segment, over the number of averages, with a factor
//! for the interpolation between bins. Validated by simulation from 5 to 1000 times the floor.

use super::descriptor::Measurand;
use super::evidence::GyroEvidence;
use crate::estimate::{Estimate, Spread};
use crate::message::Note;
use crate::noise::lines::{Sinusoid, SpectralLine};
use std::f64::consts::PI;

/// Frequency of the strongest line.
pub static LINE_FREQUENCY: Measurand =
    Measurand::at_rest("line_frequency", "Hz", "frequency of the strongest spectral line", |m, gyro, _| {
        vec![strongest(m, gyro, |line, averages| match fitted(line) {
            Some(sinusoid) => (line.frequency_hz, sinusoid.frequency_deviation_hz, "sinusoid"),
            None => (line.frequency_hz, frequency_uncertainty_hz(line, averages), "welch"),
        })]
    });

/// Amplitude of the strongest line.
pub static LINE_AMPLITUDE: Measurand = Measurand::at_rest(
    "line_amplitude",
    "deg/h",
    "amplitude of the strongest spectral line",
    |m, gyro, _| {
        vec![strongest(m, gyro, |line, averages| match fitted(line) {
            Some(sinusoid) => (line.amplitude_deg_h, sinusoid.amplitude_deviation_deg_h, "sinusoid"),
            None => (line.amplitude_deg_h, amplitude_uncertainty(line, averages), "welch"),
        })]
    },
);

/// Variance of the interpolated frequency over that of an efficient estimate: for a strong line, and what is added for
/// one unit of peak over floor.
const INTERPOLATION_LOSS: (f64, f64) = (1.1, 7.0);
/// Noise power squared in the five bins of a Hann lobe, with their correlations, in units of one bin.
const LOBE_NOISE: f64 = 9.0;

/// The sinusoid that stands for a line, where it has no skirt.
fn fitted(line: &SpectralLine) -> Option<Sinusoid> {
    line.sinusoid.filter(|s| s.skirt_deg_h == 0.0)
}

/// What `of` gives of the strongest line for the number of averages: a value, its standard uncertainty and the method.
fn strongest(
    m: &Measurand,
    gyro: &GyroEvidence,
    of: fn(&SpectralLine, f64) -> (f64, f64, &'static str),
) -> Estimate {
    let strongest = gyro.lines.iter().max_by(|a, b| a.amplitude_deg_h.total_cmp(&b.amplitude_deg_h));
    let Some(line) = strongest else {
        let why = gyro.withheld_line.clone().unwrap_or(Note::new("note.no_line"));
        return m.not_identifiable(&gyro.channel, None, "welch").note(why);
    };
    let (value, standard_uncertainty, method) = of(line, gyro.spectrum().effective_averages);
    m.measured(&gyro.channel, value, Spread::Normal { standard_uncertainty }, method)
        .note(Note::new("note.line").with("resolution_hz", line.resolution_hz))
}

fn amplitude_uncertainty(line: &SpectralLine, averages: f64) -> f64 {
    let e = (line.excess - 1.0).max(1e-6);
    // The whole lobe holds 1.5 times the power of the peak when the line lies on a bin, more when it lies between two.
    let bins = line.frequency_hz / line.resolution_hz;
    let offset = (bins - bins.round()).abs().min(0.5);
    let sinc = if offset > 1e-9 { (PI * offset).sin() / (PI * offset) } else { 1.0 };
    let lobe = 1.5 * e / (sinc / (1.0 - offset * offset)).powi(2);
    0.5 * line.amplitude_deg_h * ((4.0 * lobe + LOBE_NOISE) / averages).sqrt() / lobe
}

fn frequency_uncertainty_hz(line: &SpectralLine, averages: f64) -> f64 {
    // The peak of a Hann periodogram of L samples stands at A²L/(6S) over a two-sided floor S (per sample), and the
    // signal-to-noise ratio of a sample is A²/(2S); var f = 12/((2π)² snr L³) in cycles a sample.
    let e = (line.excess - 1.0).max(1e-6);
    let loss = INTERPOLATION_LOSS.0 + INTERPOLATION_LOSS.1 / e;
    line.resolution_hz * (loss * 12.0 / ((2.0 * PI).powi(2) * 3.0 * e * averages)).sqrt()
}
