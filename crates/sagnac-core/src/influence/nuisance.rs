//! Recorded quantities that go with the levels of an influence: what they do to the bias cannot be told from it.

use crate::estimate::normal_two_sided;
use crate::message::{Arg, Note};
use nalgebra::{Cholesky, DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

/// Probability below which a quantity is taken to go with the levels.
pub const MAX_CHANCE_PROBABILITY: f64 = 1e-3;

/// A recorded quantity that was looked at.
#[derive(Debug, Clone, PartialEq)]
pub struct Nuisance {
    /// Its channel.
    pub channel: String,
    /// Unit that it is read in.
    pub unit: &'static str,
    /// True for a temperature.
    pub temperature: bool,
}

/// How a quantity goes with the levels.
#[derive(Debug, Clone, PartialEq)]
pub struct Following {
    /// Its kind.
    pub what: Nuisance,
    /// Change at every level against none, a steady drift taken out.
    pub shifts: Vec<f64>,
    /// Change per unit of the drive along every axis.
    pub per_drive: Vec<f64>,
    /// Probability of such changes by chance.
    pub by_chance: f64,
}

impl Following {
    /// Largest difference between any two of the levels, the one without among them; signed as the largest change.
    pub fn difference(&self) -> f64 {
        let (low, high) = self.shifts.iter().fold((0.0f64, 0.0f64), |(l, h), s| (l.min(*s), h.max(*s)));
        if -low > high { low - high } else { high - low }
    }

    /// True where it goes with the levels by more than chance.
    pub fn follows(&self) -> bool {
        self.by_chance < MAX_CHANCE_PROBABILITY
    }
}

/// The rows that a quantity is judged by.
pub struct Course<'a> {
    /// Values of the rows.
    pub values: &'a [f64],
    /// Interval of every row.
    pub of: &'a [usize],
    /// Time of every row, any unit; `None` where a drift is not told from the influence.
    pub time: Option<&'a DVector<f64>>,
    /// Level of every interval; `None` without the influence.
    pub states: &'a [Option<usize>],
    /// Drive along every axis, a value a level.
    pub drives: &'a [Vec<f64>],
    /// Number of levels.
    pub levels: usize,
}

/// How a quantity goes with the levels; `None` where it has gaps.
pub fn following(what: &Nuisance, course: &Course<'_>) -> Option<Following> {
    let intervals = course.states.len();
    let middle = |v: &dyn Fn(usize) -> f64, k: usize| {
        let own: Vec<f64> = (0..course.of.len()).filter(|i| course.of[*i] == k).map(v).collect();
        own.iter().sum::<f64>() / own.len().max(1) as f64
    };
    let time = |i: usize| course.time.map_or(0.0, |t| t[i]);
    let means: Vec<f64> = (0..intervals).map(|k| middle(&|i| course.values[i], k)).collect();
    if means.iter().any(|m| !m.is_finite()) {
        return None;
    }
    let of_intervals: Vec<usize> = (0..intervals).collect();
    let times: Vec<f64> = (0..intervals).map(|k| middle(&time, k)).collect();
    let base = 1 + usize::from(course.time.is_some());
    // Means of intervals scatter by all that is slower than an interval; where too few are left to tell that, rows count.
    let few = intervals < base + course.levels + 3;
    let rows: Vec<f64> = (0..course.of.len()).map(time).collect();
    let (y, t, of): (&[f64], &[f64], &[usize]) =
        if few { (course.values, &rows, course.of) } else { (&means, &times, &of_intervals) };
    let n = y.len();
    let column = |j: usize, i: usize| match j {
        0 => 1.0,
        1 if course.time.is_some() => t[i],
        _ => f64::from(course.states[of[i]] == Some(j - base)),
    };
    let y = DVector::from_row_slice(y);
    let plain = solved(&y, &DMatrix::from_fn(n, base, |i, j| column(j, i)))?;
    let full = solved(&y, &DMatrix::from_fn(n, base + course.levels, |i, j| column(j, i)))?;
    let shifts: Vec<f64> = full.0.iter().skip(base).copied().collect();
    let drives = DMatrix::from_fn(course.levels, course.drives.len(), |i, j| course.drives[j][i]);
    let per_drive = solved(&DVector::from_row_slice(&shifts), &drives)?.0.iter().copied().collect();
    let size = y.amax().max(f64::MIN_POSITIVE);
    let by_chance = if plain.1 <= 1e-20 * size * size * n as f64 {
        1.0
    } else {
        chance(plain.1, full.1, course.levels, n.saturating_sub(base + course.levels))
    };
    Some(Following { what: what.clone(), shifts, per_drive, by_chance })
}

/// Coefficients and the sum of squares that is left.
fn solved(y: &DVector<f64>, x: &DMatrix<f64>) -> Option<(DVector<f64>, f64)> {
    let normal = Cholesky::new(x.transpose() * x)?;
    let b = normal.solve(&(x.transpose() * y));
    let left = (y - x * &b).norm_squared();
    Some((b, left))
}

/// Probability that columns without meaning take so much of a sum of squares away.
fn chance(plain: f64, full: f64, columns: usize, dof: usize) -> f64 {
    if dof == 0 || columns == 0 {
        return 1.0;
    }
    if full <= 1e-12 * plain {
        return normal_two_sided(40.0);
    }
    let ratio = ((plain - full) / columns as f64) / (full / dof as f64);
    FisherSnedecor::new(columns as f64, dof as f64).map_or(1.0, |d| d.sf(ratio.max(0.0)))
}

impl Following {
    /// A sentence on it, with its numbers.
    pub fn note(&self, key: &'static str) -> Note {
        let unit = match self.what.unit {
            "deg/h" => Arg::key("compared", "unit_rate"),
            other => Arg::key("unit", other),
        };
        Note::new(key)
            .with("channel", self.what.channel.clone())
            .with("difference", Arg::figures(self.difference().abs(), 3))
            .with("unit", unit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(values: &[f64]) -> Following {
        let what = Nuisance { channel: "temp".into(), unit: "degC", temperature: true };
        let states = [None, Some(0), None, Some(1), None, Some(0), None, Some(1), None];
        let of: Vec<usize> = (0..9).collect();
        let time = DVector::from_fn(9, |i, _| i as f64);
        let drives = [vec![-0.25, 0.25]];
        let course =
            Course { values, of: &of, time: Some(&time), states: &states, drives: &drives, levels: 2 };
        following(&what, &course).unwrap()
    }

    #[test]
    fn what_follows_the_level_and_not_only_its_presence_is_seen() {
        // -4 and +4 in turns, on a drift: an indicator of on and off has a mean of nothing.
        let found = of(&[0.0, -3.9, 0.2, 4.3, 0.4, -3.5, 0.6, 4.7, 0.8]);
        assert!((found.difference().abs() - 8.0).abs() < 1e-9 && found.follows(), "{found:?}");
        assert!((found.per_drive[0] - 16.0).abs() < 1e-9);
    }

    #[test]
    fn what_goes_its_own_way_does_not_follow() {
        let found = of(&[0.0, 0.1, -0.1, 0.05, 0.2, -0.15, 0.02, 0.11, -0.07]);
        assert!(!found.follows(), "{found:?}");
        assert!(!of(&[20.0; 9]).follows());
    }
}
