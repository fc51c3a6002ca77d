//! The noise of a gyro at rest, from its samples.

use super::recording::checked_interval;
use super::{Error, Rate};
use crate::acceptance::figures::{allan_family, sigma_tau};
use crate::estimate::Estimate;
use crate::figure::Figure;
use crate::i18n::note;
use crate::ingest::MemoryValues;
use crate::measurand::{self, GyroEvidence, Options, Test};
use crate::noise::allan::{self, AllanAccumulator, DeviationCurve};
use crate::noise::digest::{DigestPlan, RateAccumulator};
use crate::noise::family::Estimator;
use crate::noise::intervals::BoundedPoint;
use crate::noise::intervals::bounded;
use crate::noise::lines::{FALSE_ALARM_RATE, SpectralLine};
use crate::noise::motion::motion;
use crate::noise::ruling::RulingNoise;
use crate::noise::tau_grid::TauGrid;

/// Samples that are handed on at a time: they stay in the cache of the processor.
const BLOCK_SAMPLES: usize = 8192;

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
    let mut accumulator = accumulator(rate.sample_interval_s);
    let mut start = 0;
    for run in rate.index.chunk_by(|a, b| *b == a.saturating_add(1)) {
        let end = start + run.len();
        let samples = rate.deg_h.get(start..end).unwrap_or_default();
        accumulator.push(samples, run.first().copied().unwrap_or_default(), false);
        start = end;
    }
    noise_of(rate.name.clone(), accumulator, rate.rounding_deg_h)
}

