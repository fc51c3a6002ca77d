//! One pass over a rate channel: every statistic that its noise is judged by.

use super::allan::{AllanAccumulator, AllanPlan, DeviationSet};
use super::block_series::BlockSeriesAccumulator;
use super::data::BlockSeries;
use super::envelope::{Envelope, EnvelopeAccumulator};
use super::family::Estimator;
use super::histogram::{Histogram, HistogramAccumulator};
use super::motion::Quietest;
use super::part::{MergeError, PartStart};
use super::phase::Compensated;
use super::tau_grid::TauGrid;
use super::welch::{WelchAccumulator, WelchResult};
use super::windows::{WindowMeans, WindowStatistics};
use crate::numeric::range;

/// Samples that go through all accumulators while they are in cache.
const SLICE_SAMPLES: usize = 8192;

/// Samples in a push from which two threads are worth their start.
const SIDE_BY_SIDE: usize = 2 * SLICE_SAMPLES;

/// Neighbouring usable samples.
struct Run<'a> {
    samples: &'a [f64],
    /// Grid index of the first.
    first_index: u64,
    /// Whether they follow on those before.
    continues: bool,
}

/// Largest rate that can be used, deg/h: the largest number of a file in rad/s, rounded up.
const MAX_RATE_DEG_H: f64 = 1e6 * range::MAX_MAGNITUDE;

/// What a digest of a rate channel holds: averaging times, deviations and window lengths.
#[derive(Debug, Clone, PartialEq)]
pub struct DigestPlan {
    /// Sample interval, s.
    pub tau0_s: f64,
    /// Averaging times of the σ(τ) curves.
    pub taus: TauGrid,
    /// Sums every term of σ(τ) at any length, at 8 bytes a sample.
    pub exact: bool,
    /// Deviations wanted.
    pub estimators: Vec<Estimator>,
    /// Lengths of the windows whose means are taken, s (100 and 10 for the Russian values).
    pub window_lengths_s: Vec<f64>,
}

impl DigestPlan {
    /// Octaves of the overlapping Allan deviation, windows of 100 s and 10 s.
    pub fn new(tau0_s: f64) -> Self {
        DigestPlan {
            tau0_s,
            taus: TauGrid::Octave,
            exact: false,
            estimators: vec![Estimator::Allan],
            window_lengths_s: vec![100.0, 10.0],
        }
    }
}

/// What a digest chooses from the first samples that it sees: the parts of one recording must be given the same.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PartSettings {
    /// Samples in a segment of the averaged periodogram.
    pub segment_len: Option<usize>,
    /// Scale of the histogram, deg/h.
    pub histogram_scale_deg_h: Option<f64>,
    /// Factor up to which every term of the Allan family is summed; `None`: every phase is kept.
    pub dense_below: Option<u64>,
}

fn usable(rate_deg_h: f64) -> bool {
    rate_deg_h.abs() <= MAX_RATE_DEG_H
}

/// Everything one pass leaves behind. Rates in deg/h.
#[derive(Debug, Clone, PartialEq)]
pub struct RateDigest {
    /// Sample interval, s.
    pub tau0_s: f64,
    /// Finite samples.
    pub samples: u64,
    /// Samples that were not finite or beyond 1e66 deg/h: each splits the record.
    pub unusable: u64,
    /// Mean of the finite samples, deg/h; NaN without any.
    pub mean: f64,
    /// Least finite sample, deg/h.
    pub min: f64,
    /// Greatest finite sample, deg/h.
    pub max: f64,
    /// The Allan family with the unbroken stretches of the record.
    pub deviations: DeviationSet,
    /// The overlapping Allan deviation at octaves, where `deviations` is on another grid: the minimum is read on octaves
    /// whatever was asked for.
    pub octaves: Option<DeviationSet>,
    /// Averaged periodogram.
    pub welch: WelchResult,
    /// Block means on the grid.
    pub blocks: BlockSeries,
    /// Window means, one entry for each length of the plan, in its order.
    pub windows: Vec<WindowStatistics>,
    /// Amplitude distribution about the means of short blocks.
    pub histogram: Histogram,
    /// The rate over time for a plot.
    pub envelope: Envelope,
    /// Standard deviation within the quietest second, deg/h: what the noise is where a record that moves stands still.
    pub quietest_deg_h: Option<f64>,
}

