//! The bias without and with an influence: what it changes by at every level, and how much that is per unit.

use super::cut::{Cut, cut, span_s};
use super::gls;
use super::intervals::Intervals;
use super::nuisance::{Course, Following, Nuisance, following};
use super::response::{ByMeans, Changes, Courses, Response, by_means};
use super::setup::ComparisonTest;
use crate::estimate::chi_square_tail;
use crate::numeric::reml::{Combination, Fit};
use crate::rate_table::blocks::Blocks;
use nalgebra::{Cholesky, DMatrix, DVector};

/// Gain of twice the log-likelihood from which a scatter between intervals is taken for real: by chance it comes about in
/// one test of ten.
const TAKEN_FROM: f64 = 1.64;

/// One interval of one channel.
#[derive(Debug, Clone, PartialEq)]
pub struct IntervalMean {
    /// Phase, or nothing.
    pub name: String,
    /// Start and end of what was evaluated, s from the start of the recording.
    pub span_s: (f64, f64),
    /// First row.
    pub row: u64,
    /// Level of the axis that the influence acts along, unit of the influence.
    pub level: f64,
    /// That axis; empty where there is only one, and without the influence.
    pub axis: String,
    /// True without the influence.
    pub off: bool,
    /// Mean output, the drift taken out, against the mean without the influence, deg/h.
    pub mean: Combination,
    /// Mean temperature, degC; NaN without one.
    pub temperature: f64,
}

/// What the bias changes by at one level.
#[derive(Debug, Clone, PartialEq)]
pub struct Shift {
    /// Axis; empty where there is only one.
    pub axis: String,
    /// Level.
    pub level: f64,
    /// Change of the bias, deg/h.
    pub change: Combination,
}

/// One channel without and with an influence.
#[derive(Debug, Clone)]
pub struct Comparison {
    /// Channel.
    pub channel: String,
    /// The test as the procedure states it.
    pub test: ComparisonTest,
    /// Axes.
    pub axes: Vec<String>,
    /// Change of the bias per unit of the drive, one an axis.
    pub per_unit: Vec<Combination>,
    /// Change at every level.
    pub shifts: Vec<Shift>,
    /// The intervals.
    pub intervals: Vec<IntervalMean>,
    /// Mean output without the influence, in the middle of those intervals, deg/h.
    pub without: Combination,
    /// Probability of levels so far off the line if it is one; `None` with one level an axis.
    pub line: Option<f64>,
    /// True when a drift proportional to time was taken out.
    pub drift: bool,
    /// True when intervals of one level differ by more than their noise.
    pub scatter: bool,
    /// The delay with which the bias follows the level; `None` where none is seen.
    pub response: Option<Response>,
    /// Per unit of the drive by the plain means of the intervals, one an axis; empty where too few are left over.
    pub by_means: Vec<ByMeans>,
    /// How the temperature of the unit goes with the levels; `None` without one.
    pub temperature: Option<Following>,
    /// How further recorded quantities go with the levels.
    pub others: Vec<Following>,
}

/// The change of N of one channel at one level, whose noise was identified in both states from their own samples.
#[derive(Debug, Clone, PartialEq)]
pub struct NoiseChange {
    /// Channel with axis and level, as rows name it.
    pub channel: String,
    /// N without the influence with its standard uncertainty, deg/sqrt(h); `None` where it is not shown.
    pub without: Option<(f64, f64)>,
    /// The same at the level.
    pub with: Option<(f64, f64)>,
}

/// Channels recorded beside the output and the level.
#[derive(Debug, Clone, Default)]
pub struct Beside {
    /// Temperature of the unit.
    pub temperature: Option<Nuisance>,
    /// Further quantities with their positions beside the blocks.
    pub others: Vec<(usize, Nuisance)>,
}

/// Time of the rows about their middle, from −1 to 1.
fn scaled_time(cut: &Cut) -> DVector<f64> {
    let (n, times) = (cut.rows.len(), &cut.rows.mid_s);
    let middle = times.iter().sum::<f64>() / n as f64;
    let length = times.iter().fold(0.0, |m: f64, t| m.max((t - middle).abs())).max(f64::MIN_POSITIVE);
    DVector::from_fn(n, |i, _| (times[i] - middle) / length)
}

/// A column for every state: 1 in its rows.
fn indicators(states: &States, cut: &Cut) -> Vec<DVector<f64>> {
    let of = |s| DVector::from_fn(cut.rows.len(), |i, _| f64::from(states.of[cut.of[i]] == Some(s)));
    (0..states.list.len()).map(of).collect()
}

/// The drive along an axis in every interval; 0 where it is off.
fn drive_by_interval(
    found: &Intervals,
    states: &States,
    axis: usize,
    drive: &dyn Fn(f64) -> f64,
) -> Vec<f64> {
    let at = |k: usize| if states.is_off(k) { 0.0 } else { drive(found.list[k].levels[axis]) };
    (0..found.list.len()).map(at).collect()
}