/// Identifies the noise terms from samples that another library holds, without a copy of them: one every `sample_interval_s`
/// seconds, each times `factor` in deg/h. Values that are no numbers split the record. `progress` gets samples read and
/// samples in all.
///
/// # Errors
/// [`Error::is_argument`] with fewer than two usable samples, or when the interval is not a positive number.
pub fn identify_in_memory(
    values: &dyn MemoryValues,
    sample_interval_s: f64,
    factor: f64,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<Noise, Error> {
    let mut accumulator = accumulator(checked_interval(sample_interval_s)?);
    in_blocks(values, progress, |samples, first_index| {
        if factor != 1.0 {
            samples.iter_mut().for_each(|v| *v *= factor);
        }
        accumulator.push(samples, first_index, first_index > 0);
    });
    noise_of("rate".to_owned(), accumulator, None)
}

fn accumulator(tau0_s: f64) -> RateAccumulator {
    RateAccumulator::new(DigestPlan { estimators: Estimator::ALL.to_vec(), ..DigestPlan::new(tau0_s) })
}

/// The noise of what was accumulated.
fn noise_of(name: String, accumulator: RateAccumulator, rounding_deg_h: Option<f64>) -> Result<Noise, Error> {
    let digest = accumulator.finish();
    if digest.samples < 2 {
        return Err(Error::argument(note!("library.too_few")));
    }
    let tau0_s = digest.tau0_s;
    let motion = motion(&digest.blocks, tau0_s, digest.quietest_deg_h, 0.0);
    let found = GyroEvidence::identify(name, digest, tau0_s, FALSE_ALARM_RATE, rounding_deg_h);
    Ok(Noise { evidence: GyroEvidence { motion, ..found } })
}

/// Which deviations, and at which averaging times.
#[derive(Debug, Clone)]
pub struct AllanPlan {
    /// Averaging times.
    pub taus: TauGrid,
    /// Deviations.
    pub estimators: Vec<Estimator>,
    /// Sums every term at any length, at 8 bytes a sample. Without it this is done up to four million samples; beyond, terms at
    /// long averaging times are taken in steps of at most 1/64 of the averaging time.
    pub exact: bool,
}

impl Default for AllanPlan {
    fn default() -> AllanPlan {
        AllanPlan { taus: TauGrid::Octave, estimators: vec![Estimator::Allan], exact: false }
    }
}

/// A deviation over averaging times.
#[derive(Debug, Clone)]
pub struct AllanCurve {
    /// Which deviation.
    pub estimator: Estimator,
    /// Points in the unit of the samples, ascending in averaging time (averaging factor times sample interval), with intervals
    /// for the noise that rules there by the slope of the curve.
    pub points: Vec<BoundedPoint>,
}

/// Allan-type deviations of samples that another library holds, in their unit, without a copy of them: one sample every
/// `sample_interval_s` seconds. Values that are no numbers split the record: only terms within unbroken stretches are used. `progress`
/// gets samples read and samples in all.
///
/// # Errors
/// [`Error::is_argument`] when the interval is not a positive number, an averaging time is no multiple of it, or fewer than two
/// samples are usable.
pub fn allan(
    values: &dyn MemoryValues,
    sample_interval_s: f64,
    plan: &AllanPlan,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<Vec<AllanCurve>, Error> {
    let tau0_s = checked_interval(sample_interval_s)?;
    plan.taus.check(tau0_s).map_err(|e| Error::argument(e.note()))?;
    let sums =
        |grid, estimators, exact| AllanAccumulator::new(allan::AllanPlan { tau0_s, grid, exact, estimators });
    let mut accumulator = sums(plan.taus.clone(), plan.estimators.clone(), plan.exact);
    // The slope is read on octaves of the overlapping Allan deviation, whatever was asked for.
    let asked_for_them = plan.taus == TauGrid::Octave && plan.estimators.contains(&Estimator::Allan);
    let mut octaves = (!asked_for_them).then(|| sums(TauGrid::Octave, vec![Estimator::Allan], false));
    in_blocks(values, progress, |samples, first_index| {
        let mut at = first_index;
        for run in samples.split_inclusive(|v| !v.is_finite()) {
            let usable = run.split_last().filter(|(v, _)| !v.is_finite()).map_or(run, |(_, before)| before);
            accumulator.push(usable, at, true);
            if let Some(octaves) = &mut octaves {
                octaves.push(usable, at, true);
            }
            at += run.len() as u64;
        }
    });
    let set = accumulator.finish();
    if set.stretches.samples() < 2 {
        return Err(Error::argument(note!("library.too_few")));
    }
    let octaves = octaves.map(AllanAccumulator::finish);
    let read_from = octaves.as_ref().unwrap_or(&set).curve(Estimator::Allan);
    let samples = set.stretches.samples();
    let ruling = read_from.map(|c| RulingNoise::of_octaves(&c.points, samples)).unwrap_or_default();
    let curve = |c: &DeviationCurve| AllanCurve {
        estimator: c.estimator,
        points: c.points.iter().map(|p| bounded(c.estimator, p, &c.stretches, ruling.at(p.m))).collect(),
    };
    Ok(set.curves.iter().map(curve).collect())
}

/// Draws deviations with their intervals; the ordinate is in the unit of the samples.
pub fn draw(curves: &[AllanCurve], sample_interval_s: f64) -> Figure {
    let curve = |c: &AllanCurve| {
        let points = c.points.iter().filter(|p| p.point.deviation > 0.0);
        (c.estimator, points.map(|p| (p.point.m as f64 * sample_interval_s, *p)).collect())
    };
    allan_family::of_curves(&curves.iter().map(curve).collect::<Vec<_>>(), "", false, "")
}

/// Hands samples on in blocks, with the index of the first of each.
fn in_blocks(
    values: &dyn MemoryValues,
    progress: &mut dyn FnMut(u64, u64),
    mut take: impl FnMut(&mut [f64], u64),
) {
    let rows = values.rows();
    let mut block = Vec::with_capacity(BLOCK_SAMPLES);
    for start in (0..rows).step_by(BLOCK_SAMPLES) {
        let end = (start + BLOCK_SAMPLES).min(rows);
        block.clear();
        values.append(start..end, &mut block);
        take(&mut block, start as u64);
        progress(end as u64, rows as u64);
    }
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

    /// The drawing of the Allan deviation with the identified terms.
    pub fn figure(&self) -> Figure {
        sigma_tau::figure(&self.evidence, &|_| None)
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
