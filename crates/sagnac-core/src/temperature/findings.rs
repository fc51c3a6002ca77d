//! What a test over temperature showed about one gyro channel.

use super::course::{Course, Span, Terms, legendre, legendre_slopes};
use super::gls::Modes;
use super::order::{self, Tried};
use super::posterior::{self, Posterior};
use super::removed::{self, Removed};
use super::segments::{self, Segment, Steps};
use super::separate::{self, Separation};
use super::test::{SegmentKind, TemperatureTest};
use super::track::{Means, bridged};
use super::zones::{self, Zone};
use crate::numeric::cosine::inverse_dct2;
use crate::recording::sensor;
use crate::recording::window::TimeSpan;

/// Blocks of the model at most.
const MAX_BLOCKS: usize = 2048;
/// Shortest block of the model, s.
const MIN_BLOCK_S: f64 = 2.0;
/// Sweeps over what is not known.
const SAMPLER_SWEEPS: usize = 360;
/// Weight, of the largest, below which an order is left out.
const MIN_WEIGHT: f64 = 0.03;
/// Temperatures, degC, that a record must cover to say anything over temperature.
pub const MIN_SPAN_DEG_C: f64 = 2.0;

/// The schedule of temperature that was run: its segments and the range it reached.
#[derive(Debug, Clone, PartialEq)]
pub struct Schedule {
    /// Segments in order.
    pub segments: Vec<Segment>,
    /// Lowest and highest temperature, degC.
    pub reached: Span,
    /// Temperature at the end of the record, degC.
    pub last_deg_c: f64,
    /// Temperature as block means: time in s from the start of the recording, degC.
    pub temperature: Vec<(f64, f64)>,
    /// Commanded temperature, where there is one.
    pub command: Option<Vec<(f64, f64)>>,
    /// Share of blocks without a temperature.
    pub missing: f64,
}

/// The model of the bias of one channel over temperature, and the residual.
#[derive(Debug, Clone)]
pub struct Analysis {
    /// Block means.
    pub course: Course,
    /// The model.
    pub posterior: Posterior,
    /// Order of the polynomial that is shown; the draws hold others too, by their predictive densities.
    pub order: usize,
    /// Orders tried; empty when there were too few ramps to hold one out.
    pub orders: Vec<Tried>,
    /// Whether rate, lag and hysteresis can be told apart.
    pub separation: Option<Separation>,
    /// Modelled rate, deg/h, by block, its mean that of the record.
    pub modelled: Vec<f64>,
    /// Mean of the record less that of the model without a constant: bias at the middle of the polynomial, deg/h.
    pub level_deg_h: f64,
    /// Residual in means over `average_s`: (time, temperature, deg/h).
    pub residual: Vec<(f64, f64, f64)>,
    /// A slow part that was taken out before delivery; `None` where none is seen.
    pub removed: Option<Removed>,
    /// Averaging time of the residual, s.
    pub average_s: f64,
    /// Rms of the residual, every temperature with the same weight, deg/h.
    pub residual_rms: f64,
    /// Degrees of freedom of its square under the identified noise.
    pub residual_dof: f64,
    /// Rate of the fastest ramp, degC/min.
    pub ramp_deg_c_min: f64,
    /// Rate of the slowest ramp, degC/min.
    pub slowest_deg_c_min: f64,
    /// True when temperature went both up and down.
    pub both_ways: bool,
    /// True when ramps of different rates, or rest after ramps, part what goes with the rate of temperature from what
    /// goes with its direction.
    pub parted: bool,
}

/// Everything found about one channel over temperature.
#[derive(Debug, Clone)]
pub struct Findings {
    /// The test as the procedure states it.
    pub test: TemperatureTest,
    /// The schedule; `None` without a temperature.
    pub schedule: Option<Schedule>,
    /// The model; `None` where the temperature hardly moved.
    pub analysis: Option<Analysis>,
    /// Noise by zone.
    pub zones: Vec<Zone>,
}

/// The schedule of a recording: channel 0 of `means` is a rate, `temperature` and `command` are positions in it.
pub fn schedule(
    means: &Means,
    temperature: usize,
    command: Option<usize>,
    test: &TemperatureTest,
) -> Option<Schedule> {
    let coarse = means.merged(coarse_factor(means));
    let (measured, missing) = temperature_course(means, temperature)?;
    let steps = Steps { first_s: coarse.first_s, step_s: coarse.block_s, values: &measured };
    let commanded = command.and_then(|c| coarse.values.get(c)).and_then(|v| bridged(v)).map(|c| c.0);
    let by = commanded.as_deref().map_or(steps, |values| Steps { values, ..steps });
    let series = |values: &[f64]| {
        let time = |i: usize| coarse.first_s + (i as f64 + 0.5) * coarse.block_s;
        values.iter().enumerate().map(|(i, v)| (time(i), *v)).collect::<Vec<_>>()
    };
    let (low, high) = measured.iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
    Some(Schedule {
        segments: segments::find(&by, &steps, test),
        reached: Span { low, high },
        last_deg_c: *measured.last()?,
        temperature: series(&measured),
        command: commanded.as_deref().map(series),
        missing,
    })
}

