//! The output without and with an influence: what bias and scale factor change by at every level, and how much that is per unit.

use super::cut::{Cut, cut, span_s, stretches};
use super::gls;
use super::intervals::Intervals;
use super::nuisance::{Course, Following, Nuisance, following};
use super::response::{ByMeans, Changes, Courses, MovesBefore, Response, by_means};
use super::scale_factor::{self, Turning};
use super::setup::{ComparisonTest, Law};
use crate::estimate::chi_square_tail;
use crate::noise::in_band::BandMean;
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

/// What changes by how much at one level.
#[derive(Debug, Clone, PartialEq)]
pub struct Shift {
    /// Axis; empty where there is only one.
    pub axis: String,
    /// Level.
    pub level: f64,
    /// Change, deg/h of the bias and ppm of the scale factor.
    pub change: Combination,
}

/// One term of the law along one axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Term {
    /// Axis; empty where there is only one.
    pub axis: String,
    /// Degree of the level; 0 is that of presence alone.
    pub degree: u8,
    /// False where the axis has fewer levels than the law has terms: then the change holds more than this term.
    pub told_apart: bool,
    /// Change per unit of the drive, deg/h of the bias and ppm of the scale factor.
    pub per_unit: Combination,
}

/// The terms of a law with the changes at the levels.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Effect {
    /// Terms, every axis with all of its own.
    pub terms: Vec<Term>,
    /// Change at every level.
    pub shifts: Vec<Shift>,
    /// Probability of levels so far off the law if it holds; `None` where nothing is left over to tell that.
    pub line: Option<f64>,
}

/// One channel without and with an influence.
#[derive(Debug, Clone)]
pub struct Comparison {
    /// Channel.
    pub channel: String,
    /// The test as the procedure states it.
    pub test: ComparisonTest,
    /// What the bias does.
    pub bias: Effect,
    /// What the scale factor does; `None` without rates of a table.
    pub scale_factor: Option<Effect>,
    /// The intervals.
    pub intervals: Vec<IntervalMean>,
    /// Mean output without the influence, in the middle of those intervals, deg/h.
    pub without: Combination,
    /// True when a drift proportional to time was taken out.
    pub drift: bool,
    /// True when intervals of one level differ by more than their noise.
    pub scatter: bool,
    /// The delay with which the output follows the level; `None` where none is seen.
    pub response: Option<Response>,
    /// How the bias moves before its level; `None` where it does not.
    pub moves_before: Option<MovesBefore>,
    /// Per unit of the drive by the plain means of the stretches, a term each; empty where too few are left over.
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
    /// The noise densities in the bands that the procedure states.
    pub bands: Vec<BandChange>,
}

/// The noise densities of one channel in one band, without and with an influence at one level.
#[derive(Debug, Clone, PartialEq)]
pub struct BandChange {
    /// Channel with axis, level and band, as rows name it.
    pub channel: String,
    /// Mean one-sided density without the influence, (deg/h)²/Hz; `None` where the record does not show the band.
    pub without: Option<BandMean>,
    /// The same at the level.
    pub with: Option<BandMean>,
    /// Lines in the band at the level, which are left out.
    pub lines: usize,
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

/// One term of the law along one axis: its drive in every interval and at every level.
pub(super) struct Drive {
    pub(super) axis: String,
    pub(super) degree: u8,
    pub(super) told_apart: bool,
    pub(super) intervals: Vec<f64>,
    pub(super) levels: Vec<f64>,
    /// Largest of the intervals, that columns of any unit weigh the same.
    pub(super) size: f64,
}

/// The terms along every axis that the influence acted along.
fn drives(found: &Intervals, states: &States, law: Law) -> Vec<Drive> {
    let of_axis = |axis: usize| {
        let levels = states.list.iter().filter(|(a, _)| *a == axis).count();
        let degrees = law.degrees();
        let told_apart = levels >= degrees.len();
        let kept = if told_apart { degrees } else { degrees.get(..1).unwrap_or_default() };
        kept.iter().map(move |degree| (axis, *degree, told_apart))
    };
    let one = |(axis, degree, told_apart): (usize, u8, bool)| {
        let drive = |level: f64| law.drive(degree, level, found.reference);
        let interval = |k: usize| match states.of[k] {
            None => 0.0,
            // Along other axes there is nothing.
            Some(state) if law == Law::OnOff => f64::from(u8::from(states.list[state].0 == axis)),
            Some(_) => drive(found.list[k].levels[axis]),
        };
        let intervals: Vec<f64> = (0..found.list.len()).map(interval).collect();
        let levels = states.list.iter().map(|(a, l)| if *a == axis { drive(*l) } else { 0.0 }).collect();
        let size = intervals.iter().fold(0.0, |m: f64, d| m.max(d.abs()));
        Drive { axis: found.axes[axis].clone(), degree, told_apart, intervals, levels, size }
    };
    (0..found.axes.len()).flat_map(of_axis).map(one).filter(|d| d.size > 0.0).collect()
}

/// The columns of a mean, and where those of the influence begin: first what acts on the bias, then, as many again, what acts on
/// the scale factor where the table turned.
struct Columns {
    x: DMatrix<f64>,
    first: usize,
}

/// What a mean holds whatever the influence does: a constant, a drift, and with a table the output at every rate and a drift of
/// the scale factor.
struct Base<'a> {
    columns: Vec<DVector<f64>>,
    turning: Option<&'a Turning>,
}