/// Evaluates a channel. `None` without an interval of both kinds.
pub fn evaluate(
    blocks: &Blocks,
    found: &Intervals,
    test: &ComparisonTest,
    beside: &Beside,
    gyro: usize,
) -> Option<Comparison> {
    let spans: Vec<(usize, usize)> = found.list.iter().map(|i| i.blocks).collect();
    let cut = cut(blocks, &spans, gyro)?;
    let n = cut.rows.len();
    let states = states(found);
    if states.list.is_empty() || states.of.iter().all(Option::is_some) {
        return None;
    }
    let time = scaled_time(&cut);
    // A drift is told from the influence by what comes back.
    let drift = found.alternations() >= 1;
    let base = |extra: &[DVector<f64>]| {
        let mut columns = vec![DVector::from_element(n, 1.0)];
        columns.extend(drift.then(|| time.clone()));
        let own = columns.len();
        columns.extend(extra.iter().cloned());
        (DMatrix::from_columns(&columns), own)
    };
    let drive = |level: f64| test.influence.drive(level) - test.influence.drive(found.reference);
    let by_axis = drives_by_axis(found, &states, &cut, &drive);
    let used: Vec<usize> = (0..by_axis.len()).filter(|a| by_axis[*a].norm() > 0.0).collect();
    let sizes: Vec<f64> = used.iter().map(|a| by_axis[*a].amax()).collect();
    let scaled: Vec<DVector<f64>> = used.iter().zip(&sizes).map(|(a, s)| &by_axis[*a] / *s).collect();
    let (x, first) = base(&scaled);
    let (line, scatter) = solve(&cut, &states, &x)?;
    let (known, components) = (known(&cut), noise(&cut, &states));
    let of_intervals = used.iter().map(|axis| drive_by_interval(found, &states, *axis, &drive)).collect();
    let changes = Changes::new(blocks, found, test.settling_s, of_intervals);
    let own = levels(&states);
    let courses = Courses { cut: &cut, changes: &changes, known: &known, components: &components, own };
    let response = courses.find(&x);
    let coefficients = |x: &DMatrix<f64>, plain: &Fit| -> Vec<Combination> {
        let settled = response.as_ref().and_then(|r| courses.settled(x, r));
        settled.unwrap_or_else(|| (0..x.ncols()).map(|k| plain.coefficient(k)).collect())
    };
    let of_line = coefficients(&x, &line);
    let per = |all: &[Combination]| -> Vec<Combination> {
        sizes.iter().enumerate().filter_map(|(k, s)| Some(scale(all.get(first + k)?, 1.0 / s))).collect()
    };
    let per_unit = per(&of_line);
    let plain = by_means(&cut, &x, found.list.len()).map_or(vec![], |all| per(&all));
    let by_means = plain.into_iter().zip(&per_unit).map(|(means, model)| ByMeans { means, model: *model });
    let by_means = by_means.collect();
    let (x, first) = base(&indicators(&states, &cut));
    let (each, _) = solve(&cut, &states, &x)?;
    let of_levels = coefficients(&x, &each);
    let shift = |(k, (a, level)): (usize, &(usize, f64))| Shift {
        axis: found.axes[*a].clone(),
        level: *level,
        change: of_levels[first + k],
    };
    let shifts: Vec<Shift> = states.list.iter().enumerate().map(shift).collect();
    let drives: Vec<Vec<f64>> = used
        .iter()
        .map(|u| states.list.iter().map(|(a, l)| if a == u { drive(*l) } else { 0.0 }).collect())
        .collect();
    let course = |values: &[f64], what: &Nuisance| {
        let time = drift.then_some(&time);
        let levels = states.list.len();
        let own = Course { values, of: &cut.of, time, states: &states.of, drives: &drives, levels };
        following(what, &own)
    };
    let others = beside.others.iter().filter_map(|(at, what)| course(cut.beside.get(*at)?, what)).collect();
    let (intervals, without) = means(blocks, found, &states, &cut, drift.then_some(&time))?;
    Some(Comparison {
        channel: blocks.gyros.get(gyro)?.clone(),
        axes: used.iter().map(|a| found.axes[*a].clone()).collect(),
        per_unit,
        line: off_line(&each, first, &drives),
        shifts,
        intervals,
        without,
        drift,
        scatter,
        response,
        by_means,
        temperature: beside.temperature.as_ref().and_then(|what| course(&cut.temperature, what)),
        others,
        test: test.clone(),
    })
}

