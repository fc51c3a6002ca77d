//! The time after switching on that a unit needs: one or two decays in slow noise.
//!
//! The transient itself is judged and not its noise: the time is the last at which it is farther from its final value
//! than the band allows. Two decays are always allowed for: a second one that is not plainly there widens the interval.
//!
//! The time is counted against the mean over the final part of a record, which is no final value where the bias drifts
//! on. The decays are therefore drawn again with a time constant as long as the record among them, and what they have
//! still to go at the end, to where they lead, is held against the band.

use super::gls::{Fitted, Modes};
use super::read::{self, Reading};
use super::sampler::{self, Draw, Range};
use super::start::Start;
use super::stays::{Course, Departure};
use super::test::WarmUpTest;
use super::track::{Means, bridged};
use crate::numeric::optimize::coordinate_ascent;
use nalgebra::DVector;

/// Longest time constants in lengths of the record: of every decay but the slowest, and of the slowest. Two that are both
/// long could cancel over the record and leave its end open; one far longer than the record is a straight line, and where
/// a line leads is a guess.
const MAX_TIME_SHARE: (f64, f64) = (0.35, 1.0);
/// Sweeps over what is not known.
const SETTLED_SWEEPS: usize = 500;
/// Coverage of the one-sided limits on what a transient has still to go.
pub const STATEMENT_PROBABILITY: f64 = 0.95;
/// Times at which a transient is looked at.
const TRANSIENT_TIMES: usize = 400;
/// Blocks at most.
const MAX_BLOCKS: usize = 2048;
/// Logarithm of the ratio of two time constants at least, in the search for the best.
const MIN_LOG_RATIO: f64 = 0.4;
/// Sweeps over what is not known.
const SAMPLER_SWEEPS: usize = 500;

/// The warm-up time of a record, with the transient behind it.
#[derive(Debug, Clone)]
pub struct WarmUpFindings {
    /// The test as the procedure states it.
    pub test: WarmUpTest,
    /// The start, which times count from, as far as it is known.
    pub start: Start,
    /// Time until the transient stays within the band, s.
    pub time: Reading,
    /// True when the transient never left the band.
    pub always_inside: bool,
    /// Transient at the start of the recording, against the final value, deg/h.
    pub transient: Reading,
    /// Time constants of the best fit, s.
    pub time_constants_s: Vec<f64>,
    /// Length of the record, s.
    pub length_s: f64,
    /// Block means: time in s, deg/h.
    pub blocks: Vec<(f64, f64)>,
    /// The transient with the mean of the record, by block.
    pub modelled: Vec<f64>,
    /// Final value on the scale of the record, deg/h.
    pub final_deg_h: f64,
    /// True when the end of the record is not long enough after the transient to show a final value.
    pub too_short: bool,
    /// Remainder of the transient at the end of the record.
    pub settled: Settled,
    /// The bias out of its band again after the transient, by running means.
    pub departure: Option<Departure>,
    /// Time over which the output was smoothed before delivery, s.
    pub smoothed_s: Option<f64>,
}

impl WarmUpFindings {
    /// True when what the transient has still to go may leave the band: the end of the record is no final value.
    pub fn drifts_on(&self) -> bool {
        self.settled.at_most_deg_h > self.test.band_deg_h
    }

    /// True where something contradicts the time that the decays give.
    pub fn is_contradicted(&self) -> bool {
        let may_have_been_warm = self.start == Start::Declared && self.without_transient();
        self.departure.is_some() || self.smoothed_s.is_some() || may_have_been_warm
    }

    /// True when the bias was not seen to move after switching on.
    pub fn without_transient(&self) -> bool {
        let r = &self.transient;
        self.time.value <= 0.0
            || r.spread.interval(r.value, 0.95).is_none_or(|i| i.low <= 0.0 && i.high >= 0.0)
    }
}

/// The transient as decays of given time constants at the middle of each block.
fn columns(times: &[f64], constants: &[f64]) -> Vec<Vec<f64>> {
    constants.iter().map(|c| times.iter().map(|t| (-t / c).exp()).collect()).collect()
}