impl Base<'_> {
    fn with(&self, own: &[DVector<f64>]) -> Columns {
        let mut columns = self.columns.clone();
        columns.extend(own.iter().cloned());
        if let Some(turning) = self.turning {
            columns.extend(own.iter().map(|c| c.component_mul(&turning.scale)));
        }
        Columns { x: DMatrix::from_columns(&columns), first: self.columns.len() }
    }
}

fn base<'a>(n: usize, time: Option<&DVector<f64>>, turning: Option<&'a Turning>) -> Base<'a> {
    let mut columns = vec![DVector::from_element(n, 1.0)];
    columns.extend(time.cloned());
    if let Some(turning) = turning {
        columns.extend(turning.rates());
        columns.extend(time.map(|t| t.component_mul(&turning.scale)));
    }
    Base { columns, turning }
}

/// What the fits of a channel gave: first of the bias, then of the scale factor.
struct Fitted<'a> {
    found: &'a Intervals,
    states: &'a States,
    drives: &'a [Drive],
    /// Per unit of every drive.
    per_unit: Vec<Combination>,
    /// Coefficients of the fit with a column for every level.
    of_levels: Vec<Combination>,
    each: Fit,
    /// The first column of a level.
    first: usize,
}

impl Fitted<'_> {
    /// Drives at every level.
    fn drives_of_levels(&self) -> Vec<Vec<f64>> {
        self.drives.iter().map(|d| d.levels.clone()).collect()
    }

    /// The effect on the bias, number 0, or on the scale factor, number 1.
    fn effect(&self, law: Law, number: usize) -> Effect {
        let axis = |at: usize| self.found.axes[at].clone();
        let term = |(d, per_unit): (&Drive, &Combination)| Term {
            axis: d.axis.clone(),
            degree: d.degree,
            told_apart: d.told_apart,
            per_unit: *per_unit,
        };
        let first = self.first + number * self.states.list.len();
        let shift = |(k, (a, level)): (usize, &(usize, f64))| {
            Some(Shift { axis: axis(*a), level: *level, change: *self.of_levels.get(first + k)? })
        };
        let per_unit = self.per_unit.iter().skip(number * self.drives.len());
        Effect {
            terms: self.drives.iter().zip(per_unit).map(term).collect(),
            shifts: self.states.list.iter().enumerate().filter_map(shift).collect(),
            line: match law {
                Law::OnOff => None,
                _ => off_line(&self.each, first, &self.drives_of_levels()),
            },
        }
    }
}

/// Evaluates a channel. `None` without an interval of both kinds, or where rates of a table are asked for and none differ.
pub fn evaluate(
    blocks: &Blocks,
    found: &Intervals,
    test: &ComparisonTest,
    beside: &Beside,
    gyro: usize,
) -> Option<Comparison> {
    let states = states(found);
    let drives = drives(found, &states, test.setting.law);
    compare(blocks, found, test, beside, gyro, &Regressed { states, drives })
}

/// Regressors of the output: the levels that differ, and the drives in proportion to the terms of the law.
pub(super) struct Regressed {
    pub(super) states: States,
    pub(super) drives: Vec<Drive>,
}

