//! Steps of constant rate: found from the channels of the table, cut after a change, trimmed to whole turns.

use super::blocks::{Block, Blocks, TURN_ARCSEC};
use super::settling::{self, Unsettled};
use super::setup::Setup;
use crate::numeric::order::SortByNumber;

/// Parts of all steps together: correlated noise is handled as a matrix over them.
const TOTAL_PARTS: usize = 260;

/// Most parts of one step.
const MOST_PARTS: usize = 12;

/// Part of a step.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Its middle, s from the start of the recording.
    pub mid_s: f64,
    /// Its length, s.
    pub length_s: f64,
    /// Rate of the table, deg/h.
    pub rate: f64,
    /// Rate of the other axis, deg/h.
    pub outer: f64,
    /// Temperature, degC.
    pub temperature: f64,
    /// Output of every gyro channel, deg/h.
    pub gyro: Vec<f64>,
    /// Angle of the table at its start and end, arcsec.
    pub angle: (f64, f64),
}

/// A step: the table turned at one rate.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Start of what is evaluated, s from the start of the recording.
    pub from_s: f64,
    /// Its end.
    pub to_s: f64,
    /// First row.
    pub first_row: u64,
    /// Row after the last.
    pub end_row: u64,
    /// Rate of the table, deg/h, from its angle where that was recorded.
    pub rate: f64,
    /// Rate by which the step was found, deg/h: that of the rate channel where there is one.
    pub nominal: f64,
    /// Rate of the other axis, deg/h.
    pub outer: f64,
    /// Mean temperature, degC.
    pub temperature: f64,
    /// Mean output of every gyro channel, deg/h.
    pub gyro: Vec<f64>,
    /// Turns of the table.
    pub turns: f64,
    /// Its level: steps of one rate share it.
    pub level: usize,
    /// +1 when the rate before was lower, −1 when it was higher, 0 for the first step.
    pub approach: i8,
    /// Its cycle, counted from 0.
    pub cycle: usize,
    /// Its parts.
    pub parts: Vec<Part>,
    /// Where the table was not at its rate yet when the evaluated part begins.
    pub unsettled: Option<Unsettled>,
}

/// The steps of a recording.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Steps {
    /// Steps in order of time.
    pub list: Vec<Step>,
    /// Rates of the levels, deg/h, ascending.
    pub levels: Vec<f64>,
    /// Cycles: how often the sequence of levels was gone through.
    pub cycles: usize,
    /// Stretches of constant rate that were too short to be used.
    pub too_short: usize,
}

impl Steps {
    /// The parts of all steps, each with its step, of which the table's rate and the output of this gyro are known.
    pub fn rows_of(&self, gyro: usize) -> Vec<(usize, &Part)> {
        let parts = self.list.iter().enumerate().flat_map(|(s, step)| step.parts.iter().map(move |p| (s, p)));
        parts.filter(|(_, p)| p.gyro.get(gyro).is_some_and(|g| g.is_finite()) && p.rate.is_finite()).collect()
    }
}

/// The rate by which steps are found, a value a block: that of the rate channel, or the derivative of the angle.
pub(super) fn guide(blocks: &Blocks) -> Vec<f64> {
    if blocks.has_rate {
        return blocks.list.iter().map(|b| b.table_rate).collect();
    }
    of_angle(blocks)
}

/// The rate that the angle of the table shows, a value a block; NaN without an angle.
pub(super) fn of_angle(blocks: &Blocks) -> Vec<f64> {
    let list = &blocks.list;
    (0..list.len())
        .map(|i| {
            let b = &list[i];
            match list.get(i + 1).filter(|next| next.continues) {
                Some(next) => {
                    let span = (next.first_index - b.first_index) as f64 * blocks.interval_s;
                    (next.angle_first - b.angle_first) / span
                }
                None if b.samples > 1 => {
                    (b.angle_last - b.angle_first) / (f64::from(b.samples - 1) * blocks.interval_s)
                }
                None => f64::NAN,
            }
        })
        .collect()
}

