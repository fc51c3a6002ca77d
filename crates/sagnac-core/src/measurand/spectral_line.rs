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
use crate::message::note;
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
        let why = gyro.withheld_line.clone().unwrap_or(note!("note.no_line"));
        return m.not_identifiable(&gyro.channel, None, "welch").note(why);
    };
    let (value, standard_uncertainty, method) = of(line, gyro.spectrum().effective_averages);
    m.measured(&gyro.channel, value, Spread::Normal { standard_uncertainty }, method)
        .note(note!("note.line", resolution_hz = line.resolution_hz))
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

#[cfg(test)]
mod tests {
    use super::super::Options;
    use super::super::test_evidence::{gyro, normal, notes, number, shows, withholds, within};
    use super::*;

    fn line(bins: f64, amplitude_deg_h: f64, excess: f64) -> SpectralLine {
        SpectralLine {
            frequency_hz: 0.01 * bins,
            resolution_hz: 0.01,
            amplitude_deg_h,
            excess,
            false_alarm_probability: 1e-6,
            harmonic_of: None,
            harmonic_order: 1,
            sinusoid: None,
        }
    }

    fn with(lines: Vec<SpectralLine>) -> GyroEvidence {
        let mut gyro = gyro();
        gyro.lines = lines;
        gyro.digest.welch.spectrum.effective_averages = 40.0;
        gyro
    }

    fn row(m: &Measurand, gyro: &GyroEvidence) -> Estimate {
        m.evaluate_gyro(gyro, &Options { remove_earth_rate: false }).remove(0)
    }

    #[test]
    fn the_strongest_line_of_a_periodogram_has_its_amplitude_and_frequency() {
        // Peak over floor 26: 25 of the line. On a bin its lobe holds 1.5·25 = 37.5 bins of noise:
        // u(A) = ½·2·√((4·37.5 + 9)/40)/37.5.
        let gyro = with(vec![line(9.0, 1.0, 11.0), line(5.0, 2.0, 26.0), line(7.0, 1.5, 20.0)]);
        let amplitude = row(&LINE_AMPLITUDE, &gyro);
        shows(&amplitude, 2.0, "welch");
        within(normal(&amplitude), (159.0f64 / 40.0).sqrt() / 37.5, 1e-12);
        assert_eq!(number(&amplitude, "note.line", "resolution_hz"), 0.01);
        // u(f) = 0.01·√((1.1 + 7/25)·12/(4π²·3·25·40)).
        let frequency = row(&LINE_FREQUENCY, &gyro);
        shows(&frequency, 0.05, "welch");
        let square = 1.38 * 12.0 / (39.478_417_604_357_43 * 3000.0);
        within(normal(&frequency), 0.01 * f64::sqrt(square), 1e-9);
    }

    #[test]
    fn a_line_between_two_bins_has_a_wider_lobe() {
        // A quarter of a bin off: the Hann lobe is (sin(π/4)/(π/4))/(1 − 1/16) there; half a bin off: (2/π)/(1 − 1/4).
        for (bins, lobe) in [
            (5.25, 1.5 * 25.0 / (0.900_316_316_157_106_f64 / 0.9375).powi(2)),
            (4.75, 1.5 * 25.0 / (0.900_316_316_157_106_f64 / 0.9375).powi(2)),
            (5.5, 1.5 * 25.0 / (std::f64::consts::FRAC_2_PI / 0.75).powi(2)),
        ] {
            let found = row(&LINE_AMPLITUDE, &with(vec![line(bins, 2.0, 26.0)]));
            within(normal(&found), ((4.0 * lobe + 9.0) / 40.0).sqrt() / lobe, 1e-9);
        }
    }

    #[test]
    fn a_line_at_the_floor_has_a_finite_uncertainty() {
        let found = row(&LINE_AMPLITUDE, &with(vec![line(5.0, 2.0, 1.0)]));
        let lobe = 1.5e-6;
        within(normal(&found), f64::sqrt((4.0 * lobe + 9.0) / 40.0) / lobe, 1e-9);
    }

    #[test]
    fn a_sinusoid_without_a_skirt_stands_for_its_line() {
        let sinusoid = |skirt_deg_h| {
            Some(Sinusoid {
                frequency_hz: 0.05,
                coefficients_deg_h: [2.0, 0.0],
                amplitude_deviation_deg_h: 0.03,
                frequency_deviation_hz: 1e-5,
                skirt_deg_h,
            })
        };
        let gyro = with(vec![SpectralLine { sinusoid: sinusoid(0.0), ..line(5.0, 2.0, 26.0) }]);
        let (amplitude, frequency) = (row(&LINE_AMPLITUDE, &gyro), row(&LINE_FREQUENCY, &gyro));
        shows(&amplitude, 2.0, "sinusoid");
        shows(&frequency, 0.05, "sinusoid");
        assert_eq!((normal(&amplitude), normal(&frequency)), (0.03, 1e-5));
        let wide = with(vec![SpectralLine { sinusoid: sinusoid(0.1), ..line(5.0, 2.0, 26.0) }]);
        assert_eq!(
            (row(&LINE_AMPLITUDE, &wide).method, row(&LINE_FREQUENCY, &wide).method),
            ("welch", "welch")
        );
    }

    #[test]
    fn without_a_line_the_row_says_why() {
        let mut gyro = with(vec![]);
        let none = row(&LINE_FREQUENCY, &gyro);
        withholds(&none, None, "welch");
        assert_eq!(notes(&none), ["note.no_line"]);
        gyro.withheld_line = Some(note!("note.withheld"));
        assert_eq!(notes(&row(&LINE_AMPLITUDE, &gyro)), ["note.withheld"]);
    }
}