/// Streaming digest of one rate channel: push samples in blocks of any size, then [`RateAccumulator::finish`]. Digests of
/// neighbouring parts of a recording are joined by [`RateAccumulator::merged`].
#[derive(Debug, Clone)]
pub struct RateAccumulator {
    tau0_s: f64,
    allan: AllanAccumulator,
    octaves: Option<AllanAccumulator>,
    welch: WelchAccumulator,
    blocks: BlockSeriesAccumulator,
    windows: Vec<WindowMeans>,
    histogram: HistogramAccumulator,
    envelope: EnvelopeAccumulator,
    quietest: Quietest,
    samples: u64,
    unusable: u64,
    reference: f64,
    sum: Compensated,
    min: f64,
    max: f64,
    next_index: Option<u64>,
}

impl RateAccumulator {
    /// An empty digest.
    pub fn new(plan: DigestPlan) -> Self {
        Self::of_part(plan, PartStart::default(), PartSettings::default())
    }

    /// An empty digest of a part of a recording, to be merged with those of its neighbours.
    pub fn of_part(plan: DigestPlan, start: PartStart, settings: PartSettings) -> Self {
        let DigestPlan { tau0_s, taus, exact, estimators, window_lengths_s } = plan;
        let before = start.samples_before;
        let allan = |grid, exact, estimators| {
            let plan = AllanPlan { tau0_s, grid, exact, estimators };
            AllanAccumulator::of_part(plan, start, settings.dense_below)
        };
        let octaves =
            (taus != TauGrid::Octave).then(|| allan(TauGrid::Octave, false, vec![Estimator::Allan]));
        RateAccumulator {
            tau0_s,
            octaves,
            allan: allan(taus, exact, estimators),
            welch: WelchAccumulator::of_part(before, settings.segment_len),
            blocks: BlockSeriesAccumulator::default(),
            windows: window_lengths_s.iter().map(|w| WindowMeans::of_part(*w, tau0_s, before)).collect(),
            histogram: HistogramAccumulator::of_part(before, settings.histogram_scale_deg_h),
            envelope: EnvelopeAccumulator::new(),
            quietest: Quietest::of_part(tau0_s, before),
            samples: 0,
            unusable: 0,
            reference: 0.0,
            sum: Compensated::default(),
            min: f64::INFINITY,
            max: f64::NEG_INFINITY,
            next_index: (before > 0).then_some(start.first_index),
        }
    }

    /// Choices of this digest so far, for the parts that follow.
    pub fn settings(&self) -> PartSettings {
        PartSettings {
            segment_len: self.welch.segment_len(),
            histogram_scale_deg_h: self.histogram.scale(),
            dense_below: self.allan.dense_below(),
        }
    }

    /// This digest with that of the next part of the recording. Counts, extremes, terms and windows are those of one pass
    /// over both; sums agree to rounding.
    ///
    /// # Errors
    /// Where the part begins elsewhere than this one ends, or was accumulated with other settings.
    pub fn merged(mut self, later: RateAccumulator) -> Result<RateAccumulator, MergeError> {
        if later.samples == 0 {
            self.unusable += later.unusable;
            self.next_index = if later.unusable > 0 { None } else { self.next_index };
            return Ok(self);
        }
        let alike = self.tau0_s == later.tau0_s
            && self.windows.len() == later.windows.len()
            && self.octaves.is_some() == later.octaves.is_some();
        if !alike {
            return Err(MergeError::Settings);
        }
        self.allan.merge(later.allan)?;
        if let (Some(octaves), Some(later)) = (&mut self.octaves, later.octaves) {
            octaves.merge(later)?;
        }
        self.welch.merge(later.welch)?;
        self.blocks.merge(&later.blocks);
        for (windows, later) in self.windows.iter_mut().zip(later.windows) {
            windows.merge(later)?;
        }
        self.histogram.merge(later.histogram)?;
        self.envelope.merge(&later.envelope);
        self.quietest.merge(later.quietest)?;
        if self.samples == 0 {
            self.reference = later.reference;
        }
        self.sum.add_sum(later.sum);
        self.sum.add(later.samples as f64 * (later.reference - self.reference));
        self.samples += later.samples;
        self.unusable += later.unusable;
        self.min = self.min.min(later.min);
        self.max = self.max.max(later.max);
        self.next_index = later.next_index;
        Ok(self)
    }

