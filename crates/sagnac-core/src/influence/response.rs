//! A bias that follows the level of an influence with a delay, as behind a first-order lag.
//!
//! A regulator that warms, a shield that saturates slowly: where this takes longer than the settling that is left out, the
//! bias still moves within the intervals. Slow noise would explain it just as well, and the change between levels would come
//! out too small. So the course of the lag is set beside the level, over a range of time constants, before the noise gets its
//! share: `y = … + k·x(t) + a·(z(t) − x(t))`, where z follows the drive x with the time constant and k is the change after it
//! has settled. A lag that shows too little to be told from chance is not taken out, but widens what is stated.
//!
//! A bias that moves before its level does follows nothing: a slow part was taken out of the record by means about each instant.

use super::cut::{Cut, span_s, stretches};
use super::gls;
use super::intervals::Intervals;
use crate::estimate::{Spread, normal_quantile};
use crate::numeric::order::{SortByNumber, SortNumbers};
use crate::numeric::reml::{Combination, Fit};
use crate::rate_table::blocks::Blocks;
use nalgebra::{DMatrix, DVector};

/// Probability by chance, over all time constants, from which a response counts as seen.
const MAX_CHANCE_OF_RESPONSE: f64 = 2e-3;
/// Probability by chance, over all time constants, below which the bias moved before its level.
const MAX_CHANCE_OF_MOVING_BEFORE: f64 = 1e-3;
/// Standard uncertainties of a lag from which it may be there.
const SUSPECTED_FROM: f64 = 1.5;
/// Longest time constant of a lag that may be there, in lengths of the longest interval.
const MAX_SUSPECTED_INTERVALS: f64 = 1.0;
/// Share of a step still to come at the end of an interval up to which the response has ended there.
const MAX_REMAINING_SHARE: f64 = 0.05;
/// Ratio of neighbouring time constants in the search.
const SEARCH_RATIO: f64 = 2.0;
/// Ratio of neighbouring time constants about the best one.
const REFINEMENT_RATIO: f64 = 1.2;
/// Longest time constant, in lengths of the longest interval.
const MAX_TIME_CONSTANT_INTERVALS: f64 = 8.0;
/// Loss of twice the log-likelihood up to which a time constant comes into question with 95 %.
const IN_QUESTION: f64 = 3.84;
/// Coverage of the intervals that two estimates of one change are compared by.
const COMPARED_COVERAGE: f64 = 0.95;

/// A response that was seen.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// Time constant, s.
    pub time_constant_s: f64,
    /// Share of a step that is still to come at the end of the shortest interval.
    pub remaining: f64,
}

impl Response {
    /// True where the response goes on at the end of an interval, so that the settled change is extrapolated.
    pub fn goes_on(&self) -> bool {
        self.remaining > MAX_REMAINING_SHARE
    }

    /// Time after a change of level by which the response has ended, s.
    pub fn waiting_s(&self) -> f64 {
        -MAX_REMAINING_SHARE.ln() * self.time_constant_s
    }
}

/// A bias that moves before its level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovesBefore {
    /// How long before, s: the motion grows by e in this time.
    pub time_s: f64,
    /// Probability of it by chance.
    pub by_chance: f64,
}

/// When the level changed, and to what.
pub struct Changes {
    /// Start of every interval with the settling that is left out, s.
    starts_s: Vec<f64>,
    /// End of every interval, s.
    ends_s: Vec<f64>,
    /// Drive of every interval along each axis that is used.
    drives: Vec<Vec<f64>>,
}

/// The mean as a fit of columns: what does not depend on the time constant, and the lags beside it.
pub struct Courses<'a> {
    /// Rows.
    pub cut: &'a Cut,
    /// When the level changed.
    pub changes: &'a Changes,
    /// Covariance that is known.
    pub known: &'a DMatrix<f64>,
    /// Components of the noise.
    pub components: &'a [DMatrix<f64>],
    /// How many of them are kept however small.
    pub own: usize,
    /// Output per ppm of the scale factor, deg/h, by row; `None` without rates of a table.
    pub scale: Option<&'a DVector<f64>>,
}

/// A fit with lags of one time constant.
struct Tried {
    time_constant_s: f64,
    fit: Fit,
    /// Twice the log-likelihood, comparable between sets of columns of one size.
    twice_log_likelihood: f64,
    /// Probability of so large a share of the lag by chance.
    by_chance: f64,
}

