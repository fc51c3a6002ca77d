//! Forms of the level of the noise over time: a line, slow waves, a step, a stretch, a period.

use super::gamma::{GammaFit, Group, fit, overdispersion};
use super::level::{Found, Law, between, contrast, raised, thinned};
use super::{Flat, cumulated};
use crate::effect::{Domain, Place};
use crate::mismatch::problem::Problem;
use std::f64::consts::PI;

/// Groups of neighbouring samples.
const GROUPS: usize = 512;
/// Fewest samples of a group.
const FEWEST: usize = 16;
/// Fewest samples on a side of a change.
const SIDE: f64 = 48.0;

/// Time constants of a decay that are tried, and the shortest as a share of the record; each 1.5 times the last.
pub(super) const DECAYS: usize = 10;
const SHORTEST: f64 = 0.02;

/// A form of ln g over time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Form {
    /// A line from the beginning to the end.
    Line,
    /// A decay from the beginning, by time constant.
    Decay(usize),
    /// A series of cosines of that order.
    Waves(usize),
    /// A change before a group.
    Step(usize),
    /// Another level from one group to before another.
    Stretch(usize, usize),
    /// So many half periods in the record.
    Periodic(usize),
}

impl Form {
    fn columns(self, groups: usize) -> Vec<Vec<f64>> {
        let column = |f: &dyn Fn(usize) -> f64| (0..groups).map(f).collect::<Vec<f64>>();
        let turn = |i: usize, k: usize| PI * k as f64 * (i as f64 + 0.5) / groups as f64;
        match self {
            Form::Line => vec![column(&|i| 2.0 * (i as f64 + 0.5) / groups as f64 - 1.0)],
            Form::Decay(k) => {
                let time = SHORTEST * 1.5f64.powf(k as f64);
                vec![column(&|i| (-(i as f64 + 0.5) / (groups as f64 * time)).exp())]
            }
            Form::Waves(order) => (1..=order).map(|k| column(&|i| turn(i, k).cos())).collect(),
            Form::Step(at) => vec![column(&|i| f64::from(u8::from(i >= at)))],
            Form::Stretch(from, to) => vec![column(&|i| f64::from(u8::from(i >= from && i < to)))],
            Form::Periodic(k) => vec![column(&|i| turn(i, k).cos()), column(&|i| turn(i, k).sin())],
        }
    }
}

/// The best form over time, if any gains.
pub(super) fn over_time(problem: &Problem, flat: &Flat, indices: &[usize]) -> Option<Found> {
    let n = flat.flat.len();
    let size = n.div_ceil(GROUPS).max(FEWEST);
    let mut sums = vec![(0.0, 0.0); n.div_ceil(size)];
    for i in indices {
        let sum = &mut sums[i / size];
        sum.0 += flat.flat[*i].powi(2);
        sum.1 += 1.0;
    }
    // A group without rows weighs nothing.
    let groups: Vec<Group> = sums
        .iter()
        .map(|(square, dof)| Group { square: if *dof > 0.0 { square / dof } else { 1.0 }, dof: *dof })
        .collect();
    let j = groups.len();
    let mut forms = vec![Form::Line, Form::Waves(2), Form::Waves(4), Form::Waves(8)];
    forms.extend((0..DECAYS).map(Form::Decay));
    forms.extend(changes(&groups));
    forms.extend(period(&groups));
    let rows = (indices.len() as f64).ln();
    let fits = forms.into_iter().filter_map(|form| Some((form, fit(&groups, &form.columns(j))?)));
    let score = |form: &Form, f: &GammaFit| 2.0 * f.gain - form.counts(j).1 as f64 * rows;
    let (form, best) = fits.max_by(|a, b| score(&a.0, &a.1).total_cmp(&score(&b.0, &b.1)))?;
    let (free, parameters, trials) = form.counts(j);
    let middle =
        |g: usize| problem.drivers.time_s(0) + ((g as f64 + 0.5) * size as f64 - 0.5) * problem.drivers.dt_s;
    let edge = |g: usize| problem.drivers.time_s(0) + (g as f64 * size as f64 - 0.5) * problem.drivers.dt_s;
    let levels: Vec<f64> = best.log_squares.iter().map(|l| (0.5 * l).exp()).collect();
    let sharp = match form {
        Form::Step(at) => vec![at],
        Form::Stretch(from, to) => vec![from, to],
        _ => vec![],
    };
    let end = edge(0).max(problem.drivers.time_s(n - 1));
    let knots = if sharp.is_empty() {
        let mut knots: Vec<(f64, f64)> = levels.iter().enumerate().map(|(g, l)| (middle(g), *l)).collect();
        knots.last_mut().iter_mut().for_each(|k| k.0 = k.0.min(end));
        knots
    } else {
        sharp_knots(&sharp, &levels, edge(0), end, problem.drivers.dt_s, edge)
    };
    let (ratio, ci95) = contrast(&best.log_squares, &best.covariance, &form.columns(j));
    let (from, to) = match form {
        Form::Line => (edge(0), end),
        Form::Stretch(from, to) => (edge(from), edge(to).min(end)),
        _ => {
            let starts: Vec<f64> = (0..j).map(edge).collect();
            let raised = raised(&starts, &best.log_squares);
            (raised.low, (raised.high + size as f64 * problem.drivers.dt_s).min(end))
        }
    };
    Some(Found {
        kind: "noise_variance_time",
        profile: (0..n).map(|i| between(&knots, problem.drivers.time_s(i))).collect(),
        law: Law::Time(if sharp.is_empty() && !matches!(form, Form::Periodic(_)) {
            thinned(&knots)
        } else {
            knots
        }),
        gain: best.gain,
        trials,
        free,
        parameters,
        dispersion: overdispersion(&groups, &best.log_squares, free + 1),
        ratio,
        ci95,
        place: Place { domain: Domain::Time, from, to },
    })
}