/// The temperature in the blocks of the model, freed of the steps of its thermometer, and the share that was missing.
fn temperature_course(means: &Means, temperature: usize) -> Option<(Vec<f64>, f64)> {
    let (readings, _) = bridged(means.values.get(temperature)?)?;
    let factor = coarse_factor(means);
    let coarse = means.merged(factor);
    let (measured, missing) = bridged(coarse.values.get(temperature)?)?;
    let Some(course) = sensor::between_steps(&readings) else { return Some((measured, missing)) };
    let mean = |c: &[f64]| c.iter().sum::<f64>() / c.len() as f64;
    Some((course.chunks_exact(factor).map(mean).collect(), missing))
}

fn coarse_factor(means: &Means) -> usize {
    let by_count = means.len().div_ceil(MAX_BLOCKS);
    let by_length = (MIN_BLOCK_S / means.block_s).ceil() as usize;
    by_count.max(by_length).max(1)
}

/// Everything about the rate channel at position `rate` of `means`.
pub fn findings(
    means: &Means,
    rate: usize,
    temperature: usize,
    schedule: Option<Schedule>,
    test: &TemperatureTest,
) -> Findings {
    let analysis = schedule.as_ref().and_then(|s| analyse(means, rate, temperature, s, test));
    let slow = analysis
        .as_ref()
        .map_or((&[][..], 0.0), |a| (&a.posterior.draws[..], a.posterior.best.fitted.log_deviation[1]));
    let zones = zones::zones(means, (rate, temperature), slow, test);
    Findings { test: test.clone(), schedule, analysis, zones }
}

fn analyse(
    means: &Means,
    rate: usize,
    temperature: usize,
    schedule: &Schedule,
    test: &TemperatureTest,
) -> Option<Analysis> {
    let coarse = means.merged(coarse_factor(means));
    let (rate_deg_h, bridged_share) = bridged(coarse.values.get(rate)?)?;
    let temperature_deg_c = temperature_course(means, temperature)?.0;
    let course = Course {
        block_s: coarse.block_s,
        first_s: coarse.first_s,
        rate_deg_h,
        temperature_deg_c,
        bridged: bridged_share,
    };
    let span = course.span();
    if course.len() < 40 || span.high - span.low < MIN_SPAN_DEG_C {
        return None;
    }
    let ramps: Vec<&Segment> = schedule.segments.iter().filter(|s| s.kind.is_ramp()).collect();
    let both_ways =
        [SegmentKind::Heating, SegmentKind::Cooling].iter().all(|kind| ramps.iter().any(|r| r.kind == *kind));
    // In one direction and at one rate its sensitivity is part of the constant; so is the hysteresis.
    let terms = |order: usize| Terms { order, rate: both_ways, hysteresis: both_ways };
    let folds = folds(&schedule.segments);
    let orders = if folds.len() >= 2 {
        order::try_orders(&course, span, &folds, terms, test.highest_order)
    } else {
        vec![]
    };
    let chosen = terms(order::choose(&orders).map_or(test.highest_order.min(3), |t| t.order));
    let weights = weights(&orders, chosen.order);
    let models: Vec<(Posterior, f64)> = weights
        .into_iter()
        .filter_map(|(order, w)| Some((posterior::sample(&course, terms(order), span, SAMPLER_SWEEPS)?, w)))
        .collect();
    let posterior = posterior::average(models, chosen.order)?;
    let order = chosen.order;
    let chosen = posterior.terms;
    let separation = separate::separation(&course, &chosen, &span, &posterior.best);
    let best = &posterior.best;
    let columns = course.columns(&chosen, &best.shape, &span);
    let raw: Vec<f64> = (0..course.len())
        .map(|i| columns.iter().zip(best.fitted.solved.coefficients.iter()).map(|(c, b)| b * c[i]).sum())
        .collect();
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let level_deg_h = mean(&course.rate_deg_h) - mean(&raw);
    let modelled: Vec<f64> = raw.iter().map(|v| v + level_deg_h).collect();
    let each = ((test.residual_average_s / course.block_s).round() as usize).clamp(1, course.len() / 8);
    let residual = averaged_residual(&course, &modelled, each);
    let powers = &best.fitted.solved.powers;
    let kept = &powers[..(powers.len() / each).max(1)];
    let (sum, squares) = kept.iter().fold((0.0, 0.0), |(s, q), p| (s + p, q + p * p));
    let rates: Vec<f64> = ramps.iter().map(|r| r.rate_deg_c_h.abs() / 60.0).collect();
    let (residual_rms, evenly) = rms_over_temperature(&residual, &span);
    Some(Analysis {
        residual_rms,
        residual_dof: if squares > 0.0 { (evenly * sum * sum / squares).max(1.0) } else { 1.0 },
        average_s: each as f64 * course.block_s,
        ramp_deg_c_min: rates.iter().copied().fold(0.0, f64::max),
        slowest_deg_c_min: rates.iter().copied().reduce(f64::min).unwrap_or(0.0),
        both_ways,
        parted: both_ways && parted(&schedule.segments, posterior.best.shape.lag_s),
        separation,
        order,
        orders,
        removed: removed::removed(&course, &span, &modelled),
        posterior,
        modelled,
        level_deg_h,
        residual,
        course,
    })
}

