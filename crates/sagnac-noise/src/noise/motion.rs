//! Whether a channel stood still: noise at rest has no meaning for a record that moves.

use super::data::BlockSeries;
use super::part::{Head, MergeError};
use std::f64::consts::SQRT_2;

/// Scatter of means over 1 s beyond which a unit may have moved: 0.1 deg/s. Slower than any table test, faster than
/// the bias of a gyro that is worth testing wanders.
const MAX_SCATTER_DEG_H: f64 = 360.0;
/// How many times the scatter must exceed what the sample noise explains.
const MIN_NOISE_RATIO: f64 = 5.0;
/// A single mean so far from the middle one tells of a short turn in a long rest.
const MAX_FARTHEST_DEG_H: f64 = 1800.0;
/// Ratio of the steps between neighbouring means to their scatter below which the change is slow.
const MAX_STEP_RATIO: f64 = 0.35;
/// Share of a mean that the rounding of its sum may make up.
const ROUNDING_SHARE: f64 = 1e-12;
/// Range of a temperature that can explain a slow change of the bias, degC.
const MIN_WARMING_DEG_C: f64 = 5.0;

/// Whether a channel stood still.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Motion {
    /// Nothing speaks against rest.
    Rest {
        /// Standard deviation of the means, deg/h.
        scatter_deg_h: f64,
        /// How many times that is what the noise of the samples explains, were it white; 0 where that is not known.
        beyond_noise: f64,
    },
    /// It hardly changed, but another axis of the unit was turned.
    Carried,
    /// It changed slowly by far more than the noise: a slow turn, or the bias with temperature.
    Slow {
        /// Standard deviation of the means, deg/h.
        scatter_deg_h: f64,
    },
    /// It was turned or driven.
    Moved {
        /// Standard deviation of the means, deg/h.
        scatter_deg_h: f64,
        /// Farthest mean from the middle one, deg/h.
        farthest_deg_h: f64,
    },
    /// Too few samples to tell.
    Unknown,
}

impl Motion {
    /// True where nothing speaks against rest.
    pub fn is_rest(&self) -> bool {
        matches!(self, Motion::Rest { .. })
    }

    /// True where the unit was turned, about this axis or another.
    pub fn is_motion(&self) -> bool {
        matches!(self, Motion::Moved { .. } | Motion::Carried)
    }
}

/// Judges the motion by means over 1 s (or an eighth of a shorter record). `sample_noise`: standard deviation of a
/// sample where the record is quietest; `warming`: largest range of a temperature, degC.
pub fn motion(
    blocks: &BlockSeries,
    tau0_s: f64,
    sample_noise_deg_h: Option<f64>,
    warming_deg_c: f64,
) -> Motion {
    let block_s = blocks.block_len.max(1) as f64 * tau0_s;
    let eighth = (blocks.mean.len() / 8).max(1);
    let merged = ((1.0 / block_s).ceil() as usize).clamp(1, eighth);
    let means = means(blocks, merged);
    let Some(Scatter { deviation, of_steps: steps }) = scatter(&means) else { return Motion::Unknown };
    let mut sorted = means.clone();
    let middle = sorted.len() / 2;
    let (_, median, _) = sorted.select_nth_unstable_by(middle, f64::total_cmp);
    let median = *median;
    let farthest = means.iter().map(|m| (m - median).abs()).fold(0.0, f64::max);
    let samples = merged as f64 * blocks.block_len.max(1) as f64;
    let noise = (sample_noise_deg_h.unwrap_or(0.0) / samples.sqrt()).max(ROUNDING_SHARE * median.abs());
    let moved = deviation > MAX_SCATTER_DEG_H.max(MIN_NOISE_RATIO * noise)
        || farthest > MAX_FARTHEST_DEG_H.max(2.0 * MIN_NOISE_RATIO * noise);
    if !moved {
        let known = sample_noise_deg_h.is_some_and(|s| s > 0.0);
        let beyond_noise = if known { deviation / noise } else { 0.0 };
        Motion::Rest { scatter_deg_h: deviation, beyond_noise }
    } else if steps < MAX_STEP_RATIO * deviation && warming_deg_c >= MIN_WARMING_DEG_C {
        Motion::Slow { scatter_deg_h: deviation }
    } else {
        Motion::Moved { scatter_deg_h: deviation, farthest_deg_h: farthest }
    }
}