    /// Takes contiguous samples, deg/h, the first at grid index `first_index`. Samples that are not finite, or
    /// beyond 1e66 in magnitude, cannot be used: they are counted, and split the record there. `continues = false` splits it before the first sample.
    pub fn push(&mut self, samples: &[f64], first_index: u64, continues: bool) {
        if samples.is_empty() {
            self.next_index = self.next_index.filter(|_| continues);
            return;
        }
        let mut at = first_index;
        let mut continues = continues && self.next_index == Some(first_index);
        let mut runs = Vec::with_capacity(samples.len() / SLICE_SAMPLES + 1);
        for slice in samples.chunks(SLICE_SAMPLES) {
            let mut offset = 0;
            for samples in slice.split(|y| !usable(*y)) {
                if !samples.is_empty() {
                    runs.push(Run { samples, first_index: at.saturating_add(offset as u64), continues });
                    continues = true;
                }
                offset += samples.len();
                if offset < slice.len() {
                    self.unusable += 1;
                    offset += 1;
                    continues = false;
                }
            }
            at = at.saturating_add(slice.len() as u64);
        }
        // Behind an unusable last sample nothing continues.
        self.next_index = continues.then_some(at);
        self.take(&runs, samples.len());
    }

    /// Everything about the samples pushed so far.
    pub fn finish(self) -> RateDigest {
        RateDigest {
            tau0_s: self.tau0_s,
            samples: self.samples,
            unusable: self.unusable,
            mean: if self.samples > 0 {
                self.reference + self.sum.value() / self.samples as f64
            } else {
                f64::NAN
            },
            min: self.min,
            max: self.max,
            deviations: self.allan.finish(),
            octaves: self.octaves.map(AllanAccumulator::finish),
            welch: self.welch.finish(),
            blocks: self.blocks.finish(),
            windows: self.windows.into_iter().map(WindowMeans::finish).collect(),
            histogram: self.histogram.finish(),
            envelope: self.envelope.finish(),
            quietest_deg_h: self.quietest.finish(),
        }
    }