impl Changes {
    /// Of intervals whose settling was left out; `drives` are those of every interval along each axis.
    pub fn new(blocks: &Blocks, found: &Intervals, settling_s: f64, drives: Vec<Vec<f64>>) -> Changes {
        let start = |at: usize| span_s(blocks, &blocks.list[at]).0 - settling_s;
        Changes {
            starts_s: found.list.iter().map(|i| start(i.blocks.0)).collect(),
            ends_s: found.list.iter().map(|i| span_s(blocks, &blocks.list[i.blocks.1 - 1]).1).collect(),
            drives,
        }
    }

    fn lengths(&self) -> impl Iterator<Item = f64> {
        self.starts_s.iter().zip(&self.ends_s).map(|(from, to)| to - from)
    }

    /// Lag behind the drive along one axis, by row. The level of the first interval had been there before.
    fn behind(&self, axis: usize, cut: &Cut, time_constant_s: f64) -> DVector<f64> {
        let drive = &self.drives[axis];
        let mut behind = vec![0.0; drive.len()];
        for k in 1..drive.len() {
            let passed = self.starts_s[k] - self.starts_s[k - 1];
            behind[k] = behind[k - 1] * (-passed / time_constant_s).exp() + drive[k - 1] - drive[k];
        }
        DVector::from_fn(cut.rows.len(), |i, _| {
            let k = cut.of[i];
            let half = 0.5 * cut.rows.length_s[i] / time_constant_s;
            let mean = if half > 1e-6 { half.sinh() / half } else { 1.0 };
            behind[k] * (-(cut.rows.mid_s[i] - self.starts_s[k]) / time_constant_s).exp() * mean
        })
    }

    /// Course ahead of the drive along one axis, by row: the lag of a time that runs backwards.
    fn ahead(&self, axis: usize, cut: &Cut, time_constant_s: f64) -> DVector<f64> {
        let drive = &self.drives[axis];
        let last = drive.len().saturating_sub(1);
        let mut ahead = vec![0.0; drive.len()];
        for k in (0..last).rev() {
            let passed = self.ends_s[k + 1] - self.ends_s[k];
            ahead[k] = ahead[k + 1] * (-passed / time_constant_s).exp() + drive[k + 1] - drive[k];
        }
        DVector::from_fn(cut.rows.len(), |i, _| {
            let k = cut.of[i];
            ahead[k] * (-(self.ends_s[k] - cut.rows.mid_s[i]) / time_constant_s).exp()
        })
    }

    /// Of every axis, what moves anything.
    fn columns(&self, of: impl Fn(usize) -> DVector<f64>) -> Vec<DVector<f64>> {
        (0..self.drives.len()).map(of).filter(|c| c.amax() > 0.0).map(|c| &c / c.amax()).collect()
    }
}

