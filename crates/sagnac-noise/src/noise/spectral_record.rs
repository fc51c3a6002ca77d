//! The spectral statistics of a record, and what is identified from them.
//!
//! A narrow peak is a line when it stays coherent over the record, a quasi-periodic disturbance when it does not. The
//! averaged periodogram, whose segments are short, cannot tell them apart; the modes of the whole record can.

use super::coarse;
use super::composite::{Damped, Described, Line, Parameter, Sampling};
use super::data::{BlockSeries, WelchSpectrum};
use super::digest::RateDigest;
use super::evidence::{Evidence, Mask};
use super::family::Estimator;
use super::identification::{
    Options, RangedIdentification, describe_in_range, identify_in_range, identify_over,
};
use super::lines::{SpectralLine, find_lines, is_coherent, retain};
use super::sinusoids;
use crate::numeric::order::SortByNumber;
use std::borrow::Cow;
use std::f64::consts::PI;

/// What one pass left of a channel, as identification needs it.
#[derive(Debug, Clone, Copy)]
pub struct SpectralRecord<'a> {
    /// Block means.
    pub blocks: &'a BlockSeries,
    /// Averaged periodogram, where blocks hold more than one sample.
    pub welch: Option<&'a WelchSpectrum>,
    /// Sample interval, s.
    pub tau0_s: f64,
    /// Lines found in the periodogram.
    pub lines: &'a [SpectralLine],
    /// How samples were taken.
    pub sampling: Sampling,
}

/// What a record says about its noise.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordNoise {
    /// The noise, with the range it rests on.
    pub ranged: RangedIdentification,
    /// The lines that stay coherent over the record.
    pub lines: Vec<SpectralLine>,
}

/// A disturbance that decays in more than this share of the record is a line as far as the record shows.
const COHERENT_DECAY_SHARE: f64 = 1.0 / 3.0;
/// Times that the lines are settled anew.
const REFINEMENT_ROUNDS: usize = 3;

impl<'a> SpectralRecord<'a> {
    /// The statistics that one pass left, and lines found in its periodogram. `tau0_s` is the measured sample interval.
    pub fn of_digest(digest: &'a RateDigest, lines: &'a [SpectralLine], tau0_s: f64) -> SpectralRecord<'a> {
        SpectralRecord {
            blocks: &digest.blocks,
            welch: Some(&digest.welch.spectrum),
            tau0_s,
            lines,
            sampling: Sampling::Averaging,
        }
    }
}

/// Finds the lines of a channel and identifies the noise beside them. `tau0_s` is the measured sample interval,
/// `line_false_alarm` the probability that noise alone shows a line, `step_deg_h` the step of a rounded output.
pub fn identify_digest(
    channel: &str,
    digest: &RateDigest,
    tau0_s: f64,
    line_false_alarm: f64,
    step_deg_h: Option<f64>,
) -> RecordNoise {
    let lines = find_lines(&digest.welch.spectrum, tau0_s, line_false_alarm).lines;
    let curve = digest.octaves.as_ref().unwrap_or(&digest.deviations).curve(Estimator::Allan);
    let points: Vec<(u64, f64)> =
        curve.map(|c| c.points.iter().map(|p| (p.m, p.deviation)).collect()).unwrap_or_default();
    let rounded_above_hz = step_deg_h.and_then(|step| coarse::highest_hz(step, tau0_s, &points));
    SpectralRecord::of_digest(digest, &lines, tau0_s).identify_up_to(channel, rounded_above_hz)
}

/// A first look: lines, and N, B, K, Q and R alone, over the widest range of frequencies in which they describe the record. No process
/// and no filter is searched for, which takes most of the time of [`identify_digest`]. The arguments are those of it.
pub fn identify_terms(channel: &str, digest: &RateDigest, tau0_s: f64, line_false_alarm: f64) -> RecordNoise {
    // A narrow peak counts as a line whether or not it stays coherent: only a process could take its place.
    let mut lines = find_lines(&digest.welch.spectrum, tau0_s, line_false_alarm).lines;
    sinusoids::fit(&digest.blocks, tau0_s, &mut lines);
    let evidence = SpectralRecord::of_digest(digest, &lines, tau0_s).evidence(&lines);
    let ranged = identify_in_range(channel, &evidence, 0.5 / tau0_s, &Options::standard_terms());
    let mut noise = RecordNoise { ranged, lines };
    describe_lines(&mut noise.ranged.identification.described, &noise.lines);
    noise
}

