//! Facts by which the conditions are judged for a gyro that rests in stretches of a recording: runs, intervals without an influence,
//! positions. The same checks are made of them as of a gyro that rests all the time, as far as blocks of its output show it.

use crate::acceptance::condition::GyroFact;
use crate::acceptance::test_kind::Reading;
use crate::noise::tails::{Deviations, Shortening};
use crate::rate_table::blocks::{Block, Blocks};

/// Longest part of a stretch whose values are set against one line, samples.
const LONGEST_BLOCK: usize = 1024;

/// Stretches in which a gyro rests: blocks from the first to before the end.
pub struct Stretches<'a> {
    /// The blocks of the recording.
    pub blocks: &'a Blocks,
    /// The stretches.
    pub spans: Vec<(usize, usize)>,
}

/// Mean output at rest over all stretches.
pub struct RestMean {
    /// Mean, deg/h.
    pub mean_deg_h: f64,
    /// Standard uncertainty of it, deg/h.
    pub uncertainty_deg_h: f64,
    /// Range of the means of the stretches, deg/h.
    pub range_deg_h: f64,
}

/// The range of values; 0 without any.
pub fn range(values: impl Iterator<Item = f64>) -> f64 {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    if high > low { high - low } else { 0.0 }
}

impl Stretches<'_> {
    /// Facts of a channel; `rest` is its mean where the axis lies as the site states it.
    pub fn fact(&self, reading: &Reading<'_>, channel: &str, rest: Option<&RestMean>) -> Option<GyroFact> {
        let (slot, _) = reading.gyros().find(|(_, c)| c.id == channel)?;
        let gyro = self.blocks.gyros.iter().position(|g| g == channel)?;
        let stretches: Vec<&[Block]> =
            self.spans.iter().filter_map(|(from, to)| self.blocks.list.get(*from..*to)).collect();
        let outputs: Vec<Vec<f64>> = stretches.iter().flat_map(|s| without_gaps(s, gyro)).collect();
        let deviations = Deviations::from_lines(outputs.iter().map(Vec::as_slice), LONGEST_BLOCK);
        let samples = stretches.iter().copied().flatten().map(|b| b.samples).max().unwrap_or(1);
        let block_s = f64::from(samples) * self.blocks.interval_s;
        let longest = outputs.iter().map(Vec::len).max().unwrap_or(0);
        let step_deg_h = reading.quantization_step(slot).unwrap_or(0.0);
        // White noise alone makes the deviation at one block; of n differences it is known to √(3/4n), whatever else adds to it.
        let level = |d: &Deviations| d.neighbour_deviation * block_s.sqrt() / 60.0;
        let upper = |d: &Deviations| level(d) * (1.0 + 2.0 * (0.75 / d.samples as f64).sqrt());
        // A mean of several samples has lost what a single one tells of its tails.
        let single = deviations.as_ref().filter(|_| samples == 1);
        let earth = || reading.procedure().site.as_ref().map(|site| site.earth_rate_along(channel));
        Some(GyroFact {
            channel: channel.to_owned(),
            mean_deg_h: rest.map_or(f64::NAN, |r| r.mean_deg_h),
            mean_uncertainty_deg_h: rest.map_or(f64::NAN, |r| r.uncertainty_deg_h),
            earth_deg_h: rest.and_then(|_| earth()).map(|e| (e.value, e.uncertainty)),
            moves_deg_h: rest.map(|r| r.range_deg_h),
            tau0_s: block_s,
            deviations: deviations.iter().map(|d| (block_s, d.neighbour_deviation)).collect(),
            angle_random_walk_high: deviations.as_ref().map(upper),
            longest_stretch_s: longest as f64 * block_s,
            tails: single.and_then(|d| d.tails(&Shortening { periodic: vec![], step_deg_h })),
            ..GyroFact::default()
        })
    }
}

/// Outputs of full blocks, in runs without a gap.
fn without_gaps(stretch: &[Block], gyro: usize) -> Vec<Vec<f64>> {
    let full = stretch.iter().map(|b| b.samples).max().unwrap_or(1);
    let mut runs: Vec<Vec<f64>> = vec![vec![]];
    for block in stretch {
        let output = block.gyro.get(gyro).copied().filter(|v| v.is_finite() && block.samples == full);
        match (output, runs.last_mut()) {
            (Some(v), Some(run)) if block.continues => run.push(v),
            (Some(v), _) => runs.push(vec![v]),
            (None, _) => runs.push(vec![]),
        }
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outputs_are_those_of_full_blocks_between_gaps() {
        let block = |samples, continues, output| Block {
            first_index: 0,
            first_row: 1,
            samples,
            continues,
            gyro: vec![output],
            table_rate: f64::NAN,
            outer_rate: f64::NAN,
            temperature: f64::NAN,
            beside: vec![],
            angle_first: f64::NAN,
            angle_last: f64::NAN,
        };
        let list = [
            block(2, false, 1.0),
            block(2, true, 2.0),
            block(1, true, 9.0),
            block(2, false, 3.0),
            block(2, true, f64::NAN),
            block(2, true, 4.0),
        ];
        let runs: Vec<Vec<f64>> = without_gaps(&list, 0).into_iter().filter(|r| !r.is_empty()).collect();
        assert_eq!(runs, [vec![1.0, 2.0], vec![3.0], vec![4.0]]);
        assert_eq!(range([3.0, 1.0, 2.0].into_iter()), 2.0);
        assert_eq!(range(std::iter::empty()), 0.0);
    }
}
