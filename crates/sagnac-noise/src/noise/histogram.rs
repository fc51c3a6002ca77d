//! Amplitude distribution of the fast noise: deviations from the mean of each block, so that drift does not widen it.

use super::part::{Head, MergeError};

/// Samples in a block whose mean is taken off.
pub(super) const BLOCK_SAMPLES: usize = 1024;
/// A shorter rest of a stretch than this is left out.
const MIN_BLOCK: usize = 64;
/// Bins from −8 to +8 scale units.
const BIN_COUNT: usize = 128;
const HALF_RANGE: f64 = 8.0;
/// Fourth powers beyond are summed in other units: many of them would leave the range of a double.
const MAX_POWER: f64 = 1e150;

/// Histogram with moments of the deviations from block means, deg/h.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Histogram {
    /// Robust standard deviation of the first block, deg/h: the bins are an eighth of it wide. 0 where it is flat.
    pub scale: f64,
    /// Lower edge of the first bin, deg/h; the bins are symmetric about 0.
    pub from: f64,
    /// Width of a bin, deg/h.
    pub bin_width: f64,
    /// Samples in each bin.
    pub counts: Vec<u64>,
    /// Samples below the first bin.
    pub below: u64,
    /// Samples above the last bin.
    pub above: u64,
    /// Samples counted.
    pub samples: u64,
    /// Samples in rests of stretches too short to take a mean off.
    pub unused_samples: u64,
    /// Standard deviation about the block means, deg/h.
    pub standard_deviation: f64,
    /// Skewness, 0 for Gaussian noise; its standard error there is √(6/n).
    pub skewness: f64,
    /// Excess kurtosis, 0 for Gaussian noise; its standard error there is √(24/n).
    pub excess_kurtosis: f64,
}

/// Streaming histogram of the deviations of samples from the means of blocks of 1024.
#[derive(Debug, Clone, Default)]
pub struct HistogramAccumulator {
    head: Head,
    pending: Vec<f64>,
    scale: Option<f64>,
    counts: Vec<u64>,
    below: u64,
    above: u64,
    samples: u64,
    unused: u64,
    /// Sums of powers 2, 3, 4 in units of the scale times the magnitude.
    powers: [f64; 3],
    /// Size of the largest deviations in units of the scale, where their fourth powers would be too large; 0: 1.
    magnitude: f64,
    blocks: u64,
}

impl HistogramAccumulator {
    /// An empty accumulator.
    pub fn new() -> Self {
        HistogramAccumulator { counts: vec![0; BIN_COUNT], ..Self::default() }
    }

    /// The accumulator of a part with `samples_before` samples of its stretch before it. `scale`, deg/h, as
    /// [`HistogramAccumulator::scale`] of another part gives it, makes the bins: parts are merged only with the same bins.
    pub fn of_part(samples_before: u64, scale: Option<f64>) -> Self {
        let beyond = (samples_before % BLOCK_SAMPLES as u64) as usize;
        let head = Head::new(samples_before, (BLOCK_SAMPLES - beyond) % BLOCK_SAMPLES);
        HistogramAccumulator { head, scale: scale.filter(|s| *s > 0.0 && s.is_finite()), ..Self::new() }
    }

    /// The scale of the bins, deg/h; `None` until a block of samples scatters.
    pub fn scale(&self) -> Option<f64> {
        self.scale
    }

