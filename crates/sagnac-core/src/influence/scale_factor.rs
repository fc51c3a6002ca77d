//! Rates of a table within intervals at levels: what shows a change of the scale factor beside that of the bias.
//!
//! `y − Ω = b(Ω) + k·x + Ω·s·x + drifts`: the output at every rate has a constant of its own, so that no error of the scale factor
//! and no shape of it counts, and the change s is that between levels at the same rates.

use super::cut::{self, Cut, settled};
use super::intervals::{Intervals, SAME_LEVEL_SHARE, tolerance};
use crate::rate_table::blocks::Blocks;
use nalgebra::DVector;

/// Blocks of a stretch at least.
const MIN_BLOCKS: usize = 10;

/// Stretches of all intervals together: those of an interval beyond its share are left out, so that the time of a fit stays
/// bounded.
const MAX_STRETCHES: usize = 160;

/// Rates that differ from one another, by row.
pub struct Turning {
    /// Output per ppm of the scale factor, deg/h.
    pub scale: DVector<f64>,
    /// The rate of every row, by number.
    group: Vec<usize>,
    /// Number of rates.
    groups: usize,
}

impl Turning {
    /// A column for every rate but the first.
    pub fn rates(&self) -> Vec<DVector<f64>> {
        let of = |g| DVector::from_fn(self.group.len(), |i, _| f64::from(self.group[i] == g));
        (1..self.groups).map(of).collect()
    }
}

/// A stretch at one rate, within one interval.
struct Stretch {
    blocks: (usize, usize),
    interval: usize,
    rate: f64,
}

/// The stretches at a constant rate.
fn found(blocks: &Blocks, intervals: &Intervals, settling_s: f64) -> Vec<Stretch> {
    let rates: Vec<f64> = blocks.list.iter().map(|b| b.table_rate).collect();
    let near = tolerance(&rates);
    let least_s = MIN_BLOCKS as f64 * block_s(blocks);
    let share = (MAX_STRETCHES / intervals.list.len().max(1)).max(2);
    let mut list = vec![];
    for (interval, own) in intervals.list.iter().enumerate() {
        let (mut start, mut sum, mut n) = (own.blocks.0, 0.0, 0.0);
        let before = list.len();
        let mut close = |from: usize, to: usize, rate: f64| {
            if let Some(blocks) = settled(blocks, (from, to), settling_s, least_s) {
                list.push(Stretch { blocks, interval, rate });
            }
        };
        for (at, rate) in rates.iter().enumerate().take(own.blocks.1).skip(own.blocks.0) {
            let rate = *rate;
            if n > 0.0 && (rate - sum / n).abs() > near {
                close(start, at, sum / n);
                (start, sum, n) = (at, 0.0, 0.0);
            }
            if rate.is_finite() {
                (sum, n) = (sum + rate, n + 1.0);
            }
        }
        if n > 0.0 {
            close(start, own.blocks.1, sum / n);
        }
        list.truncate(before + share);
    }
    list
}

/// Longest block, s.
fn block_s(blocks: &Blocks) -> f64 {
    blocks.list.iter().map(|b| f64::from(b.samples)).fold(0.0, f64::max) * blocks.interval_s
}

/// How many rates differ within the intervals.
pub fn rates(blocks: &Blocks, intervals: &Intervals, settling_s: f64) -> usize {
    grouped(&found(blocks, intervals, settling_s)).1
}

/// The rate of every stretch by number, and how many there are.
fn grouped(stretches: &[Stretch]) -> (Vec<usize>, usize) {
    let largest = stretches.iter().fold(0.0, |m: f64, s| m.max(s.rate.abs()));
    let mut known: Vec<f64> = vec![];
    let number = |s: &Stretch| {
        let same = |k: &f64| (k - s.rate).abs() <= SAME_LEVEL_SHARE * largest;
        known.iter().position(same).unwrap_or_else(|| {
            known.push(s.rate);
            known.len() - 1
        })
    };
    let group: Vec<usize> = stretches.iter().map(number).collect();
    (group, known.len())
}

/// Rows of a channel at constant rates, with the rate of the table taken out of the output; `None` where all rates are one, or
/// where one is not known.
pub fn cut(blocks: &Blocks, intervals: &Intervals, settling_s: f64, gyro: usize) -> Option<(Cut, Turning)> {
    let stretches = found(blocks, intervals, settling_s);
    let (group, groups) = grouped(&stretches);
    let every = (0..intervals.list.len()).all(|k| stretches.iter().any(|s| s.interval == k));
    if groups < 2 || !every {
        return None;
    }
    let spans: Vec<(usize, usize)> = stretches.iter().map(|s| s.blocks).collect();
    let mut cut = cut::cut_many(blocks, &spans, gyro)?;
    if cut.table_rate.iter().any(|r| !r.is_finite()) {
        return None;
    }
    let group: Vec<usize> = cut.of.iter().map(|s| group[*s]).collect();
    cut.y -= DVector::from_row_slice(&cut.table_rate);
    // Every mean has the output at each rate as its own column. Without it numbers stay small, whatever the scale factor.
    for g in 0..groups {
        let own: Vec<usize> = (0..group.len()).filter(|i| group[*i] == g).collect();
        let mean = own.iter().map(|i| cut.y[*i]).sum::<f64>() / own.len().max(1) as f64;
        own.iter().for_each(|i| cut.y[*i] -= mean);
    }
    let scale = DVector::from_iterator(cut.table_rate.len(), cut.table_rate.iter().map(|r| r * 1e-6));
    cut.of.iter_mut().for_each(|s| *s = stretches[*s].interval);
    Some((cut, Turning { scale, group, groups }))
}
