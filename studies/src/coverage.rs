//! How often intervals hold a truth and how wide they are: what most studies count of a measurand.

use crate::study::{Asked, Row};
use rayon::prelude::*;
use sagnac::estimate::Estimate;

/// Width of a 95 % interval of a normal distribution, in standard deviations.
const WIDTH_95: f64 = 3.919_928;

/// Bounds that are given in place of a value.
#[derive(Debug, Clone, Copy, Default)]
pub struct Bounds {
    /// Bounds given.
    pub given: usize,
    /// Those that hold the truth.
    pub held: usize,
}

/// One measurand over many tests.
#[derive(Debug, Clone, Default)]
pub struct Coverage {
    /// Tests.
    pub runs: usize,
    /// Intervals and bounds that hold the truth.
    pub held: usize,
    /// Errors of the values, in the unit of the measurand.
    pub errors: Vec<f64>,
    /// Widths of the 95 % intervals of these values.
    pub widths: Vec<f64>,
    /// Bounds in place of a value.
    pub bounds: Bounds,
    /// Tests that state nothing.
    pub withheld: usize,
    /// Widths over that of a fit that knows the noise, where there is one.
    pub over_told: Vec<f64>,
}

/// Counts of several measurands over the tests of so many seeds, in the order of the seeds.
pub fn over_seeds<const N: usize>(
    first: u64,
    records: u64,
    test: impl Fn(u64) -> [Coverage; N] + Send + Sync,
) -> [Coverage; N] {
    let all: Vec<[Coverage; N]> = (first..first + records).into_par_iter().map(test).collect();
    let mut sums: [Coverage; N] = std::array::from_fn(|_| Coverage::default());
    for counts in all {
        sums.iter_mut().zip(counts).for_each(|(sum, count)| sum.add(count));
    }
    sums
}

impl Coverage {
    /// One test: its row, the truth, and the standard deviation of a fit that knows the noise.
    pub fn of(row: Option<&Estimate>, truth: f64, told: Option<f64>) -> Coverage {
        let mut count = Coverage::default();
        count.take(row, truth, told);
        count
    }

    /// Counts one test: its row, the truth, and the standard deviation of a fit that knows the noise.
    pub fn take(&mut self, row: Option<&Estimate>, truth: f64, told: Option<f64>) {
        self.runs += 1;
        let stated = row.and_then(|e| Some((e.value?, e.interval95()?)));
        let bound = row.filter(|e| e.value.is_none()).and_then(|e| e.upper_limit);
        match (stated, bound) {
            (Some((value, interval)), _) => {
                let width = interval.high - interval.low;
                self.held += usize::from(interval.low <= truth && truth <= interval.high);
                self.errors.push(value - truth);
                self.widths.push(width);
                self.over_told.extend(told.map(|t| width / (WIDTH_95 * t)));
            }
            (None, Some(bound)) => {
                let holds = usize::from(truth.abs() <= bound.value);
                self.held += holds;
                self.bounds.given += 1;
                self.bounds.held += holds;
            }
            (None, None) => self.withheld += 1,
        }
    }

    /// Adds what another count has.
    pub fn add(&mut self, other: Coverage) {
        self.runs += other.runs;
        self.held += other.held;
        self.errors.extend(other.errors);
        self.widths.extend(other.widths);
        self.bounds.given += other.bounds.given;
        self.bounds.held += other.bounds.held;
        self.withheld += other.withheld;
        self.over_told.extend(other.over_told);
    }

    /// Tests with a value and its interval.
    pub fn stated(&self) -> usize {
        self.errors.len()
    }

    /// Intervals, bounds left out, that hold the truth.
    pub fn inside(&self) -> usize {
        self.held - self.bounds.held
    }

    /// Share of the tests whose interval or bound holds the truth.
    pub fn share(&self) -> f64 {
        self.held as f64 / self.runs as f64
    }

    /// Mean error over its standard deviation, and median width of an interval over the same.
    pub fn shape(&self) -> (f64, f64) {
        let n = self.errors.len() as f64;
        let mean = self.errors.iter().sum::<f64>() / n;
        let deviation = (self.errors.iter().map(|e| (e - mean).powi(2)).sum::<f64>() / n).sqrt();
        (mean / deviation, median(&self.widths) / deviation)
    }

    /// Rows of a study: coverage of intervals and of bounds, how often there is a value, mean and rms error in standard
    /// uncertainties, median widths. `widest` is what is asked of the width over that of a fit that knows the noise.
    pub fn rows(&self, quantity: &str, widest: Asked) -> Vec<Row> {
        let (stated, runs) = (self.stated() as u64, self.runs as u64);
        let share =
            |claim: &str, asked, hits: usize, of: u64| Row::share(quantity, claim, asked, hits as u64, of);
        let number = |claim: &str, asked, value, of| Row::number(quantity, claim, asked, value, of);
        let scores: Vec<f64> = self.errors.iter().zip(&self.widths).map(|(e, w)| e * WIDTH_95 / w).collect();
        let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / scores.len() as f64;
        let mut rows = vec![];
        if stated > 0 || self.bounds.given == 0 {
            rows.push(share(
                "95 % interval holds the truth",
                Asked::Between(0.93, 0.97),
                self.inside(),
                stated,
            ));
        }
        if self.bounds.given > 0 {
            let given = self.bounds.given as u64;
            rows.push(share("the bound holds the truth", Asked::AtLeast(0.93), self.bounds.held, given));
        }
        rows.push(share("a value is stated", Asked::Nothing, self.stated(), runs));
        if scores.is_empty() {
            return rows;
        }
        rows.extend([
            number(
                "mean error in standard uncertainties",
                Asked::Nothing,
                mean(&mut scores.iter().copied()),
                stated,
            ),
            number(
                "rms error in standard uncertainties",
                Asked::Nothing,
                mean(&mut scores.iter().map(|z| z * z)).sqrt(),
                stated,
            ),
            number("median width of the 95 % interval", Asked::Nothing, median(&self.widths), stated),
        ]);
        if !self.over_told.is_empty() {
            let of = self.over_told.len() as u64;
            rows.push(number(
                "median width over that of a fit that knows the noise",
                widest,
                median(&self.over_told),
                of,
            ));
        }
        rows
    }
}

/// The middle value; NaN of none.
pub fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
}