/// Evaluates a channel against given drives; `None` as [`evaluate`].
pub(super) fn compare(
    blocks: &Blocks,
    found: &Intervals,
    test: &ComparisonTest,
    beside: &Beside,
    gyro: usize,
    Regressed { states, drives }: &Regressed,
) -> Option<Comparison> {
    let (cut, turning) = if test.setting.on_scale_factor {
        let (cut, turning) = scale_factor::cut(blocks, found, test.rate_settling_s, gyro)?;
        (cut, Some(turning))
    } else {
        let spans: Vec<(usize, usize)> = found.list.iter().map(|i| i.blocks).collect();
        (cut(blocks, &spans, gyro)?, None)
    };
    let turning = turning.as_ref();
    let n = cut.rows.len();
    if states.list.is_empty() || states.of.iter().all(Option::is_some) {
        return None;
    }
    let time = scaled_time(&cut);
    // A drift is told from the influence by what comes back.
    let drift = found.alternations() >= 1;
    let time = drift.then_some(&time);
    let base = base(n, time, turning);
    let law = test.setting.law;
    let row = |d: &Drive| DVector::from_fn(n, |i, _| d.intervals[cut.of[i]]) / d.size;
    let by_drive = base.with(&drives.iter().map(row).collect::<Vec<_>>());
    let noise = Noise::new(&cut, states, turning);
    let (line, scatter) = noise.solve(&cut, states, &by_drive.x)?;
    let of_intervals = drives.iter().map(|d| d.intervals.clone()).collect();
    let changes = Changes::new(blocks, found, test.settling_s, of_intervals);
    let courses = Courses {
        cut: &cut,
        changes: &changes,
        known: &noise.known,
        components: &noise.components,
        own: levels(states),
        scale: turning.map(|t| &t.scale),
    };
    let response = courses.find(&by_drive.x);
    let moves_before = courses.moves_before(&by_drive.x);
    let suspected_s = match response {
        Some(_) => vec![],
        None => courses.suspected(&by_drive.x, by_drive.first),
    };
    let coefficients = |x: &DMatrix<f64>, plain: &Fit| -> Vec<Combination> {
        let settled = response.as_ref().and_then(|r| courses.settled(x, r));
        settled.unwrap_or_else(|| courses.widened(x, plain, &suspected_s))
    };
    let of_line = coefficients(&by_drive.x, &line);
    // Of the bias, and behind them of the scale factor.
    let per = |all: &[Combination]| -> Vec<Combination> {
        let sizes = drives.iter().chain(turning.map(|_| drives).into_iter().flatten()).map(|d| d.size);
        sizes.enumerate().filter_map(|(k, s)| Some(scale(all.get(by_drive.first + k)?, 1.0 / s))).collect()
    };
    let per_unit = per(&of_line);
    let plain = by_means(&cut, &by_drive.x).map_or(vec![], |all| per(&all));
    let by_means = plain.into_iter().zip(&per_unit).map(|(means, model)| ByMeans { means, model: *model });
    let by_means = by_means.collect();
    let by_level = base.with(&indicators(states, &cut));
    let (each, _) = noise.solve(&cut, states, &by_level.x)?;
    let of_levels = coefficients(&by_level.x, &each);
    let fitted = Fitted { found, states, drives, per_unit, of_levels, each, first: by_level.first };
    let drives_of_levels = fitted.drives_of_levels();
    let course = |values: &[f64], what: &Nuisance| {
        let levels = states.list.len();
        let own = Course { values, of: &cut.of, time, states: &states.of, drives: &drives_of_levels, levels };
        following(what, &own)
    };
    let others = beside.others.iter().filter_map(|(at, what)| course(cut.beside.get(*at)?, what)).collect();
    let (intervals, without) = means(blocks, found, states, &cut, (time, turning, &noise))?;
    Some(Comparison {
        channel: blocks.gyros.get(gyro)?.clone(),
        bias: fitted.effect(law, 0),
        scale_factor: turning.map(|_| fitted.effect(law, 1)),
        intervals,
        without,
        drift,
        scatter,
        response,
        moves_before,
        by_means,
        temperature: beside.temperature.as_ref().and_then(|what| course(&cut.temperature, what)),
        others,
        test: test.clone(),
    })
}

