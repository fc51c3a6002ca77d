//! Samples far outside the noise about them.
//!
//! In blocks of 1024 samples: median and median absolute deviation, then the standard deviation of what lies within
//! four of those (nearly as precise as that of clean data, which a threshold far out in the tail needs). A sample is a
//! candidate when it is at least five deviations both from the median of its block and from the median of the 33
//! samples about it, and stands out from their scatter: a step or a motion carries its surroundings along, an outlier
//! does not. The threshold is set
//! at the end from the number of samples n: 5, or more where n·2·(1−Φ(k)) would exceed 0.02, so that a Gaussian record
//! of any length shows a false outlier in about one case in fifty. Method: Hampel (1974), F. R. Hampel, JASA 69.

use super::place::{Place, Places};
use super::summary::summary;
use sagnac_core::estimate::normal_quantile;

/// Samples judged together.
const BLOCK: usize = 1024;
/// Samples on each side that a candidate is compared with.
const MARGIN: usize = 16;
/// Fewest samples that can be judged.
pub(super) const MIN_SAMPLES: usize = 64;
/// Lowest threshold, robust standard deviations.
const LOWEST: f64 = 5.0;
/// The same against the scatter of the 33 samples about it, which is known less well.
const LOCAL: f64 = 3.5;
/// False outliers allowed in a Gaussian record.
const FALSE_ALARMS: f64 = 0.02;
/// Candidates whose place is kept, below and above `CLEAR`.
const MAX_LISTED: usize = 1000;
/// Deviation beyond which a candidate is an outlier in a record of any length.
const CLEAR: f64 = 8.0;
/// Bins of the count of candidates by deviation, each a hundredth wide, from `LOWEST` to `CLEAR`.
const BINS: usize = 300;

/// Blocks after which the robust scale is measured again whatever the block looks like.
const REFRESH: u32 = 32;

#[derive(Debug, Clone)]
pub(super) struct OutlierCheck {
    buffer: Vec<f64>,
    /// Leading samples of the buffer that were judged before.
    context: usize,
    /// Position of the first sample of the buffer.
    base: u64,
    places: Places,
    taken: u64,
    bins: Vec<u64>,
    clear: u64,
    kept: Vec<(Place, f64)>,
    kept_clear: usize,
    scale: f64,
    age: u32,
    scratch: Vec<f64>,
}

impl OutlierCheck {
    pub(super) fn new(interval_s: f64) -> OutlierCheck {
        OutlierCheck {
            buffer: Vec::with_capacity(2 * BLOCK + 2 * MARGIN),
            context: 0,
            base: 0,
            places: Places::new(interval_s),
            taken: 0,
            bins: vec![0; BINS],
            clear: 0,
            kept: Vec::new(),
            kept_clear: 0,
            scale: 0.0,
            age: REFRESH,
            scratch: Vec::new(),
        }
    }

    pub(super) fn take(&mut self, mut values: &[f64], place: Place) {
        self.places.start(self.taken, place);
        self.taken += values.len() as u64;
        const FULL: usize = 2 * BLOCK + 2 * MARGIN;
        while !values.is_empty() {
            let (part, rest) = values.split_at(values.len().min(FULL.saturating_sub(self.buffer.len())));
            self.buffer.extend_from_slice(part);
            values = rest;
            if self.buffer.len() >= FULL {
                self.judge(self.context, self.context + BLOCK);
                let judged = self.context + BLOCK - MARGIN;
                self.buffer.drain(..judged);
                self.base += judged as u64;
                self.context = MARGIN;
                self.places.forget(self.base);
            }
        }
    }

    /// Judges what is left; returns the number of outliers and the threshold.
    pub(super) fn finish(&mut self) -> (u64, f64) {
        let end = self.buffer.len();
        if end - self.context >= MIN_SAMPLES {
            self.judge(self.context, end);
        }
        self.buffer.clear();
        self.context = 0;
        let threshold = threshold(self.taken);
        let first = ((threshold - LOWEST) * 100.0).round() as usize;
        let count = self.bins.iter().skip(first).sum::<u64>() + self.clear;
        (count, threshold)
    }

    /// Places and deviations of the outliers that were kept, in order.
    pub(super) fn listed(&self, threshold: f64) -> impl Iterator<Item = (Place, f64)> {
        let mut list: Vec<(Place, f64)> =
            self.kept.iter().filter(|(_, z)| *z >= threshold).copied().collect();
        list.sort_by_key(|(p, _)| p.row);
        list.into_iter()
    }

