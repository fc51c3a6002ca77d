//! Stamps coarser than the sample interval, and samples that arrive in packets: rows come in bunches.

use super::nominal::{Cadence, Clock};
use super::refine::refined;
use super::steps::{StampedRow, departure, steps};

/// Share of equal consecutive stamps beyond which the stamps are coarser than the sample interval.
pub(super) const COARSE_SHARE: f64 = 0.05;

/// Bunches over which their beginnings must follow a straight line.
const WINDOW: usize = 16;

/// Least number of bunches from which a clock is found.
const MIN_BUNCHES: usize = 8;

/// Largest departure of the followed interval from that between bunches.
const FOLLOWED: f64 = 0.05;

/// Share of windows that must do so.
const REGULAR: f64 = 0.8;

/// The clock of rows that come in bunches of a regular number; `None` where they do not.
pub(super) fn probe(t: &[f64]) -> Option<Clock> {
    // The mean step where the recording is unbroken: the middle one of many windows.
    let length = (t.len() / 64).clamp(64.min(t.len()), 4096).max(2);
    let mut means: Vec<f64> = t
        .chunks_exact(length)
        .filter_map(|w| Some((w.last()? - w.first()?) / (w.len() - 1) as f64))
        .filter(|m| *m > 0.0)
        .collect();
    let middle = means.len() / 2;
    if means.is_empty() {
        return None;
    }
    let (_, mean, _) = means.select_nth_unstable_by(middle, f64::total_cmp);
    let mean = *mean;
    let small = steps(t).filter(|d| (0.0..=0.2 * mean).contains(d)).count();
    if small as f64 <= COARSE_SHARE * t.len() as f64 || small <= 2 {
        return None;
    }
    let mut large: Vec<f64> = steps(t).filter(|d| *d > mean).collect();
    if large.is_empty() {
        return None;
    }
    let middle = large.len() / 2;
    let (_, period, _) = large.select_nth_unstable_by(middle, f64::total_cmp);
    let period_s = *period;
    // The first bunch may have begun before the recording did.
    let starts: Vec<StampedRow> = (1..t.len())
        .filter_map(|i| {
            let (before, now) = (t.get(i - 1)?, t.get(i)?);
            (now - before > 0.5 * period_s).then_some(StampedRow { row: i as f64, stamp: *now })
        })
        .collect();
    let rows = rows_of_a_bunch(&starts)?;
    if starts.len() < MIN_BUNCHES || rows < 1.5 {
        return None;
    }
    let interval_s = slope(&starts, period_s / rows)?;
    let off =
        |w: &[StampedRow]| departure(&w.iter().map(|s| s.stamp - s.row * interval_s).collect::<Vec<f64>>());
    let window = WINDOW.min(starts.len());
    let windows = starts.chunks_exact(window);
    let count = windows.len();
    let limit = (1.3 * interval_s).max(0.4 * period_s);
    let regular = windows.filter(|w| off(w) <= limit).count();
    if (regular as f64) < REGULAR * count as f64 {
        return None;
    }
    let mut clock = Clock::even(interval_s, 0.0, 1.5 * interval_s);
    clock.cadence = Cadence::Bunched { period_s, rows };
    let clock = refined(clock, t);
    // Followed through the record, the clock stays what its bunches show, or they are none of a regular number.
    ((clock.interval_s / interval_s - 1.0).abs() <= FOLLOWED).then_some(clock)
}

/// Middle number of rows from one bunch to the next, taken as a mean over those within 1 of the median.
fn rows_of_a_bunch(starts: &[StampedRow]) -> Option<f64> {
    let mut counts: Vec<f64> = starts.iter().zip(starts.get(1..)?).map(|(a, b)| b.row - a.row).collect();
    if counts.is_empty() {
        return None;
    }
    let middle = counts.len() / 2;
    let (_, median, _) = counts.select_nth_unstable_by(middle, f64::total_cmp);
    let median = *median;
    let near = |c: &&f64| (**c - median).abs() <= (0.02 * median).max(1.0);
    let (sum, n) = counts.iter().filter(near).fold((0.0, 0.0), |(s, n), c| (s + c, n + 1.0));
    Some(sum / n)
}

/// Middle interval between bunches at a distance, so that single lost rows do not count. It is not positive where the
/// bunches do not advance on the whole.
fn slope(starts: &[StampedRow], guess: f64) -> Option<f64> {
    let lag = (starts.len() / 4).clamp(1, 64);
    let mut slopes: Vec<f64> = starts
        .iter()
        .zip(starts.get(lag..)?)
        .map(|(a, b)| (b.stamp - a.stamp) / (b.row - a.row))
        .filter(|s| s.is_finite())
        .collect();
    if slopes.is_empty() {
        return Some(guess);
    }
    let middle = slopes.len() / 2;
    let (_, median, _) = slopes.select_nth_unstable_by(middle, f64::total_cmp);
    Some(*median)
}