fn scale(c: &Combination, factor: f64) -> Combination {
    Combination { value: c.value * factor, standard: c.standard * factor.abs(), dof: c.dof }
}

/// Levels that differ, by axis, and the one of every interval; `None` without the influence.
pub(super) struct States {
    pub(super) list: Vec<(usize, f64)>,
    pub(super) of: Vec<Option<usize>>,
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

/// The noise of the rows: white noise of every level apart, since an influence such as vibration makes noise that grows with it,
/// and slow noise common to all.
struct Noise {
    /// A covariance that keeps matrices regular.
    known: DMatrix<f64>,
    components: Vec<DMatrix<f64>>,
    /// Scatter between intervals: of the bias, and of the scale factor where the table turned.
    scatter: Vec<DMatrix<f64>>,
}

/// How many levels there are, the one without the influence among them.
fn levels(states: &States) -> usize {
    1 + states.list.len()
}

impl Noise {
    fn new(cut: &Cut, states: &States, turning: Option<&Turning>) -> Noise {
        let n = cut.rows.len();
        let of = |state: Option<usize>| {
            let mut v = cut.rows.white();
            for i in (0..n).filter(|i| states.of[cut.of[*i]] != state) {
                v[(i, i)] = 0.0;
            }
            v
        };
        let mut components: Vec<DMatrix<f64>> = (0..levels(states)).map(|k| of(k.checked_sub(1))).collect();
        components.extend([cut.rows.angle(), cut.rows.flicker(), cut.rows.random_walk()]);
        let mut scatter = vec![cut.rows.shared(&cut.of)];
        let of_scale = |t: &Turning| scatter[0].component_mul(&(&t.scale * t.scale.transpose()));
        scatter.extend(turning.map(of_scale));
        let known = DMatrix::identity(n, n) * (1e-9 * cut.y.variance()).max(f64::MIN_POSITIVE);
        Noise { known, components, scatter }
    }

    /// Generalised least squares in the noise that is seen, with a scatter between intervals where the test speaks for it.
    fn solve(&self, cut: &Cut, states: &States, x: &DMatrix<f64>) -> Option<(Fit, bool)> {
        let own = levels(states);
        let fit = gls::pruned_fit(&cut.y, x, &self.known, &self.components, own)?;
        // Every stretch has its own mean: more of them than columns tell a scatter between them.
        if stretches(cut) <= x.ncols() {
            return Some((fit, false));
        }
        let mut components = self.components.clone();
        components.extend(self.scatter.iter().cloned());
        match gls::pruned_fit(&cut.y, x, &self.known, &components, own) {
            Some(better) if better.twice_log_likelihood > fit.twice_log_likelihood + TAKEN_FROM => {
                Some((better, true))
            }
            _ => Some((fit, false)),
        }
    }
}

/// Mean of every interval against the mean of those without the influence, the drift taken out; and that mean itself.
fn means(
    blocks: &Blocks,
    found: &Intervals,
    states: &States,
    cut: &Cut,
    (time, turning, noise): (Option<&DVector<f64>>, Option<&Turning>, &Noise),
) -> Option<(Vec<IntervalMean>, Combination)> {
    let (n, count) = (cut.rows.len(), found.list.len());
    // Time within an interval belongs to the noise here: the drift is taken from the means of those without.
    let mut x = DMatrix::from_fn(n, count, |i, j| f64::from(cut.of[i] == j));
    if let Some(turning) = turning {
        let own: Vec<DVector<f64>> = (1..count).map(|j| x.column(j).component_mul(&turning.scale)).collect();
        let columns: Vec<DVector<f64>> = x.column_iter().map(|c| c.into_owned()).collect();
        x = DMatrix::from_columns(&[columns, turning.rates(), own].concat());
    }
    let fit = gls::pruned_fit(&cut.y, &x, &noise.known, &noise.components, levels(states))?;
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
        let weights = DVector::from_fn(x.ncols(), |j, _| {
            let line = if j >= count || !states.is_off(j) {
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
    let of_rest = |j: usize| if j < count && states.is_off(j) { 1.0 / m } else { 0.0 };
    let without = fit.combine(&DVector::from_fn(x.ncols(), |j, _| of_rest(j)));
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
