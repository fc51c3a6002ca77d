//! A recording on the uniform grid that its claim states, with what is missing on it.

use crate::effect::{Column, Rows};
use crate::numeric::cosine::fast_length;
use std::collections::BTreeMap;

/// Rows on a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Regular {
    /// The grid.
    pub grid: Grid,
    /// Rate, deg/h; interpolated where missing.
    pub rate: Vec<f64>,
    /// Other columns, interpolated where rows are missing.
    pub columns: BTreeMap<Column, Vec<f64>>,
}

/// A uniform grid and which of its places rows fill.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Sample interval, s.
    pub dt_s: f64,
    /// `time_s` of the first row.
    pub start_s: f64,
    /// True where a row was.
    pub present: Vec<bool>,
    /// Runs of missing rows, in places of the grid of the recording: first, count.
    pub gaps: Vec<(usize, usize)>,
    /// Samples of the recording that each place averages.
    pub averaged: usize,
    /// Rows whose stamp stands still or falls.
    pub disordered: usize,
}

/// Reason why rows cannot be put on the grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Irregular {
    /// Fewer rows than anything can be said of.
    Short(usize),
    /// The typical interval of the stamps is another than the claim's: observed and claimed, Hz.
    OtherRate(f64, f64),
    /// The stamps span a grid many times longer than the rows fill: rows and places.
    Sparse(usize, f64),
}

/// Rows that are needed for anything to be said.
pub const MIN_ROWS: usize = 64;

impl Grid {
    /// Rows missing inside.
    pub fn missing(&self) -> usize {
        self.gaps.iter().map(|g| g.1).sum()
    }

    /// Places of the grid that want a missing row, ascending.
    pub fn places_in_gaps(&self) -> Vec<usize> {
        let of =
            |(first, count): &(usize, usize)| first / self.averaged..=(first + count - 1) / self.averaged;
        let mut places: Vec<usize> = self.gaps.iter().filter(|g| g.1 > 0).flat_map(of).collect();
        places.dedup();
        places.retain(|i| *i < self.present.len());
        places
    }

    /// The rows as they were recorded, as detectors of missing ones look at them.
    pub fn rows<'a>(&'a self, rate: &'a [f64]) -> Rows<'a> {
        let dt_s = self.dt_s / self.averaged as f64;
        let start_s = self.start_s - 0.5 * (self.averaged - 1) as f64 * dt_s;
        Rows { rate, present: &self.present, gaps: &self.gaps, start_s, dt_s }
    }
}

impl Regular {
    /// The rows as detectors look at them.
    pub fn rows(&self) -> Rows<'_> {
        self.grid.rows(&self.rate)
    }

    /// Puts rows on the grid of `sample_rate_hz`. An interval counts as the nearest whole number of sample intervals, so
    /// that the rounding of stamps and a slow error of the clock do no harm.
    ///
    /// # Errors
    /// [`Irregular`] where rows and grid do not belong together.
    pub fn new(
        time_s: &[f64],
        rate_deg_h: &[f64],
        columns: &BTreeMap<Column, &[f64]>,
        sample_rate_hz: f64,
    ) -> Result<Regular, Irregular> {
        let rows = time_s.len();
        if rows < MIN_ROWS {
            return Err(Irregular::Short(rows));
        }
        let mut steps: Vec<f64> = time_s.windows(2).map(|w| w[1] - w[0]).collect();
        let middle = steps.len() / 2;
        let typical = *steps.select_nth_unstable_by(middle, f64::total_cmp).1;
        let dt_s = 1.0 / sample_rate_hz;
        if !(typical > 0.0 && (typical * sample_rate_hz - 1.0).abs() < 0.05) {
            return Err(Irregular::OtherRate(1.0 / typical, sample_rate_hz));
        }
        let start_s = time_s[0];
        let span = (time_s[rows - 1] - start_s) * sample_rate_hz;
        if span.is_nan() || span >= 4.0 * rows as f64 + 1000.0 {
            return Err(Irregular::Sparse(rows, span));
        }
        let mut places = Vec::with_capacity(rows);
        let (mut place, mut disordered) = (0usize, 0);
        places.push(0);
        let most_ahead = largest_rounding(time_s, sample_rate_hz);
        let mut ahead = 0.0;
        for w in time_s.windows(2) {
            // What rounding took from one interval it gives to the next.
            let exact = (w[1] - w[0]) * sample_rate_hz + ahead;
            let whole = exact.round().max(1.0);
            if w[1] <= w[0] {
                disordered += 1;
            }
            ahead = (exact - whole).clamp(-most_ahead, most_ahead);
            place += whole.min(span + 2.0) as usize;
            places.push(place);
        }
        let n = place + 1;
        let mut present = vec![false; n];
        places.iter().for_each(|p| present[*p] = true);
        let mut gaps = vec![];
        for w in places.windows(2) {
            if w[1] > w[0] + 1 {
                gaps.push((w[0] + 1, w[1] - w[0] - 1));
            }
        }
        let kept = fast_length(n);
        present.truncate(kept);
        let spread = |values: &[f64]| {
            let mut out = spread(values, &places, n);
            out.truncate(kept);
            out
        };
        Ok(Regular {
            grid: Grid { dt_s, start_s, present, gaps, averaged: 1, disordered },
            rate: spread(rate_deg_h),
            columns: columns.iter().map(|(c, v)| (*c, spread(v))).collect(),
        })
    }
}