impl Courses<'_> {
    fn tried(&self, x: &DMatrix<f64>, time_constant_s: f64) -> Option<Tried> {
        let lags =
            self.both(self.changes.columns(|axis| self.changes.behind(axis, self.cut, time_constant_s)));
        self.with(x, lags, time_constant_s)
    }

    /// Columns on the bias, and the same on the scale factor where rates of a table show it.
    fn both(&self, mut columns: Vec<DVector<f64>>) -> Vec<DVector<f64>> {
        if let Some(scale) = self.scale {
            let of_scale: Vec<DVector<f64>> = columns.iter().map(|c| c.component_mul(scale)).collect();
            columns.extend(of_scale);
        }
        columns
    }

    /// A fit with further columns of one time constant, with the probability of so large a share of them by chance.
    fn with(&self, x: &DMatrix<f64>, lags: Vec<DVector<f64>>, time_constant_s: f64) -> Option<Tried> {
        let first = x.ncols();
        let mut columns: Vec<DVector<f64>> = x.column_iter().map(|c| c.into_owned()).collect();
        columns.extend(lags);
        if columns.len() == first || columns.len() >= self.cut.rows.len() {
            return None;
        }
        let wide = DMatrix::from_columns(&columns);
        let fit = gls::pruned_fit(&self.cut.y, &wide, self.known, self.components, self.own)?;
        // A restricted likelihood depends on the scale of the columns; without it two sets of one size compare.
        let scale = (wide.transpose() * &wide).cholesky()?.l().diagonal().map(f64::ln).sum();
        let chance = |at: usize| {
            let c = fit.coefficient(at);
            let spread = Spread::StudentT { standard_uncertainty: c.standard, dof: c.dof };
            2.0 * spread.probability_above(0.0, c.value.abs()).unwrap_or(0.5)
        };
        let axes = (columns.len() - first) as f64;
        let by_chance = (first..columns.len()).map(chance).fold(1.0, f64::min) * axes;
        let twice_log_likelihood = fit.twice_log_likelihood + 2.0 * scale;
        Some(Tried { time_constant_s, fit, twice_log_likelihood, by_chance })
    }

    /// Time constants that are tried, up to so many lengths of the longest interval, s.
    fn time_constants(&self, most_intervals: f64) -> Vec<f64> {
        let mut lengths: Vec<f64> = self.cut.rows.length_s.clone();
        lengths.sort_ascending();
        let Some(low) = lengths.get(lengths.len() / 2) else { return vec![] };
        let high = most_intervals * self.changes.lengths().fold(0.0, f64::max);
        let count = ((high / low).ln() / SEARCH_RATIO.ln()).ceil().max(1.0) as i32;
        (0..=count).map(|i| low * SEARCH_RATIO.powi(i)).collect()
    }

    /// Looks for a bias that moves before its level, beside what follows it late.
    pub fn moves_before(&self, x: &DMatrix<f64>) -> Option<MovesBefore> {
        let times = self.time_constants(1.0);
        let all = times.len() as f64;
        let of = |time_s: &f64| {
            let behind = self.changes.columns(|axis| self.changes.behind(axis, self.cut, *time_s));
            let ahead = self.changes.columns(|axis| self.changes.ahead(axis, self.cut, *time_s));
            let mut known: Vec<DVector<f64>> = x.column_iter().map(|c| c.into_owned()).collect();
            known.extend(self.both(behind));
            let found = self.with(&DMatrix::from_columns(&known), self.both(ahead), *time_s)?;
            Some(MovesBefore { time_s: *time_s, by_chance: (found.by_chance * all).min(1.0) })
        };
        let found = times.iter().filter_map(of).min_by(|a, b| a.by_chance.total_cmp(&b.by_chance));
        found.filter(|f| f.by_chance < MAX_CHANCE_OF_MOVING_BEFORE)
    }

    /// Time constants of a lag that may be there though chance explains it, s: those in question of the ones that end within an
    /// interval, where the output still comes nearer to what it settles at; none otherwise. The drives are the columns from
    /// `first` on.
    pub fn suspected(&self, x: &DMatrix<f64>, first: usize) -> Vec<f64> {
        let times = self.time_constants(MAX_SUSPECTED_INTERVALS);
        let mut tried: Vec<Tried> = times.into_iter().filter_map(|t| self.tried(x, t)).collect();
        tried.sort_descending_by(|t| t.twice_log_likelihood);
        let Some(best) = tried.first() else { return vec![] };
        let lags = x.ncols()..best.fit.coefficients.len();
        let may_be = lags.enumerate().any(|(k, at)| {
            let (lag, settled) =
                (best.fit.coefficient(at), best.fit.coefficient((first + k).min(x.ncols() - 1)));
            lag.value.abs() > SUSPECTED_FROM * lag.standard && lag.value * settled.value > 0.0
        });
        let top = best.twice_log_likelihood;
        tried.retain(|t| may_be && top - t.twice_log_likelihood <= IN_QUESTION);
        tried.iter().map(|t| t.time_constant_s).collect()
    }

    /// Coefficients of the columns, each with an interval that holds those of fits with a lag as well.
    pub fn widened(&self, x: &DMatrix<f64>, plain: &Fit, time_constants_s: &[f64]) -> Vec<Combination> {
        let late: Vec<Fit> = time_constants_s.iter().filter_map(|t| Some(self.tried(x, *t)?.fit)).collect();
        let score = normal_quantile(0.5 + 0.5 * COMPARED_COVERAGE);
        let of = |at: usize| {
            let plain = plain.coefficient(at);
            let farthest = |fit: &Fit| {
                let late = fit.coefficient(at);
                (late.value - plain.value).abs() / score + late.standard
            };
            Combination { standard: late.iter().map(farthest).fold(plain.standard, f64::max), ..plain }
        };
        (0..x.ncols()).map(of).collect()
    }

    /// Looks for a response beside the columns of the drive.
    pub fn find(&self, x: &DMatrix<f64>) -> Option<Response> {
        let times = self.time_constants(MAX_TIME_CONSTANT_INTERVALS);
        let tried: Vec<Tried> = times.into_iter().filter_map(|t| self.tried(x, t)).collect();
        let all = tried.len() as f64;
        if !tried.iter().any(|t| t.by_chance * all < MAX_CHANCE_OF_RESPONSE) {
            return None;
        }
        let best = self.refined(x, tried)?;
        let shortest = self.changes.lengths().fold(f64::INFINITY, f64::min);
        let time_constant_s = best.first()?.time_constant_s;
        Some(Response { time_constant_s, remaining: (-shortest / time_constant_s).exp() })
    }

    /// The time constants about the best one that come into question, the best first.
    fn refined(&self, x: &DMatrix<f64>, mut tried: Vec<Tried>) -> Option<Vec<Tried>> {
        let best = |list: &[Tried]| {
            list.iter()
                .max_by(|a, b| a.twice_log_likelihood.total_cmp(&b.twice_log_likelihood))
                .map(|t| t.time_constant_s)
        };
        let middle = best(&tried)?;
        let steps = (SEARCH_RATIO.ln() / REFINEMENT_RATIO.ln()).floor() as i32;
        tried.extend(
            (-steps..=steps)
                .filter(|i| *i != 0)
                .filter_map(|i| self.tried(x, middle * REFINEMENT_RATIO.powi(i))),
        );
        tried.sort_descending_by(|a| a.twice_log_likelihood);
        let top = tried.first()?.twice_log_likelihood;
        tried.retain(|t| top - t.twice_log_likelihood <= IN_QUESTION);
        Some(tried)
    }

    /// Coefficients of the columns with the lag of a response beside them, and with what is not known of its time constant.
    pub fn settled(&self, x: &DMatrix<f64>, response: &Response) -> Option<Vec<Combination>> {
        let list = self.refined(x, vec![self.tried(x, response.time_constant_s)?])?;
        let best = list.first()?;
        let of = |at: usize| {
            let c = best.fit.coefficient(at);
            let values = list.iter().map(|t| t.fit.coefficient(at).value);
            let (low, high) =
                values.fold((c.value, c.value), |(low, high), v| (f64::min(low, v), f64::max(high, v)));
            let half = 0.5 * (high - low) / normal_quantile(0.5 + 0.5 * COMPARED_COVERAGE);
            Combination { standard: c.standard.hypot(half), ..c }
        };
        Some((0..x.ncols()).map(of).collect())
    }
}