/// Evaluates a record from switching on, or from its first sample where that is not shown.
pub fn find(means: &Means, rate: usize, test: &WarmUpTest, start: Start) -> Option<WarmUpFindings> {
    let since = match start {
        Start::Shown(from_s) if from_s > 0.0 => Some(means.since(from_s)),
        _ => None,
    };
    let means = since.as_ref().unwrap_or(means);
    let coarse = means.merged(means.len().div_ceil(MAX_BLOCKS).max(1));
    let (y, _) = bridged(coarse.values.get(rate)?)?;
    let n = y.len();
    if n < 60 {
        return None;
    }
    let times: Vec<f64> = (0..n).map(|i| coarse.first_s + (i as f64 + 0.5) * coarse.block_s).collect();
    let length_s = n as f64 * coarse.block_s;
    let modes = Modes::new(n, coarse.block_s);
    let data = modes.of(&y);
    let of =
        |shape: &[f64]| -> Vec<Vec<f64>> { columns(&times, shape).iter().map(|c| modes.of(c)).collect() };
    let (low, high) = (2.0 * coarse.block_s, 0.7 * length_s);
    let (shape, fitted) = best(&modes, &data, &of, (low, high))?;
    let ranges: Vec<Range> = shape.iter().map(|_| Range { low, high, log: true, step: 0.3 }).collect();
    let model: (sampler::Columns<'_>, _) = (&of, sampler::Coefficients::Scaled);
    let draws: Vec<Draw> = sampler::sample(&modes, &data, model, &ranges, (&shape, &fitted), SAMPLER_SWEEPS);
    if draws.is_empty() {
        return None;
    }
    let settled = settled((&modes, &data), &of, (&shape, &fitted), (low, length_s), test.band_deg_h)?;
    let from = ((1.0 - test.final_share) * n as f64) as usize;
    let end = times.get(from..)?;
    let rest = |constant: f64| end.iter().map(|t| (-t / constant).exp()).sum::<f64>() / end.len() as f64;
    let at = |draw: &Draw, c: &nalgebra::DVector<f64>, t: f64| -> f64 {
        draw.shape.iter().zip(c.iter()).map(|(k, a)| a * ((-t / k).exp() - rest(*k))).sum()
    };
    let until = |draw: &Draw, c: &nalgebra::DVector<f64>| -> f64 {
        let offset: f64 = draw.shape.iter().zip(c.iter()).map(|(k, a)| a * rest(*k)).sum();
        let beyond = |t: f64| {
            let f: f64 = draw.shape.iter().zip(c.iter()).map(|(k, a)| a * (-t / k).exp()).sum();
            (f - offset).abs() - test.band_deg_h
        };
        // From the end backwards; then to the second.
        let steps = 400;
        let time = |i: usize| length_s * i as f64 / f64::from(steps);
        let Some(last) = (0..=steps as usize).rev().find(|i| beyond(time(*i)) > 0.0) else { return 0.0 };
        let (mut a, mut b) = (time(last), time(last + 1).min(length_s));
        for _ in 0..30 {
            let middle = 0.5 * (a + b);
            if beyond(middle) > 0.0 { a = middle } else { b = middle }
        }
        0.5 * (a + b)
    };
    let time = read::of_draws(&draws, until);
    let transient = read::of_draws(&draws, |d, c| at(d, c, 0.0));
    let best_columns = columns(&times, &shape);
    let c = &fitted.solved.coefficients;
    let raw: Vec<f64> =
        (0..n).map(|i| best_columns.iter().zip(c.iter()).map(|(x, a)| a * x[i]).sum()).collect();
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let level = mean(&y) - mean(&raw);
    let modelled: Vec<f64> = raw.iter().map(|v| v + level).collect();
    let upper = time.spread.bound(time.value, 0.975).unwrap_or(length_s);
    let (block_s, first_s) = (coarse.block_s, *times.first()?);
    let course = Course { values: &y, modelled: &modelled, block_s, first_s };
    let final_deg_h = mean(modelled.get(from..)?);
    Some(WarmUpFindings {
        departure: course.departure(upper, final_deg_h, test.band_deg_h),
        smoothed_s: course.smoothed_s(),
        test: test.clone(),
        start,
        always_inside: upper <= 0.0,
        too_short: upper > (1.0 - test.final_share) * length_s,
        settled,
        time,
        transient,
        time_constants_s: shape,
        length_s,
        blocks: times.iter().copied().zip(y.iter().copied()).collect(),
        final_deg_h,
        modelled,
    })
}

/// Whether two time constants differ enough to be two decays.
fn apart(constants: &[f64]) -> bool {
    constants.windows(2).all(|w| (w[0] / w[1]).ln().abs() > MIN_LOG_RATIO)
}

/// Two decays where they can be told apart, else one, with the time constants.
fn best(
    modes: &Modes,
    data: &[f64],
    of: sampler::Columns<'_>,
    range: (f64, f64),
) -> Option<(Vec<f64>, Fitted)> {
    let grid: Vec<f64> = (0..14).map(|i| range.0 * (range.1 / range.0).powf(f64::from(i) / 13.0)).collect();
    let start = modes.fit(data, &of(&[(range.0 * range.1).sqrt()]), None)?;
    let mut noise = start.noise;
    let score =
        |shape: &[f64], noise: &[f64; 3]| modes.solve(data, &of(shape), noise).map(|s| s.log_likelihood);
    let ascend = |shapes: Vec<Vec<f64>>, noise: &[f64; 3]| -> Option<(f64, Vec<f64>)> {
        let rated = shapes.into_iter().filter_map(|s| Some((score(&s, noise)?, s)));
        let start = rated.max_by(|a, b| a.0.total_cmp(&b.0))?;
        let value = |shape: &[f64]| score(shape, noise).filter(|_| apart(shape));
        Some(coordinate_ascent(start, range, (&[1.3, 1.1, 1.04], 6), value))
    };
    let one = ascend(grid.iter().map(|g| vec![*g]).collect(), &noise)?;
    let one_fit = modes.fit(data, &of(&one.1), Some(noise))?;
    noise = one_fit.noise;
    // A slow decay that is missing passes for a random walk, and a walk then hides it: the search goes on from both.
    let quiet = [noise[0], 0.02 * noise[1], 0.02 * noise[2]];
    let pairs: Vec<Vec<f64>> = grid
        .iter()
        .enumerate()
        .flat_map(|(i, a)| grid.iter().skip(i + 2).map(move |b| vec![*a, *b]))
        .collect();
    let settled = |start: [f64; 3]| -> Option<(Fitted, Vec<f64>)> {
        let first = ascend(pairs.clone(), &start)?.1;
        let fit = modes.fit(data, &of(&first), Some(start))?;
        let second = ascend(vec![first], &fit.noise)?.1;
        Some((modes.fit(data, &of(&second), Some(fit.noise))?, second))
    };
    let two = [noise, quiet]
        .into_iter()
        .filter_map(settled)
        .max_by(|a, b| a.0.solved.log_likelihood.total_cmp(&b.0.solved.log_likelihood));
    Some(two.map_or((one.1, one_fit), |(fit, t)| (t, fit)))
}

/// Whether the transient had ended with the record.
#[derive(Debug, Clone, PartialEq)]
pub struct Settled {
    /// Distance from where the decays lead, at the end of the record, deg/h.
    pub remaining: Reading,
    /// Upper limit with 95 %, deg/h.
    pub at_most_deg_h: f64,
    /// The bias comes into the band for good not before this time with 95 %, s; never beyond the record.
    pub at_least_s: f64,
}

/// Draws decays from the best ones found, whose time constants lie between a shortest one and the length of the record.
pub fn settled(
    (modes, data): (&Modes, &[f64]),
    of: sampler::Columns<'_>,
    (constants, fitted): (&[f64], &Fitted),
    (low_s, length_s): (f64, f64),
    band_deg_h: f64,
) -> Option<Settled> {
    let last = constants.len().saturating_sub(1);
    let high = |i: usize| length_s * if i == last { MAX_TIME_SHARE.1 } else { MAX_TIME_SHARE.0 };
    let ranges: Vec<Range> =
        (0..=last).map(|i| Range { low: low_s, high: high(i), log: true, step: 0.3 }).collect();
    let start: Vec<f64> = constants.iter().enumerate().map(|(i, c)| c.clamp(low_s, high(i))).collect();
    let fitted = modes.fit(data, &of(&start), Some(fitted.noise))?;
    let model = (of, sampler::Coefficients::Scaled);
    let draws: Vec<Draw> = sampler::sample(modes, data, model, &ranges, (&start, &fitted), SETTLED_SWEEPS);
    if draws.is_empty() {
        return None;
    }
    let off = |draw: &Draw, c: &DVector<f64>, t: f64| -> f64 {
        draw.shape.iter().zip(c.iter()).map(|(k, a)| a * (-t / k).exp()).sum::<f64>().abs()
    };
    let remaining = read::of_draws(&draws, |d, c| off(d, c, length_s));
    let time = |i: usize| length_s * i as f64 / TRANSIENT_TIMES as f64;
    let inside_from = read::of_draws(&draws, |d, c| {
        (0..=TRANSIENT_TIMES).rev().find(|i| off(d, c, time(*i)) > band_deg_h).map_or(0.0, time)
    });
    Some(Settled {
        at_most_deg_h: remaining.spread.bound(remaining.value, STATEMENT_PROBABILITY)?,
        at_least_s: inside_from.spread.bound(inside_from.value, 1.0 - STATEMENT_PROBABILITY)?,
        remaining,
    })
}
