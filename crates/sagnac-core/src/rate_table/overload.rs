//! The largest rate that the output follows, the level at which it saturates, and the time until it follows again.
//!
//! The line goes through the levels up to half of full scale and is continued beyond: a unit that saturates must not bend the
//! line that it is judged by. A level follows while its output is within a stated part of its rate of that line. What is claimed
//! of a level is claimed at 95 %; that some level does not follow shares its risk among all that could be named.

use super::blocks::Blocks;
use super::scale_factor::ScaleFactor;
use super::setup::Setup;
use super::steps::{Step, TableRun, guide, of_angle};
use crate::estimate::student_quantile;
use crate::numeric::reml::Combination;
use nalgebra::DMatrix;

/// Confidence of what is claimed of a level.
pub const CLAIM_CONFIDENCE: f64 = 0.95;
/// Share of full scale up to which levels give the line.
const LINE_SHARE_OF_FULL_SCALE: f64 = 0.5;
/// Relative difference within which a level is that of its nominal rate.
const NOMINAL_RATE_TOLERANCE: f64 = 1e-4;
/// Part of the slope of the line below which the output does not rise any more.
const MAX_FLAT_SLOPE_SHARE: f64 = 0.02;
/// Time for which the output must follow again, s.
const FOLLOWS_FOR_S: f64 = 1.0;
/// Standard deviations of a block within which it follows beside the stated error.
const BLOCK_NOISE_SIGMAS: f64 = 4.0;

/// What the rates of one sign show.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Side {
    /// Largest rate up to which every level follows, magnitude in deg/h; 0 where none beyond the line does.
    pub follows_to: f64,
    /// Least rate of a level that is shown not to follow, magnitude in deg/h.
    pub fails_from: Option<f64>,
    /// Output where it does not rise any more, deg/h.
    pub saturation: Option<Combination>,
    /// Largest mean output of a level, deg/h, with its sign.
    pub highest_output: f64,
}

/// What rates beyond the range of a unit show of one gyro channel.
#[derive(Debug, Clone, PartialEq)]
pub struct Overload {
    /// Largest rate that the line is drawn through, deg/h.
    pub line_to: f64,
    /// Positive rates; `None` without a level beyond the line.
    pub positive: Option<Side>,
    /// Negative rates.
    pub negative: Option<Side>,
    /// Longest time until the output follows again; `None` where no rate was too high or the recording does not show the return.
    pub recovery: Option<Recovery>,
}

/// Time from the return of a rate into the range until the output follows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recovery {
    /// The time, s.
    pub time_s: f64,
    /// Length of a block, which it is known to, s.
    pub block_s: f64,
    /// True where the angle shows when the table itself was back. A commanded rate is back before the table is, so that the time
    /// contains what the table needs and bounds that of the unit from above.
    pub by_angle: bool,
}