    /// Adds the next part of the recording. Counts are those of one pass, moments agree to rounding.
    ///
    /// # Errors
    /// Where the part begins elsewhere than this one ends, or has other bins.
    pub fn merge(&mut self, later: HistogramAccumulator) -> Result<(), MergeError> {
        if later.head.is_empty() {
            return Ok(());
        }
        self.head.accepts(&later.head)?;
        let mut joined = self.clone();
        match later.head.begun() {
            Some(_) => joined.push(later.head.held(), true),
            None => joined.end_stretch(),
        }
        if later.head.ended_inside() {
            joined.end_stretch();
        }
        joined.scale = match (joined.scale, later.scale) {
            (Some(a), Some(b)) if a != b => return Err(MergeError::Settings),
            (a, b) => a.or(b),
        };
        for (count, more) in joined.counts.iter_mut().zip(&later.counts) {
            *count += more;
        }
        joined.below += later.below;
        joined.above += later.above;
        joined.samples += later.samples;
        joined.unused += later.unused;
        joined.blocks += later.blocks;
        // Powers are summed in units of the larger magnitude.
        let unit = |magnitude: f64| if magnitude > 0.0 { magnitude } else { 1.0 };
        let magnitude = joined.magnitude.max(later.magnitude);
        for (k, order) in (2..).enumerate().take(joined.powers.len()) {
            let scaled = |power: f64, of: f64| power * (unit(of) / unit(magnitude)).powi(order);
            joined.powers[k] =
                scaled(joined.powers[k], joined.magnitude) + scaled(later.powers[k], later.magnitude);
        }
        joined.magnitude = magnitude;
        if later.head.is_passed() {
            joined.pending = later.pending;
        }
        joined.head.follow(&later.head);
        *self = joined;
        Ok(())
    }

    /// Takes finite contiguous samples; `continues = false` starts a new stretch.
    pub fn push(&mut self, samples: &[f64], continues: bool) {
        if !continues {
            self.end_stretch();
        }
        let mut rest = self.head.take(samples, continues);
        while !rest.is_empty() {
            let (now, later) = rest.split_at((BLOCK_SAMPLES - self.pending.len()).min(rest.len()));
            self.pending.extend_from_slice(now);
            rest = later;
            if self.pending.len() == BLOCK_SAMPLES {
                self.flush();
            }
        }
    }

    /// The histogram of everything pushed so far.
    pub fn finish(mut self) -> Histogram {
        self.end_stretch();
        let scale = self.scale.unwrap_or(0.0);
        // Each block mean takes one degree of freedom.
        let variance = self.powers[0] / self.samples.saturating_sub(self.blocks).max(1) as f64;
        let n = self.samples.max(1) as f64;
        let (third, fourth) = (self.powers[1] / n, self.powers[2] / n);
        let ratio =
            |moment: f64, power: f64| if variance > 0.0 { moment / variance.powf(power) } else { 0.0 };
        Histogram {
            scale,
            from: -HALF_RANGE * scale,
            bin_width: 2.0 * HALF_RANGE * scale / BIN_COUNT as f64,
            counts: self.counts,
            below: self.below,
            above: self.above,
            samples: self.samples,
            unused_samples: self.unused + self.head.held().len() as u64,
            standard_deviation: scale * self.magnitude.max(1.0) * variance.sqrt(),
            skewness: ratio(third, 1.5),
            excess_kurtosis: if variance > 0.0 { ratio(fourth, 2.0) - 3.0 } else { 0.0 },
        }
    }

    fn end_stretch(&mut self) {
        self.head.end_stretch();
        if self.pending.len() >= MIN_BLOCK {
            self.flush();
        }
        self.unused += self.pending.len() as u64;
        self.pending.clear();
    }

    fn flush(&mut self) {
        let n = self.pending.len() as f64;
        let first = self.pending.first().copied().unwrap_or(0.0);
        // A mean that was rounded to the digits of a large offset would leave a constant behind.
        let rest = self.pending.iter().map(|y| y - first).sum::<f64>() / n;
        self.pending.iter_mut().for_each(|y| *y = (*y - first) - rest);
        if self.scale.is_none() {
            self.scale = robust_scale(&self.pending);
        }
        self.blocks += 1;
        self.samples += self.pending.len() as u64;
        if let Some(scale) = self.scale {
            let inverse = 1.0 / scale;
            let [mut two, mut three, mut four] = [0.0; 3];
            for y in &self.pending {
                let u = y * inverse;
                let square = u * u;
                two += square;
                three += square * u;
                four += square * square;
                let bin = (u + HALF_RANGE) * (BIN_COUNT as f64 / (2.0 * HALF_RANGE));
                if bin < 0.0 {
                    self.below += 1;
                } else if let Some(count) = self.counts.get_mut(bin as usize) {
                    *count += 1;
                } else {
                    self.above += 1;
                }
            }
            if four > MAX_POWER || self.magnitude > 0.0 {
                self.add_far(inverse);
            } else {
                self.powers[0] += two;
                self.powers[1] += three;
                self.powers[2] += four;
            }
        } else if let Some(count) = self.counts.get_mut(BIN_COUNT / 2) {
            // A flat record so far: every deviation is 0.
            *count += self.pending.len() as u64;
        }
        self.pending.clear();
    }
}

