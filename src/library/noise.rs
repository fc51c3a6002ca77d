//! The noise of a gyro at rest, from its samples.

use super::{Error, Rate};
use crate::estimate::Estimate;
use crate::i18n::Note;
use crate::measurand::{self, GyroEvidence, Options, Test};
use crate::noise::coarse;
use crate::noise::composite::{Composite, Sampling};
use crate::noise::curve_check;
use crate::noise::digest::{DigestPlan, RateAccumulator, RateDigest};
use crate::noise::family::Estimator;
use crate::noise::intervals::{BoundedPoint, bounded};
use crate::noise::lines::{FALSE_ALARM_RATE, SpectralLine, find_lines};
use crate::noise::motion::motion;
use crate::noise::residual::GoodnessOfFit;
use crate::noise::spectral_record::SpectralRecord;
use crate::noise::whole::Whole;

/// The noise that a recording shows: its terms with their intervals, its Allan deviation, its spectral lines.
pub struct Noise {
    evidence: GyroEvidence,
}

/// Identifies the noise terms of a gyro at rest from its samples.
///
/// ```
/// # fn main() -> Result<(), sagnac::Error> {
/// // White noise with N = 0.01 deg/sqrt(h), sampled at 1 Hz: a standard deviation of 0.01 * 60 deg/h.
/// let mut state = 1_u64;
/// let mut uniform = || {
///     state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
///     (state >> 11) as f64 / (1_u64 << 53) as f64
/// };
/// let samples = (0..20_000).map(|_| 0.6 * ((0..12).map(|_| uniform()).sum::<f64>() - 6.0)).collect();
/// let noise = sagnac::noise::identify(&sagnac::Rate::from_samples(samples, 1.0)?)?;
/// let n = noise.term("angle_random_walk").and_then(|n| n.interval95());
/// assert!(n.is_some_and(|n| n.low < 0.0101 && n.high > 0.0099));
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// [`Error::is_argument`] with fewer than two usable samples.
pub fn identify(rate: &Rate) -> Result<Noise, Error> {
    let tau0_s = rate.sample_interval_s;
    let plan = DigestPlan { estimators: Estimator::ALL.to_vec(), ..DigestPlan::new(tau0_s) };
    let mut accumulator = RateAccumulator::new(plan);
    let mut start = 0;
    for run in rate.index.chunk_by(|a, b| *b == a.saturating_add(1)) {
        let end = start + run.len();
        let samples = rate.deg_h.get(start..end).unwrap_or_default();
        accumulator.push(samples, run.first().copied().unwrap_or_default(), false);
        start = end;
    }
    let digest = accumulator.finish();
    if digest.samples < 2 {
        return Err(Error::argument(Note::new("library.too_few")));
    }
    Ok(Noise { evidence: evidence(&rate.name, digest, rate.rounding_deg_h) })
}

fn evidence(channel: &str, digest: RateDigest, rounding_deg_h: Option<f64>) -> GyroEvidence {
    let tau0_s = digest.tau0_s;
    let curve = digest.deviations.curve(Estimator::Allan);
    let points: Vec<(u64, f64)> =
        curve.map(|c| c.points.iter().map(|p| (p.m, p.deviation)).collect()).unwrap_or_default();
    let rounded_above_hz = rounding_deg_h.and_then(|step| coarse::highest_hz(step, tau0_s, &points));
    let strongest = find_lines(&digest.welch.spectrum, tau0_s, FALSE_ALARM_RATE).lines;
    let spectral = |lines| SpectralRecord {
        blocks: &digest.blocks,
        welch: Some(&digest.welch.spectrum),
        tau0_s,
        lines,
        sampling: Sampling::Averaging,
    };
    let noise = spectral(&strongest).identify_up_to(channel, rounded_above_hz);
    let (mut lines, mut identification) = (noise.lines, noise.ranged.identification);
    let octaves = allan_points(&digest, &identification.described.model);
    let whole = Whole::of(&digest, &octaves, identification.highest_hz);
    let withheld_line = whole.lines(&mut lines);
    if withheld_line.is_some() {
        let kept: Vec<f64> = lines.iter().map(|l| l.frequency_hz).collect();
        identification.described.keep_lines(|line| kept.contains(&line.frequency_hz));
    }
    whole.parts(&mut identification);
    curve_check::contest(&mut identification, &octaves, tau0_s, digest.samples);
    let octave_points: Vec<_> = octaves.iter().map(|p| p.point).collect();
    let goodness = GoodnessOfFit::of(&spectral(&lines), &identification.described, &octave_points);
    GyroEvidence {
        channel: channel.to_owned(),
        several: false,
        tau0_s,
        longest_stretch_s: digest.deviations.stretches.longest() as f64 * tau0_s,
        motion: motion(&digest.blocks, tau0_s, digest.quietest_deg_h, 0.0),
        digest,
        sigma_tau: octaves.clone(),
        octaves,
        identification,
        goodness,
        lines,
        withheld_line,
        earth: None,
        over_temperature: None,
        warm_up: None,
    }
}

/// The overlapping Allan deviation at octaves with its intervals.
fn allan_points(digest: &RateDigest, model: &Composite) -> Vec<BoundedPoint> {
    // A line adds to a deviation and does not scatter, so its slope tells nothing about degrees of freedom.
    let scattering = Composite { lines: vec![], ..model.clone() };
    let bound = |curve: &crate::noise::allan::DeviationCurve| {
        let noise = |m: u64| scattering.dominant(m as f64 * digest.tau0_s, digest.tau0_s);
        let points = curve.points.iter();
        points.map(|p| bounded(Estimator::Allan, p, &curve.stretches, noise(p.m))).collect()
    };
    digest.deviations.curve(Estimator::Allan).map(bound).unwrap_or_default()
}

impl Noise {
    /// N, B, K, R and Q, each with its interval, or with an upper limit where the recording does not resolve it.
    pub fn terms(&self) -> [&Estimate; 5] {
        self.evidence.identification.estimates()
    }

    /// One of the terms by its id: `angle_random_walk`, `bias_instability`, `rate_random_walk`, `rate_ramp`,
    /// `quantization`.
    pub fn term(&self, id: &str) -> Option<&Estimate> {
        self.terms().into_iter().find(|term| term.id == id)
    }

    /// The overlapping Allan deviation at octaves of the sample interval, deg/h, with 95 % intervals.
    pub fn allan(&self) -> &[BoundedPoint] {
        &self.evidence.octaves
    }

    /// Spectral lines, in order of frequency.
    pub fn lines(&self) -> &[SpectralLine] {
        &self.evidence.lines
    }

    /// Any quantity of a gyro at rest by its id, for example `static_bias` or `russian_drift_100s` (see
    /// [`crate::measurand::MEASURANDS`]). `None` for an id that is not one of a gyro at rest.
    pub fn measure(&self, id: &str) -> Option<Estimate> {
        let known = measurand::find(id).filter(|m| m.test() == Test::Static)?;
        known.evaluate_gyro(&self.evidence, &Options { remove_earth_rate: false }).into_iter().next()
    }

    /// Everything that one pass over the samples left behind: what an own [`measurand::Measurand`] is computed from.
    pub fn evidence(&self) -> &GyroEvidence {
        &self.evidence
    }
}