impl SpectralRecord<'_> {
    /// The frequencies of the lines. A line fills the main lobe of the window: two bins to each side.
    pub fn masks(&self) -> Vec<Mask> {
        masks_of(self.lines)
    }

    /// The evidence with lines left out.
    pub fn evidence(&self, lines: &[SpectralLine]) -> Evidence {
        Evidence::new(&self.without_lines(lines), self.welch, self.tau0_s, &masks_of(lines))
    }

    /// The block means with the sinusoids of lines taken out.
    pub fn without_lines(&self, lines: &[SpectralLine]) -> Cow<'_, BlockSeries> {
        if lines.iter().all(|l| l.sinusoid.is_none()) {
            return Cow::Borrowed(self.blocks);
        }
        Cow::Owned(sinusoids::without(self.blocks, self.tau0_s, lines))
    }

    /// Identifies the noise.
    pub fn identify(&self, channel: &str) -> RecordNoise {
        self.identify_up_to(channel, None)
    }

    /// Identifies the noise of an output that is rounded so coarsely that only frequencies up to `rounded_above_hz` tell
    /// of it.
    pub fn identify_up_to(&self, channel: &str, rounded_above_hz: Option<f64>) -> RecordNoise {
        let options = Options { sampling: self.sampling, ..Options::default() };
        let whole = self.evidence(&[]);
        let nyquist_hz = rounded_above_hz.unwrap_or(0.5 / self.tau0_s);
        let seen = retain(self.lines, |l| l.frequency_hz <= nyquist_hz);
        // Most records have no line, and one evidence does for all.
        let without = |lines: &[SpectralLine]| match lines {
            [] => Cow::Borrowed(&whole),
            lines => Cow::Owned(self.evidence(lines)),
        };
        let described = |evidence: &Evidence| match rounded_above_hz {
            Some(highest_hz) => describe_in_range(channel, &evidence.up_to(highest_hz), nyquist_hz, &options),
            None => describe_in_range(channel, evidence, nyquist_hz, &options),
        };
        let mut lines = retain(&seen, |l| is_coherent(&whole, l));
        sinusoids::fit(self.blocks, self.tau0_s, &mut lines);
        let mut evidence = without(&lines);
        let mut ranged = described(&evidence);
        for _ in 0..REFINEMENT_ROUNDS {
            let found = &ranged.identification.described.model.quasi_periodic;
            // A peak that is neither coherent nor explained is a line after all; so is a disturbance that hardly decays.
            let left = retain(&seen, |l| {
                !lines.iter().any(|k| (k.frequency_hz - l.frequency_hz).abs() < l.resolution_hz)
                    && !found.iter().any(|q| explains(q, l))
            });
            let steady: Vec<SpectralLine> = found
                .iter()
                .filter(|_| !ranged.is_void())
                .filter(|q| q.decay_time_s > COHERENT_DECAY_SHARE * whole.span_s)
                .map(|q| self.as_line(q, &whole))
                .collect();
            if left.is_empty() && steady.is_empty() {
                break;
            }
            lines = retain(&[lines, left, steady].concat(), |_| true);
            lines.sort_ascending_by(|a| a.frequency_hz);
            lines = retain(&lines, |_| true);
            sinusoids::fit(self.blocks, self.tau0_s, &mut lines);
            evidence = without(&lines);
            ranged = described(&evidence);
        }
        ranged.rounded_above_hz = rounded_above_hz;
        ranged.highest_hz = ranged.highest_hz.or(rounded_above_hz);
        let ranged = identify_over(channel, &evidence, &options, &ranged);
        let mut noise = RecordNoise { ranged, lines };
        describe_lines(&mut noise.ranged.identification.described, &noise.lines);
        noise
    }

    /// A disturbance that hardly decays, as a line. What it fills is masked like any line of the periodogram: a line
    /// that wanders a little is one line.
    fn as_line(&self, q: &Damped, evidence: &Evidence) -> SpectralLine {
        let resolution_hz = match self.welch.filter(|w| w.segment_len > 0) {
            Some(welch) => 1.0 / (welch.segment_len as f64 * self.tau0_s),
            None => 4.0 * evidence.resolution_hz(q.frequency_hz),
        };
        let resolution_hz = resolution_hz.min(0.25 * q.frequency_hz);
        // Of a Hann window: A²/(6 S) a bin.
        let in_a_bin = 2.0 * q.rms_deg_h.powi(2) / (6.0 * resolution_hz);
        SpectralLine {
            frequency_hz: q.frequency_hz,
            resolution_hz,
            amplitude_deg_h: q.rms_deg_h * 2f64.sqrt(),
            excess: 1.0 + in_a_bin / evidence.power_near(q.frequency_hz).max(f64::MIN_POSITIVE),
            false_alarm_probability: 0.0,
            harmonic_of: None,
            harmonic_order: 1,
            sinusoid: None,
        }
    }
}

/// Puts lines into a description, the uncertainty of their amplitudes among its parameters.
fn describe_lines(described: &mut Described, lines: &[SpectralLine]) {
    let line = |l: &SpectralLine| Line { amplitude_deg_h: l.amplitude_deg_h, frequency_hz: l.frequency_hz };
    described.model.lines = lines.iter().map(line).collect();
    if described.covariance.len() != described.parameters.len() {
        return;
    }
    for (i, sinusoid) in lines.iter().enumerate().filter_map(|(i, l)| Some((i, l.sinusoid?))) {
        described.parameters.push(Parameter::LineAmplitude(i));
        let count = described.parameters.len();
        described.covariance.iter_mut().for_each(|row| row.push(0.0));
        let mut row = vec![0.0; count];
        row[count - 1] = sinusoid.amplitude_deviation_deg_h.powi(2);
        described.covariance.push(row);
    }
}

fn masks_of(lines: &[SpectralLine]) -> Vec<Mask> {
    lines.iter().map(mask_of).collect()
}

/// Two bins to each side; in a periodogram as far as the flanks of a Hann window, which fall as 1/(πk³)² from the peak,
/// stand above a twentieth of the floor.
fn mask_of(line: &SpectralLine) -> Mask {
    let bins = (20.0 * line.excess.max(0.0) / (PI * PI)).powf(1.0 / 6.0).max(2.0);
    Mask {
        frequency_hz: line.frequency_hz,
        half_width_hz: 2.0 * line.resolution_hz,
        windowed_half_width_hz: bins * line.resolution_hz,
    }
}

/// Half width at half power, Hz.
fn half_width_hz(q: &Damped) -> f64 {
    1.0 / (2.0 * PI * q.decay_time_s)
}

fn explains(q: &Damped, line: &SpectralLine) -> bool {
    (q.frequency_hz - line.frequency_hz).abs() <= 4.0 * half_width_hz(q) + 2.0 * line.resolution_hz
}