/// First and last time at which an axis turned, s after the first sample of the recording: where means over 1 s leave the
/// middle one by far more than the noise. `None` where none does.
pub fn turned_from_to(
    blocks: &BlockSeries,
    tau0_s: f64,
    sample_noise_deg_h: Option<f64>,
) -> Option<(f64, f64)> {
    let block_s = blocks.block_len.max(1) as f64 * tau0_s;
    let eighth = (blocks.mean.len() / 8).max(1);
    let merged = ((1.0 / block_s).ceil() as usize).clamp(1, eighth);
    let means: Vec<f64> = blocks
        .mean
        .chunks(merged)
        .map(|of| {
            let finite = of.iter().filter(|m| m.is_finite());
            finite.clone().sum::<f64>() / finite.count() as f64
        })
        .collect();
    let mut sorted: Vec<f64> = means.iter().copied().filter(|m| m.is_finite()).collect();
    let middle = sorted.len() / 2;
    if sorted.is_empty() {
        return None;
    }
    let median = *sorted.select_nth_unstable_by(middle, f64::total_cmp).1;
    let samples = merged as f64 * blocks.block_len.max(1) as f64;
    let noise = sample_noise_deg_h.unwrap_or(0.0) / samples.sqrt();
    let turns = |m: &f64| (m - median).abs() > MAX_SCATTER_DEG_H.max(2.0 * MIN_NOISE_RATIO * noise);
    let (first, last) = (means.iter().position(turns)?, means.iter().rposition(turns)?);
    let at = |index: usize| blocks.first_index as f64 * tau0_s + (index * merged) as f64 * block_s;
    Some((at(first), at(last + 1)))
}

/// The axes of a unit turn together: one that hardly shows it is not at rest either.
pub fn together(mut axes: Vec<&mut Motion>) {
    if axes.iter().any(|m| m.is_motion()) {
        axes.iter_mut().filter(|m| m.is_rest()).for_each(|m| **m = Motion::Carried);
    }
}

/// Means over `merged` blocks that are at least half full.
fn means(blocks: &BlockSeries, merged: usize) -> Vec<f64> {
    let full = blocks.block_len.max(1) as f64 * merged as f64;
    let counts = blocks.count.chunks(merged);
    let sums = blocks.mean.chunks(merged).zip(counts).map(|(means, counts)| {
        means.iter().zip(counts).filter(|(m, _)| m.is_finite()).fold((0.0, 0.0), |(sum, n), (m, c)| {
            let c = f64::from(*c);
            (sum + m * c, n + c)
        })
    });
    sums.filter(|(_, n)| *n >= 0.5 * full).map(|(sum, n)| sum / n).collect()
}

/// How values scatter. The two deviations agree for white values; that of steps is far smaller for slow ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scatter {
    /// Standard deviation, unit of the values.
    pub deviation: f64,
    /// Standard deviation of the steps between neighbours over √2, same unit.
    pub of_steps: f64,
}

/// The scatter of values; `None` for fewer than three.
pub fn scatter(values: &[f64]) -> Option<Scatter> {
    let n = values.len() as f64;
    if values.len() < 3 {
        return None;
    }
    let mean = values.iter().sum::<f64>() / n;
    let deviation = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
    let steps: f64 = values.iter().zip(values.iter().skip(1)).map(|(a, b)| (b - a).powi(2)).sum();
    Some(Scatter { deviation, of_steps: (steps / (n - 1.0)).sqrt() / SQRT_2 })
}

/// Scatter within the quietest window of about 1 s: what the noise is where a record that moves stands still.
#[derive(Debug, Clone)]
pub struct Quietest {
    head: Head,
    length: usize,
    window: Vec<f64>,
    least: Option<f64>,
}

impl Quietest {
    /// An empty track of samples over `tau0_s` s.
    pub fn new(tau0_s: f64) -> Quietest {
        let length = ((1.0 / tau0_s).ceil() as usize).clamp(32, 1 << 20);
        Quietest { head: Head::default(), length, window: Vec::new(), least: None }
    }

    /// The track of a part with `samples_before` samples of its stretch before it, all of them finite.
    pub fn of_part(tau0_s: f64, samples_before: u64) -> Quietest {
        let mut part = Quietest::new(tau0_s);
        let beyond = (samples_before % part.length as u64) as usize;
        part.head = Head::new(samples_before, (part.length - beyond) % part.length);
        part
    }