/// Values at their places, with lines between them.
fn spread(values: &[f64], places: &[usize], n: usize) -> Vec<f64> {
    let mut out = vec![0.0; n];
    for (at, value) in places.iter().zip(values) {
        out[*at] = *value;
    }
    for (at, value) in places.windows(2).zip(values.windows(2)) {
        let steps = at[1] - at[0];
        for j in 1..steps {
            out[at[0] + j] = value[0] + (value[1] - value[0]) * j as f64 / steps as f64;
        }
    }
    out
}

/// Rounding and jitter of stamps that one interval gives to the next, in intervals: the value that 99 of 100 stay below,
/// with half as much again. What accumulates beyond is a clock that runs slower than stated, and no missing row.
fn largest_rounding(time_s: &[f64], sample_rate_hz: f64) -> f64 {
    let off = |w: &[f64]| {
        let step = (w[1] - w[0]) * sample_rate_hz;
        (step - step.round()).abs()
    };
    let mut all: Vec<f64> = time_s.windows(2).map(off).collect();
    let place = all.len() * 99 / 100;
    if all.is_empty() {
        return 0.5;
    }
    (1.5 * *all.select_nth_unstable_by(place, f64::total_cmp).1).min(0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_are_found_behind_the_rounding_of_stamps() {
        // 3 Hz written with two decimals: intervals of 0.33 and 0.34; rows 50 to 52 left out.
        let rows: Vec<usize> = (0..200).filter(|i| !(50..53).contains(i)).collect();
        let time: Vec<f64> = rows.iter().map(|i| (*i as f64 / 3.0 * 100.0).round() / 100.0).collect();
        let rate: Vec<f64> = rows.iter().map(|i| *i as f64).collect();
        let out = Regular::new(&time, &rate, &BTreeMap::new(), 3.0).unwrap();
        assert_eq!(out.rate.len(), 200);
        assert_eq!(out.grid.gaps, vec![(50, 3)]);
        assert_eq!(out.grid.missing(), 3);
        assert!(out.rate.iter().enumerate().all(|(i, v)| (v - i as f64).abs() < 1e-12));
        assert_eq!(out.grid.present.iter().filter(|p| !**p).count(), 3);
    }

    #[test]
    fn a_clock_that_drifts_loses_no_rows() {
        // The interval grows by two per mille in the second half, and jitters by 1 %; one row is lost in the end.
        let mut time = vec![0.0];
        for i in 1..6000 {
            let slow = if i > 3000 { 0.002 } else { 0.0 };
            let jitter = 0.01 * f64::from(i * 7919 % 13) / 12.0;
            let lost = if i == 5500 { 1.0 } else { 0.0 };
            time.push(time[i as usize - 1] + 1.0 + slow + jitter - 0.005 + lost);
        }
        let out = Regular::new(&time, &time, &BTreeMap::new(), 1.0).unwrap();
        assert_eq!(out.grid.gaps, vec![(5500, 1)]);
    }

    #[test]
    fn a_claim_of_another_rate_is_told() {
        let time: Vec<f64> = (0..100).map(f64::from).collect();
        let told = Regular::new(&time, &time, &BTreeMap::new(), 2.0);
        assert_eq!(told, Err(Irregular::OtherRate(1.0, 2.0)));
        assert!(matches!(
            Regular::new(&time[..5], &time[..5], &BTreeMap::new(), 1.0),
            Err(Irregular::Short(5))
        ));
    }
}