/// The drive of every row along each axis: 0 without the influence.
fn drives_by_axis(
    found: &Intervals,
    states: &States,
    cut: &Cut,
    drive: &dyn Fn(f64) -> f64,
) -> Vec<DVector<f64>> {
    let of_row = |axis: usize, interval: usize| {
        if states.is_off(interval) { 0.0 } else { drive(found.list[interval].levels[axis]) }
    };
    let of_axis = |axis| DVector::from_fn(cut.rows.len(), |i, _| of_row(axis, cut.of[i]));
    (0..found.axes.len()).map(of_axis).collect()
}

fn scale(c: &Combination, factor: f64) -> Combination {
    Combination { value: c.value * factor, standard: c.standard * factor.abs(), dof: c.dof }
}

/// Levels that differ, by axis, and the one of every interval; `None` without the influence.
struct States {
    list: Vec<(usize, f64)>,
    of: Vec<Option<usize>>,
}

impl States {
    /// True for an interval without the influence.
    fn is_off(&self, interval: usize) -> bool {
        self.of[interval].is_none()
    }
}

fn states(found: &Intervals) -> States {
    let mut groups: Vec<(usize, Vec<f64>)> = Vec::new();
    let mut of = Vec::new();
    for interval in &found.list {
        if found.is_off(interval) {
            of.push(None);
            continue;
        }
        let away = |a: &usize| (interval.levels[*a] - found.reference).abs();
        let axis = (0..interval.levels.len()).max_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or(0);
        let level = interval.levels[axis];
        let same =
            |g: &(usize, Vec<f64>)| g.0 == axis && g.1.iter().any(|l| (l - level).abs() <= found.tolerance);
        let at = groups.iter().position(same).unwrap_or_else(|| {
            groups.push((axis, vec![]));
            groups.len() - 1
        });
        groups[at].1.push(level);
        of.push(Some(at));
    }
    let list = groups.into_iter().map(|(a, l)| (a, l.iter().sum::<f64>() / l.len() as f64)).collect();
    States { list, of }
}

/// White noise of every level apart, since an influence such as vibration makes noise that grows with it, and slow noise
/// common to all.
fn noise(cut: &Cut, states: &States) -> Vec<DMatrix<f64>> {
    let of = |state: Option<usize>| {
        let mut v = cut.rows.white();
        for i in (0..cut.rows.len()).filter(|i| states.of[cut.of[*i]] != state) {
            v[(i, i)] = 0.0;
        }
        v
    };
    let mut components: Vec<DMatrix<f64>> = (0..levels(states)).map(|k| of(k.checked_sub(1))).collect();
    components.extend([cut.rows.angle(), cut.rows.flicker(), cut.rows.random_walk()]);
    components
}

/// How many levels there are, the one without the influence among them.
fn levels(states: &States) -> usize {
    1 + states.list.len()
}

/// A covariance that keeps matrices regular.
fn known(cut: &Cut) -> DMatrix<f64> {
    let n = cut.rows.len();
    DMatrix::identity(n, n) * (1e-9 * cut.y.variance()).max(f64::MIN_POSITIVE)
}

/// Generalised least squares in the noise that is seen, with a scatter between intervals where the test speaks for it.
fn solve(cut: &Cut, states: &States, x: &DMatrix<f64>) -> Option<(Fit, bool)> {
    let (fixed, mut components) = (known(cut), noise(cut, states));
    let own = levels(states);
    let fit = gls::pruned_fit(&cut.y, x, &fixed, &components, own)?;
    if states.of.len() <= x.ncols() {
        return Some((fit, false));
    }
    components.push(cut.rows.shared(&cut.of));
    match gls::pruned_fit(&cut.y, x, &fixed, &components, own) {
        Some(better) if better.twice_log_likelihood > fit.twice_log_likelihood + TAKEN_FROM => {
            Some((better, true))
        }
        _ => Some((fit, false)),
    }
}