/// The orders that the model is averaged over, with their weights: what is far from as good as the best is left out.
fn weights(orders: &[Tried], chosen: usize) -> Vec<(usize, f64)> {
    let top = orders.iter().map(|t| t.log_score).fold(f64::NEG_INFINITY, f64::max);
    let weights: Vec<(usize, f64)> = orders
        .iter()
        .map(|t| (t.order, (t.log_score - top).exp()))
        .filter(|(order, w)| *w > MIN_WEIGHT || *order == chosen)
        .collect();
    if weights.is_empty() { vec![(chosen, 1.0)] } else { weights }
}

/// Time, s, temperature, degC, and what the model leaves, deg/h, in means over `each` blocks.
fn averaged_residual(course: &Course, modelled: &[f64], each: usize) -> Vec<(f64, f64, f64)> {
    (0..course.len() / each)
        .map(|j| {
            let part = j * each..(j + 1) * each;
            let average = |v: &dyn Fn(usize) -> f64| part.clone().map(v).sum::<f64>() / each as f64;
            (
                course.first_s + (j as f64 + 0.5) * each as f64 * course.block_s,
                average(&|i| course.temperature_deg_c[i]),
                average(&|i| course.rate_deg_h[i] - modelled[i]),
            )
        })
        .collect()
}

/// Root of the mean over temperature of the mean square at each, and the share of the degrees of freedom that even weights
/// leave: a temperature where little time was spent counts as much as a long dwell.
fn rms_over_temperature(residual: &[(f64, f64, f64)], span: &Span) -> (f64, f64) {
    const TEMPERATURE_BINS: usize = 20;
    let mut bins = [(0.0, 0usize); TEMPERATURE_BINS];
    for (_, t, r) in residual {
        let at = (0.5 * (span.argument(*t) + 1.0) * TEMPERATURE_BINS as f64)
            .clamp(0.0, TEMPERATURE_BINS as f64 - 1.0);
        let bin = &mut bins[at as usize];
        bin.0 += r * r;
        bin.1 += 1;
    }
    let used = || bins.iter().filter(|b| b.1 > 0).map(|b| (b.0, b.1 as f64));
    let count = used().count().max(1) as f64;
    let mean = used().map(|(sum, n)| sum / n).sum::<f64>() / count;
    // The mean of k means over n₁ … nₖ squares is as sure as that of k²/Σ(1/nᵢ) squares.
    let as_sure = count * count / used().map(|(_, n)| 1.0 / n).sum::<f64>().max(f64::MIN_POSITIVE);
    (mean.sqrt(), (as_sure / residual.len().max(1) as f64).min(1.0))
}

/// Ratio of ramp rates from which they count as different.
const MIN_RATE_RATIO: f64 = 1.5;
/// Lags that a rest must last for the rate of the coil to die away.
const MIN_REST_LAGS: f64 = 2.0;

fn parted(segments: &[Segment], lag_s: f64) -> bool {
    let rates = segments.iter().filter(|s| s.kind.is_ramp()).map(|s| s.rate_deg_c_h.abs());
    let (slow, fast) = rates.fold((f64::INFINITY, 0.0f64), |(l, h), r| (l.min(r), h.max(r)));
    let rest = segments
        .iter()
        .filter(|s| s.kind == SegmentKind::Dwell)
        .any(|s| s.length_s() > (MIN_REST_LAGS * lag_s).max(600.0));
    fast > MIN_RATE_RATIO * slow || rest
}

