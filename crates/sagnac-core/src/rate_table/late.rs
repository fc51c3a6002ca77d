//! Whether the output follows the table late: the later part of a step against the whole of it.
//!
//! An output behind a filter, a slow loop or a delay still holds some of the rate before when the evaluated part of a step begins.
//! The mean of the step is then off by a share of the change of rate that led to it, which no noise knows.

use super::steps::{Part, Step, Steps};
use crate::estimate::Spread;
use crate::numeric::order::SortNumbers;
use crate::numeric::reml::Combination;
use nalgebra::{DMatrix, DVector};

/// Probability by chance, over all time constants, below which the output is late.
const MAX_CHANCE: f64 = 1e-5;
/// Time constants that are tried, in lengths of a step: of what is over within a step, and of what goes on through many.
const TIME_CONSTANTS: [f64; 6] = [0.1, 0.4, 1.0, 3.0, 10.0, 30.0];
/// Fewest steps beyond the unknowns.
const MIN_SPARE_STEPS: usize = 4;

/// A share of earlier rates in the means of the steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Late {
    /// As a share of what was still missing at the beginning of a step; below zero where the output goes too far at first.
    pub share: Combination,
    /// Probability by chance.
    pub by_chance: f64,
}

impl Late {
    /// Of one gyro channel; `None` without enough steps of several parts, or where no share is seen.
    pub fn of(steps: &Steps, gyro: usize) -> Option<Late> {
        let later: Vec<Option<Differs>> = steps.list.iter().map(|step| Differs::of(step, gyro)).collect();
        let mut lengths: Vec<f64> =
            steps.list.windows(2).map(|pair| pair[1].from_s - pair[0].from_s).collect();
        lengths.sort_ascending();
        let length_s = *lengths.get(lengths.len() / 2)?;
        let of = |lengths: &f64| with_missing(steps, &later, &missing(steps, lengths * length_s));
        let all = TIME_CONSTANTS.len() as f64;
        let best = TIME_CONSTANTS.iter().filter_map(of).min_by(|a, b| a.by_chance.total_cmp(&b.by_chance))?;
        (best.by_chance * all < MAX_CHANCE).then_some(best)
    }
}

/// The rate that the output still lacks when each step begins, deg/h, behind a lag of first order.
fn missing(steps: &Steps, time_constant_s: f64) -> Vec<f64> {
    let mut lacks = vec![0.0; steps.list.len()];
    for (k, pair) in steps.list.windows(2).enumerate() {
        let kept = (-(pair[1].from_s - pair[0].from_s) / time_constant_s).exp();
        lacks[k + 1] = kept * lacks[k] + pair[0].rate - pair[1].rate;
    }
    lacks
}

/// Least squares of what steps differ by from their later halves: on a constant, the rate, what was missing of it, and what the
/// temperature does to bias and scale factor meanwhile.
fn with_missing(steps: &Steps, later: &[Option<Differs>], missing: &[f64]) -> Option<Late> {
    let rows: Vec<(f64, f64, Differs)> = steps
        .list
        .iter()
        .zip(later)
        .zip(missing)
        .skip(1)
        .filter_map(|((step, differs), lacks)| Some((step.rate, *lacks, (*differs)?)))
        .collect();
    let size = rows.iter().fold(0.0, |m: f64, r| m.max(r.0.abs()).max(r.1.abs()));
    let warmest = rows.iter().fold(0.0, |m: f64, r| m.max(r.2.temperature.abs()));
    let warms = warmest > 0.0 && rows.iter().all(|r| r.2.temperature.is_finite());
    let columns = |(rate, lacks, differs): &(f64, f64, Differs)| {
        let warmer = differs.temperature / warmest;
        [lacks / size, 1.0, rate / size, warmer, warmer * rate / size]
    };
    let unknowns = if warms { 5 } else { 3 };
    let dof = rows.len().checked_sub(unknowns).filter(|spare| *spare >= MIN_SPARE_STEPS)? as f64;
    let x = DMatrix::from_fn(rows.len(), unknowns, |i, j| columns(&rows[i])[j]);
    let y = DVector::from_fn(rows.len(), |i, _| rows[i].2.output / size);
    let normal = (x.transpose() * &x).cholesky()?;
    let fitted = normal.solve(&(x.transpose() * &y));
    let left = (&y - &x * &fitted).norm_squared() / dof;
    let standard = (left * normal.inverse()[(0, 0)]).sqrt();
    let share = Combination { value: fitted[0], standard, dof };
    let spread = Spread::StudentT { standard_uncertainty: standard, dof };
    let by_chance = 2.0 * spread.probability_above(0.0, share.value.abs()).filter(|_| standard > 0.0)?;
    Some(Late { share, by_chance })
}

/// A whole step less its later half.
#[derive(Debug, Clone, Copy)]
struct Differs {
    /// Of the output, the motion of the table taken out, deg/h.
    output: f64,
    /// Of the temperature, degC; NaN without one.
    temperature: f64,
}

impl Differs {
    fn of(step: &Step, gyro: usize) -> Option<Differs> {
        let off = |p: &Part| p.gyro.get(gyro).map(|g| g - p.rate).filter(|off| off.is_finite());
        let parts: Vec<(f64, f64, f64)> = step
            .parts
            .iter()
            .filter_map(|p| Some((p.length_s, off(p)?, p.temperature)))
            .filter(|p| p.0 > 0.0)
            .collect();
        let later = parts.get(parts.len().div_ceil(2)..).filter(|later| !later.is_empty())?;
        let mean = |of: &[(f64, f64, f64)], value: fn(&(f64, f64, f64)) -> f64| {
            of.iter().map(|p| p.0 * value(p)).sum::<f64>() / of.iter().map(|p| p.0).sum::<f64>()
        };
        let differs = |value: fn(&(f64, f64, f64)) -> f64| mean(&parts, value) - mean(later, value);
        Some(Differs { output: differs(|p| p.1), temperature: differs(|p| p.2) })
    }
}