    /// Runs of `count` samples in all go through the accumulators, where there are many of them through two halves side by
    /// side. Each accumulator sees the same runs in the same order either way.
    fn take(&mut self, runs: &[Run<'_>], count: usize) {
        for run in runs {
            self.moments(run.samples);
        }
        let RateAccumulator { allan, octaves, welch, blocks, windows, histogram, envelope, quietest, .. } =
            self;
        let mut deviations = || {
            for Run { samples, first_index, continues } in runs {
                allan.push(samples, *first_index, *continues);
                if let Some(octaves) = octaves {
                    octaves.push(samples, *first_index, *continues);
                }
                windows.iter_mut().for_each(|w| w.push(samples, *continues));
            }
        };
        let mut others = || {
            for Run { samples, first_index, continues } in runs {
                welch.push(samples, *continues);
                blocks.push(samples, *first_index);
                histogram.push(samples, *continues);
                envelope.push(samples, *first_index);
                quietest.push(samples, *continues);
            }
        };
        if count < SIDE_BY_SIDE {
            deviations();
            others();
        } else {
            rayon::join(deviations, others);
        }
    }

    /// Mean and extremes.
    fn moments(&mut self, run: &[f64]) {
        if self.samples == 0 {
            self.reference = run.first().copied().unwrap_or(0.0);
        }
        let mut sum = 0.0;
        for y in run {
            sum += y - self.reference;
            self.min = if *y < self.min { *y } else { self.min };
            self.max = if *y > self.max { *y } else { self.max };
        }
        self.sum.add(sum);
        self.samples += run.len() as u64;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(count: u32) -> Vec<f64> {
        (0..count).map(|i| 10.0 + f64::from(i.wrapping_mul(2_654_435_761) >> 8) / 16_777_216.0).collect()
    }

    #[test]
    fn octaves_beside_another_grid_are_split_at_the_same_samples() {
        let mut samples = record(4000);
        // The last sample of a block: the next block must not be joined to what lies before it.
        samples[1999] = f64::NAN;
        let digest = |taus| {
            let mut a = RateAccumulator::new(DigestPlan { taus, ..DigestPlan::new(1.0) });
            a.push(&samples[..2000], 0, false);
            a.push(&samples[2000..], 2000, true);
            a.finish()
        };
        let octave = digest(TauGrid::Octave);
        assert_eq!(octave.octaves, None);
        assert_eq!(digest(TauGrid::List(vec![3.0])).octaves, Some(octave.deviations));
    }

    #[test]
    fn unusable_samples_split_the_record_wherever_blocks_end() {
        let mut y = record(30_000);
        for i in [0, 1, 99, 8191, 8192, 16_383, 20_000, 29_999] {
            y[i] = f64::NAN;
        }
        let digest = |size: usize| {
            let mut acc = RateAccumulator::new(DigestPlan::new(0.1));
            for (k, block) in y.chunks(size).enumerate() {
                acc.push(block, (size * k) as u64, k > 0);
            }
            acc.finish()
        };
        let whole = digest(30_000);
        assert_eq!((whole.samples, whole.unusable), (29_992, 8));
        assert_eq!(whole.deviations.stretches.count(), 5);
        assert_eq!(whole.deviations.stretches.longest(), 9998);
        // Stretches of 97, 8091, 8190, 3616 and 9998 samples hold so many windows of 1000.
        assert_eq!(whole.windows[0].n, 8 + 8 + 3 + 9);
        for size in [1, 100, 8192, 12_345] {
            let other = digest(size);
            assert_eq!(other.deviations, whole.deviations, "{size}");
            assert_eq!(other.histogram, whole.histogram, "{size}");
            assert_eq!(other.welch, whole.welch, "{size}");
            assert_eq!(other.windows[1].n, whole.windows[1].n);
            assert!(
                (other.windows[0].standard_deviation / whole.windows[0].standard_deviation - 1.0).abs()
                    < 1e-9
            );
            assert!((other.mean - whole.mean).abs() < 1e-12);
            assert_eq!(other.blocks.count, whole.blocks.count);
        }
    }

    #[test]
    fn a_jump_of_the_index_splits_even_when_the_caller_says_it_continues() {
        let y = record(100);
        let mut acc = RateAccumulator::new(DigestPlan::new(1.0));
        acc.push(&y, 0, false);
        acc.push(&y, 150, true);
        acc.push(&y, u64::MAX, true);
        assert_eq!(acc.finish().deviations.stretches.count(), 3);
    }

    #[test]
    fn an_empty_or_unusable_record_gives_an_empty_digest() {
        let empty = RateAccumulator::new(DigestPlan::new(1.0)).finish();
        assert!(empty.mean.is_nan() && empty.samples == 0 && empty.blocks.mean.is_empty());
        let mut acc = RateAccumulator::new(DigestPlan::new(1.0));
        acc.push(&[f64::NAN, f64::INFINITY], 0, false);
        acc.push(&[], u64::MAX, true);
        let none = acc.finish();
        assert_eq!((none.samples, none.unusable, none.deviations.stretches.count()), (0, 2, 0));
    }
}
