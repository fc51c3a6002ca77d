//! The level of the noise over time, over the input rate, and over other columns.

use super::gamma::{Group, fit, mean_square, overdispersion};
use super::rate_law::{RateLaw, rate_law};
use super::time_level::{DECAYS, Form, over_time};
use super::{Flat, lattice_step, varies};
use crate::effect::{Column, Domain, Place};
use crate::estimate::chi_square_tail;
use crate::mismatch::problem::Problem;
use crate::mismatch::tried::Tried;
use crate::numeric::range::{Bounds, ends};

/// Groups over the values of a column.
const GROUPS: usize = 256;
/// Fewest samples of a group.
const FEWEST: usize = 16;
/// Laws that compete: forms over time, over columns, over the rate.
const LAWS: f64 = 16.0;
/// Knots of a law over time.
const KNOTS: usize = 128;

/// What the level of the noise follows.
#[derive(Debug, Clone, PartialEq)]
pub enum Law {
    /// Time: knots of `time_s` and of the deviation over that of the whole record, with lines between them.
    Time(Vec<(f64, f64)>),
    /// Size of the input rate: σ² = σ₀² (1 + (ratio² − 1)(|Ω|/max)^exponent).
    Rate {
        /// Deviation at the largest rate over that at zero.
        ratio: f64,
        /// 1 or 2.
        exponent: u8,
    },
    /// Value of a column: knots of it and of the deviation over that of the whole record.
    Column(Column, Vec<(f64, f64)>),
}

/// A level of the noise that changes.
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    /// `noise_variance_time` or `noise_variance_rate`.
    pub kind: &'static str,
    /// What it follows.
    pub law: Law,
    /// Deviation of each sample over that of the whole record; its mean square is 1.
    pub profile: Vec<f64>,
    /// Gain of log-likelihood on the whitened residual over one level.
    pub gain: f64,
    /// Parameters of the law; its instants, its periods and its choice of a column counted.
    pub parameters: usize,
    /// Probability of such a gain under one level, all laws counted.
    pub p_value: f64,
    /// Largest deviation over the smallest; for a law of rate that at the largest rate over that at zero.
    pub ratio: f64,
    /// Its 95 % interval.
    pub ci95: [f64; 2],
    /// Where the noise is raised, principal first.
    pub places: Vec<Place>,
}

/// A law before it is rated.
pub(super) struct Found {
    pub kind: &'static str,
    pub law: Law,
    pub profile: Vec<f64>,
    pub gain: f64,
    pub trials: f64,
    /// Coefficients that a gain of nothing comes from.
    pub free: usize,
    pub parameters: usize,
    pub dispersion: f64,
    pub ratio: f64,
    pub ci95: [f64; 2],
    pub place: Place,
}

/// Every law of the level that says more than one level does, the best by BIC first.
pub fn level(problem: &Problem, tried: &Tried) -> Vec<Level> {
    let flat = Flat::of(tried, problem);
    let indices: Vec<usize> = (0..flat.flat.len()).filter(|i| flat.counts(problem, *i)).collect();
    // On a coarse lattice the size of the residual says how near the rate is to a step.
    if indices.len() < 8 * FEWEST || lattice_step(problem, &flat) > super::COARSE {
        return vec![];
    }
    let mut found: Vec<Found> = over_time(problem, &flat, &indices).into_iter().collect();
    for column in Column::ALL {
        let Some(values) = problem.drivers.column(column).filter(|v| varies(v)) else { continue };
        match column {
            Column::TableRate => found.extend(over_rate(values, &flat, &indices)),
            Column::TableAngle => {}
            _ => found.extend(over_column(column, values, &flat, &indices)),
        }
    }
    let mut out: Vec<Level> = found.into_iter().filter_map(|f| rated(f, &flat, &indices)).collect();
    let rows = (indices.len() as f64).ln();
    let score = |l: &Level| 2.0 * l.gain - l.parameters as f64 * rows;
    out.sort_by(|a, b| score(b).total_cmp(&score(a)));
    out
}

