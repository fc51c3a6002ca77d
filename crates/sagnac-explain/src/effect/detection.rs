//! Searches of single samples: the data that detectors are given, and what they find.

use super::{Column, Drivers, Place, Values};

/// A value that a detector reports.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reported {
    /// Name of the parameter.
    pub name: &'static str,
    /// Unit; empty for a pure number.
    pub unit: &'static str,
    /// Value.
    pub value: f64,
    /// Its 95 % interval.
    pub ci95: [f64; 2],
}

impl Reported {
    /// A value with its interval.
    pub fn new(name: &'static str, unit: &'static str, value: f64, ci95: [f64; 2]) -> Reported {
        Reported { name, unit, value, ci95 }
    }
}

/// Result of a detector.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Detection {
    /// Parameters as reports give them.
    pub reported: Vec<Reported>,
    /// Parameters as a claim states them.
    pub stated: Values,
    /// Intervals in which it shows, principal one first.
    pub places: Vec<Place>,
    /// Gain of log-likelihood over a record without it.
    pub gain: f64,
    /// Parameters that the gain was bought with.
    pub parameters: usize,
    /// Probability of such a gain without it, everything scanned counted.
    pub p_value: f64,
}

impl Detection {
    /// The reported value of a name.
    pub fn reported(&self, name: &str) -> Option<&Reported> {
        self.reported.iter().find(|r| r.name == name)
    }
}

/// The rows of a recording on its grid.
#[derive(Debug, Clone, Copy)]
pub struct Rows<'a> {
    /// Rate, deg/h; interpolated where a row is missing.
    pub rate: &'a [f64],
    /// True where a row is.
    pub present: &'a [bool],
    /// Runs of missing rows: first place on the grid, count.
    pub gaps: &'a [(usize, usize)],
    /// `time_s` of the first place of the grid.
    pub start_s: f64,
    /// Sample interval, s.
    pub dt_s: f64,
}

impl Rows<'_> {
    /// `time_s` of a place on the grid.
    pub fn time_s(&self, row: usize) -> f64 {
        self.start_s + row as f64 * self.dt_s
    }
}

/// Finds an effect in the rows as they were recorded.
pub trait RowDetector: Sync {
    /// The rows concerned, and the effect as they show it; `None` where there is none.
    fn find(&self, rows: &Rows<'_>) -> Option<RowsFound>;
}

/// Rows that an effect concerns.
#[derive(Debug, Clone, PartialEq)]
pub struct RowsFound {
    /// Their places on the grid, ascending.
    pub rows: Vec<usize>,
    /// The effect.
    pub detection: Detection,
}

/// Residual of a fitted hypothesis, in single samples.
pub struct FlatResidual<'a> {
    /// Whitened by the hypothesis.
    pub white: Vec<f64>,
    /// Without the slow course, its own spectrum levelled: what a wrong spectrum or a missing course leaves is not in it.
    pub flat: Vec<f64>,
    /// Deviation in `flat` for 1 deg/h in one sample.
    pub per_deg_h: f64,
    /// Samples at either end that say nothing of single samples.
    pub ends: usize,
    /// True for a sample that is that of a row which counts.
    pub usable: &'a [bool],
    /// The columns.
    pub drivers: &'a Drivers,
    /// Step of the grid of values that the output is rounded to, in the unit of `flat`; 0 where there is none.
    pub rounding_step: f64,
}

impl FlatResidual<'_> {
    /// Steps of rounding, in deviations of a sample, from which values are seen to jump between them.
    pub const COARSE_STEPS: f64 = 2.0;

    /// True for a sample that counts.
    pub fn counts(&self, i: usize) -> bool {
        let inside = i >= self.ends && i + self.ends < self.flat.len();
        inside && self.usable.get(i).copied().unwrap_or(false)
    }
}

/// Groups of samples that do not belong to the noise.
#[derive(Debug, Clone, PartialEq)]
pub struct Outliers {
    /// First sample and length of each, by time.
    pub groups: Vec<(usize, usize)>,
    /// Samples to set aside.
    pub samples: Vec<usize>,
    /// Groups at most that are too small to be found: as many as there are between the smallest that is found and twice
    /// its size, if sizes are no more frequent below it.
    pub missed: usize,
    /// Deviation of the whitened samples set aside; 1 where the noise is as the hypothesis says.
    pub deviation: f64,
    /// Gain of log-likelihood by a deviation of their own, against the level of their neighbourhood.
    pub gain: f64,
    /// Parameters that the gain was bought with.
    pub parameters: usize,
    /// Probability of as much without them, everything scanned counted.
    pub p_value: f64,
}