/// Mean of every interval against the mean of those without the influence, the drift taken out; and that mean itself.
fn means(
    blocks: &Blocks,
    found: &Intervals,
    states: &States,
    cut: &Cut,
    time: Option<&DVector<f64>>,
) -> Option<(Vec<IntervalMean>, Combination)> {
    let (n, count) = (cut.rows.len(), found.list.len());
    // Time within an interval belongs to the noise here: the drift is taken from the means of those without.
    let x = DMatrix::from_fn(n, count, |i, j| f64::from(cut.of[i] == j));
    let fit = gls::pruned_fit(&cut.y, &x, &known(cut), &noise(cut, states), levels(states))?;
    let middle = |k: usize, v: &dyn Fn(usize) -> f64| {
        let of: Vec<f64> = (0..n).filter(|i| cut.of[*i] == k).map(v).collect();
        of.iter().sum::<f64>() / of.len().max(1) as f64
    };
    let without: Vec<usize> = (0..count).filter(|k| states.is_off(*k)).collect();
    let t: Vec<f64> = (0..count).map(|k| time.map_or(0.0, |time| middle(k, &|i| time[i]))).collect();
    let m = without.len() as f64;
    let t0 = without.iter().map(|k| t[*k]).sum::<f64>() / m;
    let stt: f64 = without.iter().map(|k| (t[*k] - t0).powi(2)).sum();
    let list = found.list.iter().enumerate().map(|(k, interval)| {
        let weights = DVector::from_fn(count, |j, _| {
            let line = if !states.is_off(j) {
                0.0
            } else if stt > 0.0 {
                1.0 / m + (t[k] - t0) * (t[j] - t0) / stt
            } else {
                1.0 / m
            };
            f64::from(j == k) - line
        });
        let away = |a: &usize| (interval.levels[*a] - found.reference).abs();
        let axis = (0..interval.levels.len()).max_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or(0);
        let (first, last) = (&blocks.list[interval.blocks.0], &blocks.list[interval.blocks.1 - 1]);
        IntervalMean {
            name: interval.name.clone(),
            span_s: (span_s(blocks, first).0, span_s(blocks, last).1),
            row: first.first_row,
            level: interval.levels[axis],
            axis: if states.is_off(k) { String::new() } else { found.axes[axis].clone() },
            off: states.is_off(k),
            mean: fit.combine(&weights),
            temperature: middle(k, &|i| cut.temperature[i]),
        }
    });
    let without = fit.combine(&DVector::from_fn(count, |j, _| if states.is_off(j) { 1.0 / m } else { 0.0 }));
    Some((list.collect(), without))
}

/// Probability that levels on a line through zero are so far from one, with the noise of the fit.
fn off_line(each: &Fit, first: usize, drives: &[Vec<f64>]) -> Option<f64> {
    let levels = drives.first()?.len();
    let dof = levels.checked_sub(drives.len()).filter(|d| *d > 0)?;
    let s = each.coefficients.rows(first, levels).into_owned();
    let c = each.covariance.view((first, first), (levels, levels)).into_owned();
    let x = DMatrix::from_fn(levels, drives.len(), |i, j| drives[j][i]);
    let factor = Cholesky::new(c)?;
    let weighted = factor.solve(&x);
    let k = Cholesky::new(x.transpose() * &weighted)?.solve(&(weighted.transpose() * &s));
    let rest = &s - x * k;
    Some(chi_square_tail(rest.dot(&factor.solve(&rest)), dof as f64))
}

/// A level as rows and limits name it: three figures, so that a mean of 0.9998 is the 1 that was set.
pub fn level_name(level: f64) -> String {
    format!("{level:.2e}").parse::<f64>().map_or_else(|_| level.to_string(), |rounded| rounded.to_string())
}

impl Comparison {
    /// The channel with an axis and a level, as rows name it.
    pub fn place(&self, axis: &str, level: Option<f64>) -> String {
        let level = level.map(level_name);
        let parts: Vec<String> =
            [Some(axis.to_owned()).filter(|a| !a.is_empty()), level].into_iter().flatten().collect();
        if parts.is_empty() { self.channel.clone() } else { format!("{}@{}", self.channel, parts.join(":")) }
    }

    /// True where something that was recorded goes with the levels, so that its effect cannot be told from theirs.
    pub fn confounded(&self) -> bool {
        self.too_warm().is_some() || self.others.iter().any(|o| self.disturbs(o))
    }

    /// True where the change after settling is not shown: the bias still followed the level at the end of the intervals, or
    /// the plain means of the intervals contradict the model.
    pub fn unsettled(&self) -> bool {
        match &self.response {
            Some(response) => response.goes_on(),
            None => self.by_means.iter().any(ByMeans::contradicts),
        }
    }

    /// Difference of temperature between the levels where it is more than allowed, degC.
    pub fn too_warm(&self) -> Option<f64> {
        let difference = self.temperature.as_ref()?.difference();
        (difference.abs() > self.test.temperature_difference_deg_c).then_some(difference)
    }

    /// True for a quantity beside that goes with the levels; a temperature by more than allowed.
    fn disturbs(&self, other: &Following) -> bool {
        match other.what.temperature {
            true => other.difference().abs() > self.test.temperature_difference_deg_c,
            false => other.follows(),
        }
    }

    /// The quantities beside that go with the levels.
    pub fn disturbing(&self) -> impl Iterator<Item = &Following> {
        self.others.iter().filter(|o| self.disturbs(o))
    }
}

#[cfg(test)]
mod tests {
    use super::level_name;

    #[test]
    fn levels_are_named_as_they_were_set() {
        let names = [0.9998, 10.0004, -0.50003, 27.5, 0.0, 120_004.0].map(level_name);
        assert_eq!(names, ["1", "10", "-0.5", "27.5", "0", "120000"]);
    }
}
