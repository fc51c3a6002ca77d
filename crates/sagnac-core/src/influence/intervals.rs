//! Intervals without and with an influence: stated, or found from the channels that tell its level.

use super::cut::{FileSpan, find_stated, settled};
use super::setup::{ComparisonTest, Stated};
use crate::numeric::order::SortNumbers;
use crate::rate_table::blocks::Blocks;

/// Share of the range of a level within which it counts as the same.
pub(super) const SAME_LEVEL_SHARE: f64 = 0.03;

/// One interval at constant level.
#[derive(Debug, Clone, PartialEq)]
pub struct Interval {
    /// Phase, or nothing.
    pub name: String,
    /// Its blocks, without the settling.
    pub blocks: (usize, usize),
    /// Level along every axis, unit of the influence.
    pub levels: Vec<f64>,
}

/// The intervals of a recording.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Intervals {
    /// Intervals in the order of the recording.
    pub list: Vec<Interval>,
    /// Names of the axes; one without a name where there is only one.
    pub axes: Vec<String>,
    /// Level that counts as without.
    pub reference: f64,
    /// How near to it counts as it.
    pub tolerance: f64,
    /// Stretches that were too short.
    pub too_short: usize,
    /// Stated intervals that the recording does not hold.
    pub missing: usize,
}

/// Finds the intervals. `axes` names the channels of the level, in the order in which blocks keep them beside.
pub fn find(blocks: &Blocks, test: &ComparisonTest, axes: &[String], files: &[FileSpan]) -> Intervals {
    let mut found =
        if test.intervals.is_empty() { recorded(blocks, axes) } else { stated(blocks, test, files) };
    if found.axes.len() == 1 {
        found.axes = vec![test.setting.name.clone()];
    }
    found.reference = test.reference;
    let largest =
        found.list.iter().flat_map(|i| &i.levels).fold(0.0, |m: f64, l| m.max((l - test.reference).abs()));
    found.tolerance = SAME_LEVEL_SHARE * largest;
    let list = std::mem::take(&mut found.list);
    for interval in list {
        match settled(blocks, interval.blocks, test.settling_s, test.minimum_interval_s) {
            Some(blocks) => found.list.push(Interval { blocks, ..interval }),
            None => found.too_short += 1,
        }
    }
    found
}

fn stated(blocks: &Blocks, test: &ComparisonTest, files: &[FileSpan]) -> Intervals {
    let mut axes: Vec<String> = Vec::new();
    for axis in test.intervals.iter().filter_map(|i| i.axis.clone()) {
        if !axes.contains(&axis) {
            axes.push(axis);
        }
    }
    if axes.len() < 2 {
        axes = vec![String::new()];
    }
    let stretches: Vec<Stated> = test.intervals.iter().map(|i| i.stretch.clone()).collect();
    let list: Vec<Interval> = find_stated(blocks, &stretches, files)
        .into_iter()
        .filter_map(|s| {
            let own = test.intervals.get(s.stated)?;
            let mut levels = vec![test.reference; axes.len()];
            let at = own.axis.as_ref().and_then(|a| axes.iter().position(|x| x == a)).unwrap_or(0);
            *levels.get_mut(at)? = own.level;
            Some((s.stated, Interval { name: s.name, blocks: s.blocks, levels }))
        })
        .map(|(_, interval)| interval)
        .collect();
    let held = |at: usize| {
        let one = stretches.get(at..=at).unwrap_or_default();
        !find_stated(blocks, one, files).is_empty()
    };
    let missing = (0..stretches.len()).filter(|at| !held(*at)).count();
    Intervals { list, axes, missing, ..Intervals::default() }
}

/// Stretches in which the recorded levels stay.
fn recorded(blocks: &Blocks, axes: &[String]) -> Intervals {
    let named = if axes.len() > 1 { axes.to_vec() } else { vec![String::new()] };
    let series: Vec<Vec<f64>> = (0..axes.len())
        .map(|a| blocks.list.iter().map(|b| b.beside.get(a).copied().unwrap_or(f64::NAN)).collect())
        .collect();
    let tolerances: Vec<f64> = series.iter().map(|s| tolerance(s)).collect();
    let mut list = Vec::new();
    let mut start = 0;
    let mut sums = vec![(0.0, 0.0); axes.len()];
    let close = |start: usize, end: usize, sums: &[(f64, f64)], list: &mut Vec<Interval>| {
        let levels: Vec<f64> = sums.iter().map(|(sum, n)| sum / n).collect();
        if end > start && levels.iter().all(|l| l.is_finite()) {
            list.push(Interval { name: String::new(), blocks: (start, end), levels });
        }
    };
    for i in 0..blocks.list.len() {
        let stays = series.iter().zip(&tolerances).zip(&sums).all(|((s, tolerance), (sum, n))| {
            *n == 0.0 || !s[i].is_finite() || (s[i] - sum / n).abs() <= *tolerance
        });
        if !stays {
            close(start, i, &sums, &mut list);
            (start, sums) = (i, vec![(0.0, 0.0); axes.len()]);
        }
        for (s, sum) in series.iter().zip(&mut sums) {
            if s[i].is_finite() {
                *sum = (sum.0 + s[i], sum.1 + 1.0);
            }
        }
    }
    close(start, blocks.list.len(), &sums, &mut list);
    Intervals { list, axes: named, ..Intervals::default() }
}

/// How far a level may stray from its mean.
pub(super) fn tolerance(values: &[f64]) -> f64 {
    let finite: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    let range = finite.iter().fold(f64::NEG_INFINITY, |m, v| m.max(*v))
        - finite.iter().fold(f64::INFINITY, |m, v| m.min(*v));
    let mut changes: Vec<f64> = finite.windows(2).map(|w| (w[1] - w[0]).abs()).collect();
    changes.sort_ascending();
    let median = changes.get(changes.len() / 2).copied().unwrap_or(0.0);
    // Median of |difference| of white noise is 0.6745·√2 σ.
    (6.0 * median / 0.954).max(SAME_LEVEL_SHARE * range)
}

impl Intervals {
    /// True when an interval is one without the influence.
    pub fn is_off(&self, interval: &Interval) -> bool {
        interval.levels.iter().all(|l| (l - self.reference).abs() <= self.tolerance)
    }

    /// Intervals with the influence, neighbours counted once, that stand between two without.
    pub fn alternations(&self) -> usize {
        let mut states: Vec<bool> = self.list.iter().map(|i| self.is_off(i)).collect();
        states.dedup();
        (1..states.len().saturating_sub(1)).filter(|i| !states[*i]).count()
    }

    /// Intervals with the influence.
    pub fn with(&self) -> usize {
        self.list.iter().filter(|i| !self.is_off(i)).count()
    }
}