/// Evaluates a channel by its levels; `None` where fewer than three levels give the line.
pub fn evaluate(run: &TableRun, gyro: usize, line: &ScaleFactor, setup: &Setup) -> Option<Overload> {
    let levels = &line.response.levels;
    let line_to = LINE_SHARE_OF_FULL_SCALE * line.full_scale * (1.0 + NOMINAL_RATE_TOLERANCE);
    let inner: Vec<usize> = (0..levels.len()).filter(|i| levels[*i].abs() <= line_to).collect();
    if inner.len() < 3 {
        return None;
    }
    let a = DMatrix::from_fn(inner.len(), 2, |i, j| if j == 0 { 1.0 } else { levels[inner[i]] });
    let solved = (a.transpose() * &a).try_inverse()? * a.transpose();
    let of_line = |constant: f64, rate: f64| {
        let mut weights = vec![0.0; levels.len()];
        for (k, i) in inner.iter().enumerate() {
            weights[*i] = constant * solved[(0, k)] + rate * solved[(1, k)];
        }
        weights
    };
    let slope = line.response.slope + line.response.of_levels(&of_line(0.0, 1.0)).value;
    let offset = line.response.of_levels(&of_line(1.0, 0.0)).value;
    let residual = |level: usize| {
        let mut weights = of_line(-1.0, -levels[level]);
        weights[level] += 1.0;
        line.response.of_levels(&weights)
    };
    let side = |sign: f64| {
        let mut beyond: Vec<usize> = (0..levels.len()).filter(|i| levels[*i] * sign > line_to).collect();
        beyond.sort_by(|a, b| levels[*a].abs().total_cmp(&levels[*b].abs()));
        let allowed = |level: usize| setup.maximum_rate_error * (slope * levels[level]).abs();
        let judged: Vec<(usize, Follows)> =
            beyond.iter().map(|i| (*i, follows(&residual(*i), allowed(*i), beyond.len()))).collect();
        let good = judged.iter().take_while(|(_, f)| *f == Follows::Yes).last();
        let bad: Vec<usize> = judged.iter().filter(|(_, f)| *f == Follows::No).map(|(i, _)| *i).collect();
        let output = |level: usize| slope * levels[level] + offset + residual(level).value;
        let highest =
            beyond.iter().map(|i| output(*i)).reduce(|a, b| if b.abs() > a.abs() { b } else { a })?;
        Some(Side {
            follows_to: good.map_or(0.0, |(i, _)| stated(run, levels[*i])),
            fails_from: bad.first().map(|i| stated(run, levels[*i])),
            saturation: saturation(run, gyro, &bad, levels, &output, slope),
            highest_output: highest,
        })
    };
    let (positive, negative) = (side(1.0), side(-1.0));
    let response = Line { slope, offset, noise: noise_of_block(run, gyro, slope, offset, line_to) };
    let recovery = recovery(run, gyro, &response, setup, [positive, negative]);
    Some(Overload { line_to: LINE_SHARE_OF_FULL_SCALE * line.full_scale, positive, negative, recovery })
}

/// Magnitude of the rate of a level, deg/h: the nominal one where the table was there, since the reading of an angle must not
/// put a level below the limit that it was asked for.
fn stated(run: &TableRun, level: f64) -> f64 {
    let own: Vec<f64> = run
        .steps
        .list
        .iter()
        .filter(|s| near_one_of(s.rate, &[level]))
        .map(|s| s.nominal)
        .filter(|r| r.is_finite())
        .collect();
    let nominal = own.iter().sum::<f64>() / own.len() as f64;
    if (nominal / level - 1.0).abs() <= NOMINAL_RATE_TOLERANCE { nominal.abs() } else { level.abs() }
}

/// Whether the output of a level is within its error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Follows {
    Yes,
    Unclear,
    No,
}

fn follows(residual: &Combination, allowed: f64, levels: usize) -> Follows {
    let quantile = |risk: f64| student_quantile(1.0 - risk, residual.dof) * residual.standard;
    let (risk, off) = (1.0 - CLAIM_CONFIDENCE, residual.value.abs());
    if off + quantile(risk) <= allowed {
        Follows::Yes
    } else if off - quantile(risk / levels.max(1) as f64) > allowed {
        Follows::No
    } else {
        Follows::Unclear
    }
}

/// The output of the highest levels that do not follow, where it does not rise between two of them or more.
fn saturation(
    run: &TableRun,
    gyro: usize,
    bad: &[usize],
    levels: &[f64],
    output: &dyn Fn(usize) -> f64,
    slope: f64,
) -> Option<Combination> {
    let last = *bad.last()?;
    let flat = |level: &&usize| {
        (output(last) - output(**level)).abs()
            <= MAX_FLAT_SLOPE_SHARE * (slope * (levels[last] - levels[**level])).abs()
    };
    let held: Vec<f64> = bad.iter().rev().take_while(flat).map(|i| levels[*i]).collect();
    if held.len() < 2 {
        return None;
    }
    let at = |step: &&Step| run.steps.levels.get(step.level).is_some_and(|own| near_one_of(*own, &held));
    let outputs: Vec<f64> = run
        .steps
        .list
        .iter()
        .filter(at)
        .flat_map(|s| s.parts.iter().filter_map(|p| p.gyro.get(gyro).copied()))
        .filter(|y| y.is_finite())
        .collect();
    let count = outputs.len() as f64;
    if count < 2.0 {
        return None;
    }
    let mean = outputs.iter().sum::<f64>() / count;
    let variance = outputs.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / (count - 1.0);
    Some(Combination { value: mean, standard: (variance / count).sqrt(), dof: count - 1.0 })
}