/// The change per drive of one term by plain means, which know nothing of the noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ByMeans {
    /// What the interval means give, with the scatter about them.
    pub means: Combination,
    /// What the model of the noise gives.
    pub model: Combination,
}

impl ByMeans {
    /// True where the two differ by more than the intervals of both allow.
    pub fn contradicts(&self) -> bool {
        let half = |c: &Combination| {
            let spread = Spread::StudentT { standard_uncertainty: c.standard, dof: c.dof };
            spread.interval(0.0, COMPARED_COVERAGE).map_or(f64::INFINITY, |i| i.high)
        };
        (self.means.value - self.model.value).abs() > half(&self.means) + half(&self.model)
    }
}

/// Least squares through the plain means of the stretches on the means of the columns; `None` where none are left over.
pub fn by_means(cut: &Cut, x: &DMatrix<f64>) -> Option<Vec<Combination>> {
    let stretches = stretches(cut);
    let dof = stretches.checked_sub(x.ncols()).filter(|d| *d > 0)? as f64;
    let mut weights = vec![0.0; stretches];
    let mut y = DVector::zeros(stretches);
    let mut columns = DMatrix::zeros(stretches, x.ncols());
    for (i, k) in cut.rows.step.iter().enumerate() {
        let weight = cut.rows.length_s[i];
        weights[*k] += weight;
        y[*k] += weight * cut.y[i];
        (0..x.ncols()).for_each(|j| columns[(*k, j)] += weight * x[(i, j)]);
    }
    for (k, weight) in weights.iter().enumerate() {
        y[k] /= weight;
        columns.row_mut(k).scale_mut(1.0 / weight);
    }
    let normal = (columns.transpose() * &columns).cholesky()?;
    let b = normal.solve(&(columns.transpose() * &y));
    let left = (&y - &columns * &b).norm_squared() / dof;
    let inverse = normal.inverse();
    let of = |j: usize| Combination { value: b[j], standard: (left * inverse[(j, j)]).sqrt(), dof };
    Some((0..x.ncols()).map(of).collect())
}