    fn judge(&mut self, from: usize, to: usize) {
        let Some(block) = self.buffer.get(from..to) else { return };
        let (deviation, farthest) = spread(block);
        if deviation == 0.0 {
            return;
        }
        self.age += 1;
        let ordinary = farthest <= 3.3 * deviation && deviation <= 1.2 * self.scale;
        if ordinary && self.age < REFRESH {
            return;
        }
        let middle = median(&mut self.scratch, block);
        self.scratch.iter_mut().for_each(|v| *v = (*v - middle).abs());
        let half = self.scratch.len() / 2;
        let (_, mad, _) = self.scratch.select_nth_unstable_by(half, f64::total_cmp);
        let mut robust = 1.4826 * *mad;
        // More than half of the values are equal: a coarse quantization grid. One step is then never an outlier.
        let smallest = self.scratch.iter().copied().filter(|d| *d > 0.0).fold(f64::INFINITY, f64::min);
        let floor = if robust == 0.0 { 0.5 * smallest } else { 0.0 };
        robust = robust.max(floor);
        let (sum, count) = self
            .scratch
            .iter()
            .filter(|d| **d < 4.0 * robust)
            .fold((0.0, 0u64), |(s, n), d| (s + d * d, n + 1));
        let scale = (sum / count.max(1) as f64).sqrt().max(floor);
        self.scale = scale;
        self.age = 0;
        if scale == 0.0 || !scale.is_finite() {
            return;
        }
        for i in from..to {
            let Some(&v) = self.buffer.get(i) else { continue };
            let z = (v - middle).abs() / scale;
            if z < LOWEST {
                continue;
            }
            let window = (i.saturating_sub(MARGIN), (i + MARGIN + 1).min(self.buffer.len()));
            let local = median(&mut self.scratch, self.buffer.get(window.0..window.1).unwrap_or_default());
            let distance = (v - local).abs();
            self.scratch.iter_mut().for_each(|x| *x = (*x - local).abs());
            let half = self.scratch.len() / 2;
            let local_scale = 1.4826 * *self.scratch.select_nth_unstable_by(half, f64::total_cmp).1;
            let z = z.min(distance / scale);
            if z >= LOWEST && distance >= LOCAL * local_scale {
                self.candidate(i, z);
            }
        }
    }

    fn candidate(&mut self, index: usize, z: f64) {
        let bin = ((z - LOWEST) * 100.0) as usize;
        match self.bins.get_mut(bin) {
            Some(count) => *count += 1,
            None => self.clear += 1,
        }
        let is_clear = z >= CLEAR;
        let kept = if is_clear { self.kept_clear } else { self.kept.len() - self.kept_clear };
        if kept < MAX_LISTED {
            self.kept.push((self.places.of(self.base + index as u64), z));
            self.kept_clear += usize::from(is_clear);
        }
    }
}

/// The threshold for a number of samples, rounded up to a hundredth.
fn threshold(samples: u64) -> f64 {
    let quantile = normal_quantile(1.0 - FALSE_ALARMS / 2.0 / samples.max(1) as f64);
    ((quantile.max(LOWEST) * 100.0 - 1e-9).ceil() / 100.0).min(CLEAR)
}

/// Standard deviation about the mean, and the largest distance from it.
fn spread(block: &[f64]) -> (f64, f64) {
    let n = block.len().max(1) as f64;
    let s = summary(block, block.first().copied().unwrap_or(0.0));
    let mean = block.first().copied().unwrap_or(0.0) + s.sum / n;
    let variance = s.squares / n - (s.sum / n).powi(2);
    // The difference above loses its digits when the block is one long slope; then the scale is measured anyway.
    (variance.max(0.0).sqrt(), (s.max - mean).max(mean - s.min))
}

/// The median, leaving the values in the scratch space.
fn median(scratch: &mut Vec<f64>, values: &[f64]) -> f64 {
    scratch.clear();
    scratch.extend_from_slice(values);
    if scratch.is_empty() {
        return f64::NAN;
    }
    let half = scratch.len() / 2;
    *scratch.select_nth_unstable_by(half, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_threshold_grows_with_the_record() {
        assert_eq!(threshold(1000), 5.0);
        for n in [1_000_000u64, 36_000_000, 1_000_000_000] {
            let expected = n as f64 * 2.0 * (1.0 - sagnac_core::estimate::normal_probability(threshold(n)));
            assert!(expected <= FALSE_ALARMS * 1.01 && expected > FALSE_ALARMS * 0.9, "{n} {expected}");
        }
    }
}