fn near_one_of(rate: f64, levels: &[f64]) -> bool {
    levels.iter().any(|l| (rate - l).abs() <= 5e-3 * l.abs())
}

/// The line of a channel, with the noise of a block about it, deg/h.
struct Line {
    slope: f64,
    offset: f64,
    noise: f64,
}

/// Standard deviation of a block about the line in steps that it is drawn through, deg/h.
fn noise_of_block(run: &TableRun, gyro: usize, slope: f64, offset: f64, line_to: f64) -> f64 {
    let dt_s = run.blocks.interval_s;
    let mut squares: Vec<f64> = vec![];
    for step in run.steps.list.iter().filter(|s| s.rate.abs() <= line_to) {
        let inside = run.blocks.list.iter().filter(|b| {
            let at_s = b.first_index as f64 * dt_s;
            at_s >= step.from_s && at_s < step.to_s
        });
        let off = inside.filter_map(|b| b.gyro.get(gyro)).map(|y| y - offset - slope * step.rate);
        squares.extend(off.filter(|d| d.is_finite()).map(|d| d * d));
    }
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
}

/// The longest time from where the table is back in the range until the output follows it.
fn recovery(
    run: &TableRun,
    gyro: usize,
    line: &Line,
    setup: &Setup,
    sides: [Option<Side>; 2],
) -> Option<Recovery> {
    let [positive, negative] = sides.map(|side| side.unwrap_or_default());
    let too_fast = |rate: f64| {
        let from = if rate > 0.0 { positive.fails_from } else { negative.fails_from };
        from.is_some_and(|from| rate.abs() >= from * (1.0 - 5e-3))
    };
    let blocks = &run.blocks;
    let by_angle = blocks.has_angle;
    let rates = if by_angle { of_angle(blocks) } else { guide(blocks) };
    let range = positive.follows_to.max(negative.follows_to);
    let allowed = setup.maximum_rate_error * (line.slope * range).abs() + BLOCK_NOISE_SIGMAS * line.noise;
    let start_s = |at: usize| blocks.start_s(at);
    let back = |at: usize| {
        let limit = if rates[at] > 0.0 { positive.follows_to } else { negative.follows_to };
        rates[at].abs() <= limit
    };
    let followed = |at: usize| {
        let output = blocks.list.get(at).and_then(|b| b.gyro.get(gyro));
        output.is_some_and(|y| (y - line.offset - line.slope * rates[at]).abs() <= allowed)
    };
    let of_step = |step: &Step| {
        let first = (0..blocks.list.len()).find(|i| start_s(*i) >= step.to_s && back(*i))?;
        let length_s = block_s(blocks, first);
        let held = ((FOLLOWS_FOR_S / length_s).ceil() as usize).max(1);
        let again =
            (first..blocks.list.len().saturating_sub(held)).find(|i| (*i..i + held).all(&followed))?;
        Some(Recovery { time_s: start_s(again) - start_s(first), block_s: length_s, by_angle })
    };
    let times = run.steps.list.iter().filter(|s| too_fast(s.rate)).filter_map(of_step);
    times.max_by(|a, b| a.time_s.total_cmp(&b.time_s))
}