/// The median of finite values; 0 of none.
fn median(mut values: Vec<f64>) -> f64 {
    values.retain(|v| v.is_finite());
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Finds the steps.
pub fn find(blocks: &Blocks, setup: &Setup) -> Steps {
    let list = &blocks.list;
    if list.is_empty() {
        return Steps::default();
    }
    let rate = guide(blocks);
    let largest = rate.iter().filter(|r| r.is_finite()).fold(0.0, |m: f64, r| m.max(r.abs()));
    let spans = if setup.rows_are_steps {
        (0..list.len()).map(|i| (i, i + 1)).collect()
    } else {
        spans(blocks, &rate, largest)
    };
    let mut steps = Steps::default();
    let wanted = spans.len().max(1);
    let parts_each = (TOTAL_PARTS / wanted).clamp(1, MOST_PARTS);
    let mut before: Option<f64> = None;
    for (from, to) in spans {
        let nominal = median(rate[from..to].to_vec());
        let outer = median(list[from..to].iter().map(|b| b.outer_rate).collect());
        let approach = before.map_or(0, |b| {
            if nominal > b + 1e-9 * largest {
                1
            } else if nominal < b - 1e-9 * largest {
                -1
            } else {
                0
            }
        });
        before = Some(nominal);
        match step(blocks, setup, (from, to), (nominal, outer), parts_each) {
            Some((first, step)) => {
                let looked = !setup.rows_are_steps && blocks.has_angle;
                let unsettled = looked
                    .then(|| settling::of_step(list, (from, first, to), blocks.interval_s, largest))
                    .flatten();
                steps.list.push(Step { approach, outer, unsettled, ..step });
            }
            None => steps.too_short += 1,
        }
    }
    number_levels(&mut steps, largest);
    number_cycles(&mut steps);
    steps
}

/// Stretches of blocks in which nothing changes, as (first, end).
fn spans(blocks: &Blocks, rate: &[f64], largest: f64) -> Vec<(usize, usize)> {
    let list = &blocks.list;
    let outer: Vec<f64> =
        list.iter().map(|b| if b.outer_rate.is_finite() { b.outer_rate } else { 0.0 }).collect();
    let largest_outer = outer.iter().fold(0.0, |m: f64, r| m.max(r.abs()));
    let noise = |r: &[f64]| {
        let changes = r.windows(2).map(|w| (w[1] - w[0]).abs()).collect();
        // Median of |difference| of white noise is 0.6745·√2 σ.
        median(changes) / 0.954
    };
    let floors = ((6.0 * noise(rate)).max(1e-7 * largest), (6.0 * noise(&outer)).max(1e-7 * largest_outer));
    let mut found = Vec::new();
    let mut start = 0;
    let (mut mean, mut mean_outer, mut count) = (f64::NAN, f64::NAN, 0.0);
    for i in 0..=list.len() {
        let goes_on = i < list.len()
            && i > start
            && list[i].continues
            && (rate[i] - mean).abs() <= floors.0.max(2e-3 * mean.abs())
            && (outer[i] - mean_outer).abs() <= floors.1.max(2e-3 * mean_outer.abs());
        if goes_on {
            count += 1.0;
            mean += (rate[i] - mean) / count;
            mean_outer += (outer[i] - mean_outer) / count;
            continue;
        }
        if i > start + 1 {
            found.push((start, i));
        }
        if i < list.len() {
            (start, mean, mean_outer, count) = (i, rate[i], outer[i], 1.0);
        }
    }
    found
}

/// The step of a stretch, without its settling; `None` when it is too short.
fn step(
    blocks: &Blocks,
    setup: &Setup,
    (from, to): (usize, usize),
    (nominal, outer): (f64, f64),
    parts_each: usize,
) -> Option<(usize, Step)> {
    let list = &blocks.list;
    let dt = blocks.interval_s;
    let begins = list[from].first_index as f64 * dt;
    let (mut first, mut end) = (from, to);
    if !setup.rows_are_steps {
        // The last block may hold the beginning of the next change.
        end = if to - from > 2 { to - 1 } else { to };
        first = (from + 1..end).find(|i| list[*i].first_index as f64 * dt >= begins + setup.settling_s)?;
    }
    let ends = |i: usize| (list[i].first_index + u64::from(list[i].samples)) as f64 * dt;
    let whole = |first: usize, end: usize| ends(end - 1) - list[first].first_index as f64 * dt;
    if whole(first, end) < setup.minimum_step_s {
        return None;
    }
    let turned = |first: usize, end: usize| {
        let length = whole(first, end);
        let rate = rate_of(list, first, end, dt, nominal);
        rate * length / TURN_ARCSEC
    };
    // Whole turns, where one was turned: what comes once a turn averages out.
    let of_outer = (outer * whole(first, end) / TURN_ARCSEC).abs();
    let turns = turned(first, end).abs().max(if of_outer.is_finite() { of_outer } else { 0.0 });
    if setup.whole_turns && turns >= 1.0 {
        let length = whole(first, end) * turns.floor() / turns;
        let start = list[first].first_index as f64 * dt;
        end = (first + 1..=end).min_by(|a, b| {
            let off = |i: usize| (ends(i - 1) - start - length).abs();
            off(*a).total_cmp(&off(*b))
        })?;
    }
    let usable = |b: &&Block| b.gyro.iter().any(|g| g.is_finite());
    let count = (end - first).min(parts_each).max(1);
    let parts: Vec<Part> = (0..count)
        .filter_map(|k| {
            let a = first + (end - first) * k / count;
            let b = first + (end - first) * (k + 1) / count;
            (list[a..b].iter().filter(usable).count() > 0).then(|| part(list, a, b, dt, nominal))
        })
        .collect();
    let last = parts.last()?;
    let total = parts.iter().map(|p| p.length_s).sum::<f64>();
    let gyros = last.gyro.len();
    let mean = |f: &dyn Fn(&Part) -> f64| parts.iter().map(|p| f(p) * p.length_s).sum::<f64>() / total;
    let evaluated = Step {
        from_s: list[first].first_index as f64 * dt,
        to_s: ends(end - 1),
        first_row: list[first].first_row,
        end_row: list[end - 1].first_row + u64::from(list[end - 1].samples),
        rate: rate_of(list, first, end, dt, nominal),
        nominal,
        outer: 0.0,
        temperature: mean(&|p| p.temperature),
        gyro: (0..gyros).map(|g| mean(&|p| p.gyro[g])).collect(),
        turns: turned(first, end),
        level: 0,
        approach: 0,
        cycle: 0,
        parts,
        unsettled: None,
    };
    Some((first, evaluated))
}

/// Mean rate of the table over blocks, deg/h: turned angle over time where the angle was recorded.
fn rate_of(list: &[Block], first: usize, end: usize, dt: f64, nominal: f64) -> f64 {
    let (a, b) = (&list[first], &list[end - 1]);
    // Up to the reading with which the next block begins: neighbours share it, and its error goes out of their sum.
    let (turned, samples) = match list.get(end).filter(|next| next.continues) {
        Some(next) => (next.angle_first - a.angle_first, next.first_index - a.first_index),
        None => {
            let end = b.first_index + u64::from(b.samples);
            (b.angle_last - a.angle_first, end.saturating_sub(a.first_index + 1))
        }
    };
    if turned.is_finite() && samples > 0 {
        // Arc seconds a second are degrees an hour.
        return turned / (samples as f64 * dt);
    }
    let rates = list[first..end].iter().filter(|b| b.table_rate.is_finite());
    let (sum, count) = rates
        .fold((0.0, 0.0), |(s, n), b| (s + b.table_rate * f64::from(b.samples), n + f64::from(b.samples)));
    if count > 0.0 { sum / count } else { nominal }
}

fn part(list: &[Block], first: usize, end: usize, dt: f64, nominal: f64) -> Part {
    let (a, b) = (&list[first], &list[end - 1]);
    let samples: f64 = list[first..end].iter().map(|b| f64::from(b.samples)).sum();
    let from_s = a.first_index as f64 * dt;
    let to_s = (b.first_index + u64::from(b.samples)) as f64 * dt;
    let mean = |f: &dyn Fn(&Block) -> f64| {
        let (sum, n) = list[first..end]
            .iter()
            .filter(|b| f(b).is_finite())
            .fold((0.0, 0.0), |(s, n), b| (s + f(b) * f64::from(b.samples), n + f64::from(b.samples)));
        if n > 0.0 { sum / n } else { f64::NAN }
    };
    let rate = rate_of(list, first, end, dt, nominal);
    Part {
        mid_s: 0.5 * (from_s + to_s),
        length_s: samples * dt,
        rate,
        outer: mean(&|b| b.outer_rate),
        temperature: mean(&|b| b.temperature),
        gyro: (0..a.gyro.len()).map(|g| mean(&|b| b.gyro[g])).collect(),
        angle: (a.angle_first, a.angle_first + rate * (to_s - from_s)),
    }
}

/// Gives steps of one rate one level.
fn number_levels(steps: &mut Steps, largest: f64) {
    let mut order: Vec<usize> = (0..steps.list.len()).collect();
    order.sort_ascending_by(|a| steps.list[*a].nominal);
    let mut levels: Vec<(f64, f64)> = Vec::new();
    for i in order {
        let rate = steps.list[i].nominal;
        match levels.last_mut() {
            Some((sum, n)) if (rate - *sum / *n).abs() <= (3e-3 * rate.abs()).max(1e-5 * largest) => {
                (*sum, *n) = (*sum + rate, *n + 1.0);
            }
            _ => levels.push((rate, 1.0)),
        }
        steps.list[i].level = levels.len() - 1;
    }
    // The true levels are shown by the angle.
    steps.levels = (0..levels.len())
        .map(|l| {
            let of: Vec<f64> = steps.list.iter().filter(|s| s.level == l).map(|s| s.rate).collect();
            of.iter().sum::<f64>() / of.len() as f64
        })
        .collect();
}

/// Counts how often the sequence of levels is gone through: the smallest period of the sequence.
fn number_cycles(steps: &mut Steps) {
    let sequence: Vec<usize> = steps.list.iter().map(|s| s.level).collect();
    let n = sequence.len();
    let distinct = steps.levels.len();
    let period = (distinct.max(1)..=n / 2).find(|p| (0..n - p).all(|i| sequence[i] == sequence[i + p]));
    let period = period.unwrap_or(n.max(1));
    steps.cycles = (n / period).max(1);
    for (i, step) in steps.list.iter_mut().enumerate() {
        step.cycle = (i / period).min(steps.cycles - 1);
    }
}

/// A recording on a table, with what was found in it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TableRun {
    /// The blocks.
    pub blocks: Blocks,
    /// The steps.
    pub steps: Steps,
}

impl TableRun {
    /// Finds the steps of a recording.
    pub fn new(blocks: Blocks, setup: &Setup) -> TableRun {
        let steps = find(&blocks, setup);
        TableRun { blocks, steps }
    }
}
