//! The noise of a gyro at rest, from its samples.

use super::{Error, Rate};
use crate::estimate::Estimate;
use crate::i18n::Note;
use crate::measurand::{self, GyroEvidence, Options, Test};
use crate::noise::digest::{DigestPlan, RateAccumulator};
use crate::noise::family::Estimator;
use crate::noise::intervals::BoundedPoint;
use crate::noise::lines::{FALSE_ALARM_RATE, SpectralLine};
use crate::noise::motion::motion;

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
    let tau0_s = digest.tau0_s;
    let motion = motion(&digest.blocks, tau0_s, digest.quietest_deg_h, 0.0);
    let found =
        GyroEvidence::identify(rate.name.clone(), digest, tau0_s, FALSE_ALARM_RATE, rate.rounding_deg_h);
    Ok(Noise { evidence: GyroEvidence { motion, ..found } })
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