    /// Adds the next part of the recording; equal to one pass over both.
    ///
    /// # Errors
    /// Where the part begins elsewhere than this one ends, or has other windows.
    pub fn merge(&mut self, later: Quietest) -> Result<(), MergeError> {
        if later.head.is_empty() {
            return Ok(());
        }
        self.head.accepts(&later.head)?;
        if self.length != later.length {
            return Err(MergeError::Settings);
        }
        match later.head.begun() {
            Some(_) => self.push(later.head.held(), true),
            None => self.end_stretch(),
        }
        if later.head.ended_inside() {
            self.end_stretch();
        }
        if later.head.is_passed() {
            self.window = later.window;
        }
        self.least = [self.least, later.least].into_iter().flatten().min_by(f64::total_cmp);
        self.head.follow(&later.head);
        Ok(())
    }

    fn end_stretch(&mut self) {
        self.head.end_stretch();
        self.window.clear();
    }

    /// Takes contiguous samples.
    pub fn push(&mut self, values: &[f64], continues: bool) {
        if !continues {
            self.end_stretch();
        }
        for &v in self.head.take(values, continues) {
            if v.is_finite() {
                self.window.push(v);
            } else {
                self.window.clear();
            }
            if self.window.len() == self.length {
                let n = self.length as f64;
                let mean = self.window.iter().sum::<f64>() / n;
                let variance = self.window.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / (n - 1.0);
                // A window that holds one value says that the output stood, not that it is free of noise.
                if variance > 0.0 {
                    self.least = Some(self.least.map_or(variance, |l| l.min(variance)));
                }
                self.window.clear();
            }
        }
    }

    /// Standard deviation in the quietest window, unit of the values.
    pub fn finish(&self) -> Option<f64> {
        self.least.map(f64::sqrt)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scatter_of_a_ramp_and_of_alternating_values() {
        // 0 … 4: variance 2.5, steps of 1 that count 4/(n − 1).
        let ramp = scatter(&[0.0, 1.0, 2.0, 3.0, 4.0]).unwrap();
        assert!((ramp.deviation - 2.5f64.sqrt()).abs() < 1e-15);
        assert!((ramp.of_steps - 0.5f64.sqrt()).abs() < 1e-15);
        assert_eq!(scatter(&[1.0, 2.0]), None);
    }

    #[test]
    fn the_quietest_window_leaves_out_a_turn_and_an_output_that_stands() {
        let mut quietest = Quietest::new(1.0);
        let alternating = |size: f64| (0..32).map(move |i| if i % 2 == 0 { size } else { -size });
        quietest.push(&alternating(5.0).collect::<Vec<_>>(), false);
        quietest.push(&[7.0; 32], true);
        quietest.push(&alternating(2.0).collect::<Vec<_>>(), true);
        // Σ = 32·4 over n − 1 = 31.
        let expected = (128.0f64 / 31.0).sqrt();
        assert!((quietest.finish().unwrap() - expected).abs() < 1e-12);
    }

    #[test]
    fn a_turn_of_one_axis_carries_the_others() {
        let rest = Motion::Rest { scatter_deg_h: 1.0, beyond_noise: 1.0 };
        let moved = Motion::Moved { scatter_deg_h: 1e4, farthest_deg_h: 1e5 };
        let (mut a, mut b) = (rest, moved);
        together(vec![&mut a, &mut b]);
        assert_eq!((a, b), (Motion::Carried, moved));
        let (mut a, mut b) = (rest, rest);
        together(vec![&mut a, &mut b]);
        assert_eq!((a, b), (rest, rest));
    }

    #[test]
    fn a_record_that_is_turned_is_told_from_one_at_rest() {
        let record = |turned: f64| BlockSeries {
            block_len: 1,
            mean: (0..1000).map(|i| f64::from(i % 3) + if i > 500 { turned } else { 0.0 }).collect(),
            count: vec![1; 1000],
            ..BlockSeries::default()
        };
        assert!(motion(&record(0.0), 1.0, Some(1.0), 0.0).is_rest());
        assert!(motion(&record(1e5), 1.0, Some(1.0), 0.0).is_motion());
        assert_eq!(motion(&BlockSeries::default(), 1.0, None, 0.0), Motion::Unknown);
    }
}