/// Finds groups of outlying samples.
pub trait OutlierDetector: Sync {
    /// Groups in a residual; `None` where there are none.
    fn find(&self, residual: &FlatResidual<'_>) -> Option<Outliers>;

    /// The effect, from what was taken out of each sample, deg/h, when the groups were set aside.
    fn describe(&self, found: &Outliers, removed: &[f64], drivers: &Drivers) -> Option<Detection>;
}

/// A point of a law that runs in straight lines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Knot {
    /// A time or a value of a column.
    pub at: f64,
    /// Value of the law there.
    pub value: f64,
}

/// Law of the level of the noise.
#[derive(Debug, Clone, PartialEq)]
pub enum Law {
    /// Time: deviation over that of the whole record at `time_s`, with lines between the knots.
    Time(Vec<Knot>),
    /// Size of the input rate: σ² = σ₀² (1 + (ratio² − 1)(|Ω|/max)^exponent).
    Rate {
        /// Deviation at the largest rate over that at zero.
        ratio: f64,
        /// 1 or 2.
        exponent: u8,
    },
    /// Value of a column: deviation over that of the whole record.
    Column(Column, Vec<Knot>),
}

/// A law of the level, fitted to groups of samples and not yet held against single ones.
#[derive(Debug, Clone)]
pub struct LevelLaw {
    /// The law.
    pub law: Law,
    /// Deviation of each sample, in any unit.
    pub profile: Vec<f64>,
    /// Gain of log-likelihood over one level for all groups.
    pub gain: f64,
    /// Independent laws that were tried for it.
    pub trials: f64,
    /// Coefficients that a gain of nothing comes from.
    pub free: usize,
    /// Parameters of the law, what was searched counted.
    pub parameters: usize,
    /// Spread of the groups about the law over what χ² laws give.
    pub dispersion: f64,
    /// Largest deviation over the smallest; for a law of rate that at the largest rate over that at zero.
    pub ratio: f64,
    /// Its 95 % interval.
    pub ci95: [f64; 2],
    /// Interval in which the noise is raised.
    pub place: Place,
}

/// A recording before a hypothesis of its noise and its mean, in cosine modes: what a course of jumps is looked for in.
pub struct Background<'a> {
    /// The columns.
    pub drivers: &'a Drivers,
    /// Modes of what the hypothesis leaves.
    pub modes: Vec<f64>,
    /// Variance of each mode, (deg/h)²; infinite for one that is free.
    pub powers: Vec<f64>,
    /// Modes of the columns of the hypothesis, each with the deviation of its prior.
    pub columns: Vec<(Vec<f64>, f64)>,
    /// Log-likelihood that the noise beside jumps loses against that of the hypothesis in a record without jumps.
    pub lost: f64,
    /// Step of the grid of values that the output is rounded to, as an angle increment, arcsec.
    pub grid_step_arcsec: Option<f64>,
}

/// A course of jumps.
#[derive(Debug, Clone, PartialEq)]
pub struct Jumps {
    /// Expected value of each sample given all, less its mean, deg/h.
    pub course: Vec<f64>,
    /// The effect. Its p-value is the larger of that under the hypothesis and that of its gain over the best single process.
    pub detection: Detection,
    /// Bound of the probability of such a gain under the hypothesis.
    pub chance: f64,
    /// Gain of the best single process in its place.
    pub rival_gain: f64,
    /// False for jumps every few samples, which cannot be distinguished from a short correlated process, and for jumps in equal
    /// intervals, which are a periodic course.
    pub resolved: bool,
    /// For a level that is left much sooner than the other, which is no telegraph: its visits.
    pub pulses: Option<Pulses>,
}

/// Pulses of no kind that recur.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pulses {
    /// Number of pulses.
    pub count: usize,
    /// Mean length, s.
    pub each_s: f64,
}

/// An effect that rounds the output in steps, which the values of a recording show by themselves.
pub trait Rounding: Sync {
    /// The step that a claim states, as an angle increment, arcsec.
    fn step_arcsec(&self, stated: &Values) -> Option<f64>;

    /// The effect, from the step of the values as an angle increment and what their digits leave open of it, arcsec.
    fn detection(&self, step_arcsec: f64, open_arcsec: f64, dt_s: f64) -> Detection;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_count_inside_of_both_ends_where_their_rows_do() {
        let drivers = Drivers::default();
        let usable = [true, true, true, false, true, true, true];
        let residual = FlatResidual {
            white: vec![0.0; 7],
            flat: vec![0.0; 7],
            per_deg_h: 1.0,
            ends: 2,
            usable: &usable,
            drivers: &drivers,
            rounding_step: 0.0,
        };
        let counted: Vec<usize> = (0..9).filter(|i| residual.counts(*i)).collect();
        assert_eq!(counted, [2, 4]);
    }
}