impl HistogramAccumulator {
    /// Adds the powers of a block in units of the largest deviation so far.
    fn add_far(&mut self, inverse: f64) {
        let before = if self.magnitude > 0.0 { self.magnitude } else { 1.0 };
        let now = self.pending.iter().fold(before, |m, y| m.max((y * inverse).abs()));
        let shrink = before / now;
        for (power, order) in self.powers.iter_mut().zip(2..) {
            *power *= shrink.powi(order);
            *power += self.pending.iter().map(|y| (y * inverse / now).powi(order)).sum::<f64>();
        }
        self.magnitude = now;
    }
}

/// Median absolute deviation, or the standard deviation where more than half of the values are equal; `None` if flat.
fn robust_scale(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    let middle = sorted.len() / 2;
    let median = *sorted.select_nth_unstable_by(middle, f64::total_cmp).1;
    sorted.iter_mut().for_each(|v| *v = (*v - median).abs());
    let mad = 1.4826 * *sorted.select_nth_unstable_by(middle, f64::total_cmp).1;
    let rms = (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt();
    let magnitude = values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    [mad, rms].into_iter().find(|s| *s > 1e-12 * magnitude && *s > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn gaussian_noise_on_a_drift() {
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(9);
        let y: Vec<f64> = (0..400_000)
            .map(|i| {
                let v: f64 = StandardNormal.sample(&mut rng);
                2.0 * v + 1e-4 * f64::from(i)
            })
            .collect();
        let mut histogram = HistogramAccumulator::new();
        y.chunks(777).enumerate().for_each(|(k, b)| histogram.push(b, k > 0));
        let h = histogram.finish();
        assert!((h.standard_deviation / 2.0 - 1.0).abs() < 0.01, "{h:?}");
        assert!(h.skewness.abs() < 4.0 * (6.0 / 4e5f64).sqrt());
        assert!(h.excess_kurtosis.abs() < 4.0 * (24.0 / 4e5f64).sqrt());
        assert_eq!(h.counts.iter().sum::<u64>() + h.below + h.above, h.samples);
        assert_eq!(h.samples + h.unused_samples, 400_000);
        let bin = |v: f64| ((v - h.from) / h.bin_width) as usize;
        let within: u64 = h.counts[bin(-2.0)..bin(2.0)].iter().sum();
        assert!((within as f64 / h.samples as f64 - 0.6827).abs() < 0.02);
    }

    #[test]
    fn flat_and_short_records() {
        let mut h = HistogramAccumulator::new();
        h.push(&[5.0; 2000], false);
        h.push(&[5.0; 10], false);
        let h = h.finish();
        assert_eq!((h.samples, h.unused_samples, h.scale), (2000, 10, 0.0));
        assert!(h.standard_deviation == 0.0 && h.excess_kurtosis == 0.0);
        assert_eq!(HistogramAccumulator::new().finish().samples, 0);
    }

    #[test]
    fn far_samples_are_counted_outside() {
        let mut y: Vec<f64> = (0..1024).map(|i| f64::from(i % 5) - 2.0).collect();
        y[10] = 1e3;
        y[11] = -1e3;
        let mut h = HistogramAccumulator::new();
        h.push(&y, false);
        let h = h.finish();
        assert_eq!((h.below, h.above), (1, 1));
        assert!(h.excess_kurtosis > 100.0);
    }
}