/// Length of a block, s.
fn block_s(blocks: &Blocks, at: usize) -> f64 {
    blocks.list.get(at).map_or(0.0, |b| f64::from(b.samples) * blocks.interval_s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rate_table::blocks::Block;

    fn combination(value: f64, standard: f64) -> Combination {
        Combination { value, standard, dof: 1e9 }
    }

    #[test]
    fn a_level_follows_or_fails_at_its_confidence() {
        // 1.645 standard deviations at 5 %; 2.576 at 5 % over ten levels.
        for (value, levels, expected) in [
            (8.3, 1, Follows::Yes),
            (8.4, 1, Follows::Unclear),
            (-11.6, 1, Follows::Unclear),
            (-11.7, 1, Follows::No),
            (12.5, 10, Follows::Unclear),
            (12.6, 10, Follows::No),
        ] {
            assert_eq!(follows(&combination(value, 1.0), 10.0, levels), expected, "{value} {levels}");
        }
    }

    /// A table at rates in deg/h for 10 s each, at 10 blocks of a sample a second, and the output of `of` beside it. The table
    /// takes a second from one rate to the next.
    fn run(rates: &[f64], of: &dyn Fn(f64, f64) -> f64) -> TableRun {
        let mut list = vec![];
        let mut last = 0.0;
        for rate in rates {
            for i in 0..110 {
                let table_rate = last + (rate - last) * f64::from(i.min(10)) / 10.0;
                let index = list.len() as u64;
                // Steady, and not exactly so.
                let noise = 0.1 * f64::from((i * 7919) % 13 - 6);
                list.push(Block {
                    first_index: index,
                    first_row: index + 1,
                    samples: 1,
                    continues: index > 0,
                    gyro: vec![of(table_rate, index as f64 * 0.1) + noise],
                    table_rate,
                    outer_rate: f64::NAN,
                    temperature: f64::NAN,
                    beside: vec![],
                    angle_first: f64::NAN,
                    angle_last: f64::NAN,
                });
            }
            last = *rate;
        }
        let blocks =
            Blocks { list, interval_s: 0.1, gyros: vec!["g".into()], has_rate: true, ..Blocks::default() };
        TableRun::new(blocks, &setup())
    }

    /// Steps are evaluated once the output has left its rail.
    fn setup() -> Setup {
        Setup { settling_s: 4.0, maximum_rate_error: 0.01, ..Setup::default() }
    }

    fn found(rates: &[f64], of: &dyn Fn(f64, f64) -> f64) -> Overload {
        let run = run(rates, of);
        let line = crate::rate_table::scale_factor::evaluate(&run, 0, &setup(), &[]).unwrap();
        evaluate(&run, 0, &line, &setup()).unwrap()
    }

    const RATES: [f64; 13] = [0.0, 1e5, 3e5, 5e5, 7e5, 9e5, 1.1e6, 1e5, -3e5, -7e5, -9e5, -1.1e6, 0.0];

    #[test]
    fn a_unit_that_saturates_is_bracketed_by_its_levels() {
        // Positive rates stop at 800,000 deg/h, negative ones never.
        let unit = found(&RATES, &|x, _| (1.02 * x + 50.0).min(8e5));
        let positive = unit.positive.unwrap();
        assert!((positive.follows_to - 7e5).abs() < 1.0 && (positive.fails_from.unwrap() - 9e5).abs() < 1.0);
        let level = positive.saturation.unwrap();
        assert!((level.value - 8e5).abs() < 1.0 && level.standard < 0.5, "{level:?}");
        let negative = unit.negative.unwrap();
        assert!((negative.follows_to - 1.1e6).abs() < 1.0);
        assert_eq!((negative.fails_from, negative.saturation), (None, None));
        assert!((negative.highest_output + 1.02 * 1.1e6 - 50.0).abs() < 10.0);
        // It follows with the first block that is back.
        assert_eq!(unit.recovery.map(|r| (r.time_s, r.by_angle)), Some((0.0, false)));
    }

    #[test]
    fn a_unit_that_stays_at_its_rail_needs_time_to_follow() {
        let rail_until = std::cell::Cell::new(0.0);
        let of = |x: f64, t: f64| {
            if x > 8e5 {
                rail_until.set(t + 3.0);
            }
            if t < rail_until.get() { 8e5 } else { x }
        };
        let unit = found(&RATES, &of);
        let Recovery { time_s, block_s, .. } = unit.recovery.unwrap();
        // Back below 700,000 deg/h some blocks after 800,000, and 3 s at the rail from there.
        assert!((2.5..=3.0).contains(&time_s) && (block_s - 0.1).abs() < 1e-9, "{time_s}");
    }

    #[test]
    fn a_line_needs_three_levels() {
        let run = run(&[0.0, 1e6, -1e6, 0.0], &|x, _| x);
        let line = crate::rate_table::scale_factor::evaluate(&run, 0, &Setup::default(), &[]).unwrap();
        assert_eq!(evaluate(&run, 0, &line, &Setup::default()), None);
    }
}