fn rated(mut found: Found, flat: &Flat, indices: &[usize]) -> Option<Level> {
    let n = found.profile.len() as f64;
    let root = (found.profile.iter().map(|g| g * g).sum::<f64>() / n).sqrt();
    found.profile.iter_mut().for_each(|g| *g /= root);
    match &mut found.law {
        Law::Time(knots) | Law::Column(_, knots) => knots.iter_mut().for_each(|k| k.1 /= root),
        Law::Rate { .. } => {}
    }
    let sample = |i: &usize| (flat.white[*i], found.profile[*i]);
    let on_white = gain_of(indices.iter().map(sample));
    let difference = |i: &usize| {
        let last = i.checked_sub(1)?;
        Some((flat.flat[*i] - flat.flat[last], (found.profile[*i] * found.profile[last]).sqrt()))
    };
    let on_differences = gain_of(indices.iter().filter_map(difference));
    // What the whitened residual does not show, or shows for another reason, is not counted; nor is a smooth course,
    // which differences do not have.
    let gain = found.gain.min(on_white).min(on_differences);
    let tail = chi_square_tail(2.0 * gain.max(0.0) / found.dispersion, found.free as f64);
    let p_value = (LAWS * found.trials * tail).min(1.0);
    let keep = gain.is_finite() && gain > 0.5 * found.free as f64 && p_value < 0.05;
    keep.then_some(Level {
        kind: found.kind,
        law: found.law,
        profile: found.profile,
        gain,
        parameters: found.parameters,
        p_value,
        ratio: found.ratio,
        ci95: found.ci95,
        places: vec![found.place],
    })
}

/// Gain of log-likelihood of values by their relative deviations, each side with a level of its own.
fn gain_of(values: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (mut before, mut after, mut logs, mut count) = (0.0, 0.0, 0.0, 0.0);
    for (e, g) in values {
        before += e * e;
        after += (e / g).powi(2);
        logs += g.ln();
        count += 1.0;
    }
    -logs - 0.5 * count * (after / before).ln()
}

/// Groups of samples of like values, with the mean value of each.
fn by_value(values: impl Fn(usize) -> f64, flat: &Flat, indices: &[usize]) -> (Vec<Group>, Vec<f64>) {
    let mut order = indices.to_vec();
    order.sort_by(|a, b| values(*a).total_cmp(&values(*b)));
    let size = order.len().div_ceil(GROUPS).max(FEWEST);
    order
        .chunks(size)
        .map(|group| {
            let dof = group.len() as f64;
            let square = group.iter().map(|i| flat.flat[*i].powi(2)).sum::<f64>() / dof;
            (Group { square, dof }, group.iter().map(|i| values(*i)).sum::<f64>() / dof)
        })
        .unzip()
}

fn over_rate(rate: &[f64], flat: &Flat, indices: &[usize]) -> Option<Found> {
    let (groups, sizes) = by_value(|i| rate[i].abs(), flat, indices);
    let largest = rate.iter().fold(0.0, |a: f64, r| a.max(r.abs()));
    if !varies(&sizes) {
        return None;
    }
    let RateLaw { ratio, exponent, ci95, gain } = rate_law(&groups, &sizes, largest)?;
    let power = |r: f64| 1.0 + (ratio * ratio - 1.0) * (r.abs() / largest).powi(i32::from(exponent));
    let logs: Vec<f64> = {
        let scale = mean_square(
            &groups
                .iter()
                .zip(&sizes)
                .map(|(g, s)| Group { square: g.square / power(*s), dof: g.dof })
                .collect::<Vec<Group>>(),
        );
        sizes.iter().map(|s| (scale * power(*s)).ln()).collect()
    };
    // Half of the way from the lowest to the highest variance.
    let from = largest * 0.5f64.powf(1.0 / f64::from(exponent));
    let (low, high) = if ratio >= 1.0 { (from, largest) } else { (0.0, from) };
    Some(Found {
        kind: "noise_variance_rate",
        law: Law::Rate { ratio, exponent },
        profile: rate.iter().map(|r| power(*r).sqrt()).collect(),
        gain,
        trials: 2.0,
        free: 1,
        parameters: 1,
        dispersion: overdispersion(&groups, &logs, 2),
        ratio,
        ci95,
        place: Place { domain: Domain::InputRate, from: low, to: high },
    })
}