/// Each ramp with half of the quiet segments about it.
fn folds(segments: &[Segment]) -> Vec<TimeSpan> {
    let middle = |s: &Segment| 0.5 * (s.from_s + s.to_s);
    let quiet = |at: Option<usize>| at.and_then(|i| segments.get(i)).filter(|s| !s.kind.is_ramp());
    segments
        .iter()
        .enumerate()
        .filter(|(_, s)| s.kind.is_ramp())
        .map(|(i, s)| {
            let from_s = quiet(i.checked_sub(1)).map_or(s.from_s, middle);
            let to_s = quiet(Some(i + 1)).map_or(s.to_s, middle);
            TimeSpan { from_s, to_s }
        })
        .collect()
}

impl Findings {
    /// Empty findings, of a recording that lacks the temperature channel asked for.
    pub fn nothing(test: &TemperatureTest) -> Findings {
        Findings { test: test.clone(), schedule: None, analysis: None, zones: vec![] }
    }
}

/// Shares of the longest lag looked at that the fastest ramp must take over the whole range.
const MAX_CROSSING_SHARE: f64 = 0.4;

impl Analysis {
    /// Time that the fastest ramp takes over the whole range, s.
    pub fn crossing_s(&self) -> f64 {
        let span = self.posterior.span;
        (span.high - span.low) / self.ramp_deg_c_min.max(f64::MIN_POSITIVE) * 60.0
    }

    /// True where the range is over before the coil can follow a ramp steadily: a lag, its rate of temperature and the
    /// turning round of the hysteresis then have nearly the same course, and intervals of the first two are too short.
    pub fn narrow(&self) -> bool {
        self.crossing_s() < MAX_CROSSING_SHARE * self.posterior.longest_lag_s
    }

    /// Whether a term with so much inflation of its variance can be stated singly.
    pub fn separable(&self, inflation: impl Fn(&Separation) -> f64) -> bool {
        self.parted
            && self.separation.as_ref().is_some_and(|s| inflation(s) < separate::INSEPARABLE_INFLATION)
    }

    /// Static bias at a temperature, deg/h, the constant included, by the best fit.
    pub fn bias_at(&self, deg_c: f64) -> f64 {
        let p = &self.posterior;
        let basis = legendre(p.span.argument(deg_c), p.terms.order);
        let c = &p.best.fitted.solved.coefficients;
        self.level_deg_h + basis.iter().zip(c.iter()).map(|(b, c)| b * c).sum::<f64>()
    }

    /// Slope of the static bias at a temperature, deg/h/degC.
    pub fn slope_at(&self, deg_c: f64) -> f64 {
        let p = &self.posterior;
        let basis = legendre_slopes(p.span.argument(deg_c), p.terms.order);
        let c = &p.best.fitted.solved.coefficients;
        basis.iter().zip(c.iter()).map(|(b, c)| b * c).sum::<f64>() * 2.0 / (p.span.high - p.span.low)
    }

    /// Residual by block, deg/h.
    pub fn residual_by_block(&self) -> Vec<f64> {
        self.course.rate_deg_h.iter().zip(&self.modelled).map(|(y, m)| y - m).collect()
    }

    /// The slow part of the residual that the identified noise explains as flicker and random walk, deg/h by block.
    pub fn slow_noise(&self) -> Vec<f64> {
        let modes = Modes::new(self.course.len(), self.course.block_s);
        let residual = modes.of(&self.residual_by_block());
        let noise = self.posterior.best.fitted.noise;
        let (all, white) = (modes.powers(&noise), modes.powers(&[noise[0], 0.0, 0.0]));
        let kept = residual.iter().zip(all.iter().zip(&white)).map(|(r, (p, w))| r * (1.0 - w / p));
        inverse_dct2(&std::iter::once(0.0).chain(kept).collect::<Vec<_>>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_dwell_adds_few_degrees_of_freedom_to_an_rms_with_even_weights() {
        let span = Span { low: 0.0, high: 20.0 };
        // Two means at each degree; then a hundred more at the upper end.
        let at = |deg_c: f64, count: usize| vec![(0.0, deg_c, 1.0); count];
        let even: Vec<_> = (0..20).flat_map(|i| at(f64::from(i) + 0.5, 2)).collect();
        let (rms, share) = rms_over_temperature(&even, &span);
        assert!((rms - 1.0).abs() < 1e-12 && (share - 1.0).abs() < 1e-12, "{rms} {share}");
        let dwelt: Vec<_> = even.iter().copied().chain(at(19.5, 100)).collect();
        let (_, share) = rms_over_temperature(&dwelt, &span);
        // 400 / (19/2 + 1/102) squares of 140.
        assert!((share * 140.0 - 42.06).abs() < 0.01, "{share}");
    }
}