/// Knots on both sides of every change.
fn sharp_knots(
    changes: &[usize],
    levels: &[f64],
    start: f64,
    end: f64,
    dt_s: f64,
    edge: impl Fn(usize) -> f64,
) -> Vec<(f64, f64)> {
    let level = |g: usize| levels.get(g).copied().unwrap_or(1.0);
    let mut out = vec![(start, level(0))];
    for at in changes.iter().filter(|at| **at > 0 && **at < levels.len()) {
        // A quarter of a sample on either side: no sample lies between.
        out.push((edge(*at) - 0.25 * dt_s, level(at - 1)));
        out.push((edge(*at) + 0.25 * dt_s, level(*at)));
    }
    out.push((end, level(levels.len() - 1)));
    out
}

/// The best step and the best stretch.
fn changes(groups: &[Group]) -> Vec<Form> {
    let j = groups.len();
    let squares = cumulated(groups.iter().map(|g| g.dof * g.square));
    let dofs = cumulated(groups.iter().map(|g| g.dof));
    let (whole, count) = (squares[j], dofs[j]);
    let gain = |from: usize, to: usize| {
        let (inside, dof) = (squares[to] - squares[from], dofs[to] - dofs[from]);
        let (outside, rest) = (whole - inside, count - dof);
        if dof < SIDE || rest < SIDE || inside <= 0.0 || outside <= 0.0 {
            return 0.0;
        }
        0.5 * (count * (whole / count).ln() - dof * (inside / dof).ln() - rest * (outside / rest).ln())
    };
    let mut step = (0.0, 0);
    let mut stretch = (0.0, 0, 0);
    for from in 0..j {
        if gain(from, j) > step.0 {
            step = (gain(from, j), from);
        }
        for to in from + 1..j {
            if from > 0 && gain(from, to) > stretch.0 {
                stretch = (gain(from, to), from, to);
            }
        }
    }
    let mut out = vec![];
    if step.0 > 0.0 {
        out.push(Form::Step(step.1));
    }
    if stretch.0 > 0.0 {
        out.push(Form::Stretch(stretch.1, stretch.2));
    }
    out
}

/// The period that the level follows best, shorter than what slow waves hold.
fn period(groups: &[Group]) -> Option<Form> {
    let j = groups.len();
    let level = super::gamma::mean_square(groups);
    let power = |k: usize| {
        let (mut c, mut s) = (0.0, 0.0);
        for (i, g) in groups.iter().enumerate() {
            let (sin, cos) = (PI * k as f64 * (i as f64 + 0.5) / j as f64).sin_cos();
            let x = g.dof * (g.square / level - 1.0);
            c += x * cos;
            s += x * sin;
        }
        c * c + s * s
    };
    let best = (5..j / 2).map(|k| (power(k), k)).max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(Form::Periodic(best.1))
}