fn over_column(column: Column, values: &[f64], flat: &Flat, indices: &[usize]) -> Option<Found> {
    let (groups, means) = by_value(|i| values[i], flat, indices);
    let Bounds { low, high } = ends(&means);
    if !varies(&means) {
        return None;
    }
    let centred = |v: f64| (2.0 * v - low - high) / (high - low);
    let x: Vec<f64> = means.iter().map(|v| centred(*v)).collect();
    let square = |v: &f64| 1.5 * v * v - 0.5;
    let orders = [vec![x.clone()], vec![x.clone(), x.iter().map(square).collect()]];
    let rows = (indices.len() as f64).ln();
    let fits = orders.into_iter().filter_map(|columns| Some((fit(&groups, &columns)?, columns)));
    let (best, columns) = fits.max_by(|a, b| {
        let score = |f: &f64, p: usize| 2.0 * f - p as f64 * rows;
        score(&a.0.gain, a.1.len()).total_cmp(&score(&b.0.gain, b.1.len()))
    })?;
    let (ratio, ci95) = contrast(&best.log_squares, &best.covariance, &columns);
    let knots: Vec<(f64, f64)> =
        means.iter().zip(&best.log_squares).map(|(v, l)| (*v, (0.5 * l).exp())).collect();
    let domain = match column {
        Column::Temperature => Domain::Temperature,
        Column::Supply => Domain::Supply,
        Column::OuterRate => Domain::OuterRate,
        _ => return None,
    };
    let Bounds { low: from, high: to } = raised(&means, &best.log_squares);
    let free = columns.len();
    Some(Found {
        kind: "noise_variance_time",
        profile: values.iter().map(|v| between(&knots, *v)).collect(),
        law: Law::Column(column, thinned(&knots)),
        gain: best.gain,
        trials: 2.0,
        free,
        parameters: free,
        dispersion: overdispersion(&groups, &best.log_squares, free + 1),
        ratio,
        ci95,
        place: Place { domain, from, to },
    })
}

/// Largest deviation over the smallest, with its interval.
pub(super) fn contrast(
    log_squares: &[f64],
    covariance: &nalgebra::DMatrix<f64>,
    columns: &[Vec<f64>],
) -> (f64, [f64; 2]) {
    let by = |a: &usize, b: &usize| log_squares[*a].total_cmp(&log_squares[*b]);
    let top = (0..log_squares.len()).max_by(by).unwrap_or(0);
    let bottom = (0..log_squares.len()).min_by(by).unwrap_or(0);
    let steps: Vec<f64> = columns.iter().map(|c| c[top] - c[bottom]).collect();
    let mut variance = 0.0;
    for (a, x) in steps.iter().enumerate() {
        for (b, y) in steps.iter().enumerate() {
            variance += x * y * covariance[(a + 1, b + 1)];
        }
    }
    let log = 0.5 * (log_squares[top] - log_squares[bottom]);
    let half = 0.5 * 1.959_964 * variance.max(0.0).sqrt();
    (log.exp(), [(log - half).max(0.0).exp(), (log + half).exp()])
}

/// The interval of `at` in which the level is in the upper half of its range.
pub(super) fn raised(at: &[f64], log_squares: &[f64]) -> Bounds {
    let Bounds { low, high } = ends(log_squares);
    let among = at.iter().zip(log_squares).filter(|(_, l)| **l >= 0.5 * (low + high)).map(|(x, _)| *x);
    ends(&among.collect::<Vec<f64>>())
}

/// A value on the lines between knots.
pub(super) fn between(knots: &[(f64, f64)], at: f64) -> f64 {
    let i = knots.partition_point(|k| k.0 < at);
    match (i.checked_sub(1).and_then(|j| knots.get(j)), knots.get(i)) {
        (Some(a), Some(b)) if b.0 > a.0 => a.1 + (b.1 - a.1) * (at - a.0) / (b.0 - a.0),
        (Some(a), _) => a.1,
        (None, Some(b)) => b.1,
        (None, None) => 1.0,
    }
}

/// At most about [`KNOTS`] of the knots, the ends among them.
pub(super) fn thinned(knots: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let step = knots.len().div_ceil(KNOTS).max(1);
    let last = knots.len().saturating_sub(1);
    let kept = knots.iter().enumerate().filter(|(i, _)| i % step == 0 || *i == last);
    kept.map(|(_, k)| *k).collect()
}

impl Form {
    /// Coefficients, parameters with what was searched, and how many independent places were.
    pub(super) fn counts(self, groups: usize) -> (usize, usize, f64) {
        let j = groups as f64;
        match self {
            Form::Line => (1, 1, 1.0),
            Form::Decay(_) => (1, 2, DECAYS as f64),
            Form::Waves(k) => (k, k, 1.0),
            Form::Step(_) => (1, 2, j),
            Form::Stretch(..) => (1, 3, 16.0 * j),
            Form::Periodic(_) => (2, 3, 0.5 * j),
        }
    }
}
