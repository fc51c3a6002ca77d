//! Forms of the level of the noise over time: a line, slow waves, a step, a stretch, a period.

use crate::effect::shared::variance::{
    GammaFit, Group, MIN_GROUP_SAMPLES, between, contrast, contrast_of_forms, fit, mean_square,
    overdispersion, raised, thinned,
};
use crate::effect::{Domain, FlatResidual, Knot, Law, LevelLaw, Place};
use crate::numeric::sums::cumulated;
use std::f64::consts::PI;

/// Groups of neighbouring samples.
const MAX_TIME_GROUPS: usize = 512;
/// Fewest samples on a side of a change.
const MIN_SIDE_SAMPLES: f64 = 48.0;

/// Time constants of a decay that are tried, and the shortest as a share of the record; each 1.5 times the last.
const DECAY_TIMES: usize = 10;
const SHORTEST_DECAY_SHARE: f64 = 0.02;

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
    /// Coefficients, parameters with what was searched, and how many independent places were.
    fn counts(self, groups: usize) -> (usize, usize, f64) {
        let j = groups as f64;
        match self {
            Form::Line => (1, 1, 1.0),
            Form::Decay(_) => (1, 2, DECAY_TIMES as f64),
            Form::Waves(k) => (k, k, 1.0),
            Form::Step(_) => (1, 2, j),
            Form::Stretch(..) => (1, 3, 16.0 * j),
            Form::Periodic(_) => (2, 3, 0.5 * j),
        }
    }

    fn columns(self, groups: usize) -> Vec<Vec<f64>> {
        let column = |f: &dyn Fn(usize) -> f64| (0..groups).map(f).collect::<Vec<f64>>();
        let turn = |i: usize, k: usize| PI * k as f64 * (i as f64 + 0.5) / groups as f64;
        match self {
            Form::Line => vec![column(&|i| 2.0 * (i as f64 + 0.5) / groups as f64 - 1.0)],
            Form::Decay(k) => {
                let time = SHORTEST_DECAY_SHARE * 1.5f64.powf(k as f64);
                vec![column(&|i| (-(i as f64 + 0.5) / (groups as f64 * time)).exp())]
            }
            Form::Waves(order) => (1..=order).map(|k| column(&|i| turn(i, k).cos())).collect(),
            Form::Step(at) => vec![column(&|i| f64::from(u8::from(i >= at)))],
            Form::Stretch(from, to) => vec![column(&|i| f64::from(u8::from(i >= from && i < to)))],
            Form::Periodic(k) => vec![column(&|i| turn(i, k).cos()), column(&|i| turn(i, k).sin())],
        }
    }
}

/// Independent instants at which one change is looked for in so many samples.
pub(super) fn instants_of_change(samples: usize) -> f64 {
    let size = samples.div_ceil(MAX_TIME_GROUPS).max(MIN_GROUP_SAMPLES);
    let (_, _, trials) = Form::Step(0).counts(samples.div_ceil(size));
    trials
}

/// The best form over time, if any gains.
pub(super) fn over_time(residual: &FlatResidual<'_>, samples: &[usize]) -> Option<LevelLaw> {
    let (n, drivers) = (residual.flat.len(), residual.drivers);
    let size = n.div_ceil(MAX_TIME_GROUPS).max(MIN_GROUP_SAMPLES);
    let mut sums = vec![(0.0, 0.0); n.div_ceil(size)];
    for i in samples {
        let sum = &mut sums[i / size];
        sum.0 += residual.flat[*i].powi(2);
        sum.1 += 1.0;
    }
    // A group without rows weighs nothing.
    let groups: Vec<Group> = sums
        .iter()
        .map(|(square, dof)| Group { square: if *dof > 0.0 { square / dof } else { 1.0 }, dof: *dof })
        .collect();
    let j = groups.len();
    let mut forms = vec![Form::Line, Form::Waves(2), Form::Waves(4), Form::Waves(8)];
    forms.extend((0..DECAY_TIMES).map(Form::Decay));
    forms.extend(changes(&groups));
    forms.extend(period(&groups));
    let rows = (samples.len() as f64).ln();
    let fits: Vec<(Form, GammaFit)> =
        forms.into_iter().filter_map(|form| Some((form, fit(&groups, &form.columns(j))?))).collect();
    let score = |(form, f): &(Form, GammaFit)| 2.0 * f.gain - form.counts(j).1 as f64 * rows;
    let contrast = |(form, f): &(Form, GammaFit)| contrast(&f.log_squares, &f.covariance, &form.columns(j));
    let of_forms: Vec<(f64, [f64; 2])> = fits.iter().map(|f| (score(f), contrast(f).1)).collect();
    let fitted = fits.into_iter().max_by(|a, b| score(a).total_cmp(&score(b)))?;
    let (ratio, of_best) = contrast(&fitted);
    let ci95 = contrast_of_forms(&of_forms).unwrap_or(of_best);
    let (form, best) = fitted;
    let (free, parameters, trials) = form.counts(j);
    let middle = |g: usize| drivers.time_s(0) + ((g as f64 + 0.5) * size as f64 - 0.5) * drivers.dt_s;
    let edge = |g: usize| drivers.time_s(0) + (g as f64 * size as f64 - 0.5) * drivers.dt_s;
    let levels: Vec<f64> = best.log_squares.iter().map(|l| (0.5 * l).exp()).collect();
    let sharp = match form {
        Form::Step(at) => vec![at],
        Form::Stretch(from, to) => vec![from, to],
        _ => vec![],
    };
    let end = edge(0).max(drivers.time_s(n - 1));
    let knots = if sharp.is_empty() {
        let mut knots: Vec<Knot> =
            levels.iter().enumerate().map(|(g, l)| Knot { at: middle(g), value: *l }).collect();
        knots.last_mut().iter_mut().for_each(|k| k.at = k.at.min(end));
        knots
    } else {
        sharp_knots(&sharp, &levels, edge(0), end, drivers.dt_s, edge)
    };
    let (from, to) = match form {
        Form::Line => (edge(0), end),
        Form::Stretch(from, to) => (edge(from), edge(to).min(end)),
        _ => {
            let starts: Vec<f64> = (0..j).map(edge).collect();
            let raised = raised(&starts, &best.log_squares);
            (raised.low, (raised.high + size as f64 * drivers.dt_s).min(end))
        }
    };
    Some(LevelLaw {
        profile: (0..n).map(|i| between(&knots, drivers.time_s(i))).collect(),
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
) -> Vec<Knot> {
    let level = |g: usize| levels.get(g).copied().unwrap_or(1.0);
    let knot = |at: f64, value: f64| Knot { at, value };
    let mut out = vec![knot(start, level(0))];
    for at in changes.iter().filter(|at| **at > 0 && **at < levels.len()) {
        // A quarter of a sample on either side: no sample lies between.
        out.push(knot(edge(*at) - 0.25 * dt_s, level(at - 1)));
        out.push(knot(edge(*at) + 0.25 * dt_s, level(*at)));
    }
    out.push(knot(end, level(levels.len() - 1)));
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
        if dof < MIN_SIDE_SAMPLES || rest < MIN_SIDE_SAMPLES || inside <= 0.0 || outside <= 0.0 {
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
    let level = mean_square(groups);
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

#[cfg(test)]
mod tests {
    use super::*;

    fn groups(level: impl Fn(usize) -> f64) -> Vec<Group> {
        (0..64).map(|i| Group { square: level(i), dof: 100.0 }).collect()
    }

    #[test]
    fn the_best_change_is_where_the_level_changes() {
        let step = changes(&groups(|i| if i < 20 { 1.0 } else { 2.0 }));
        assert_eq!(step.first(), Some(&Form::Step(20)));
        let stretch = changes(&groups(|i| if (10..15).contains(&i) { 3.0 } else { 1.0 }));
        assert!(stretch.contains(&Form::Stretch(10, 15)), "{stretch:?}");
        assert!(changes(&groups(|_| 1.0)).is_empty());
    }

    #[test]
    fn the_period_is_counted_in_half_waves_of_the_record() {
        let wave = |i: usize| 1.0 + 0.5 * (PI * 14.0 * (i as f64 + 0.5) / 64.0).sin();
        assert_eq!(period(&groups(wave)), Some(Form::Periodic(14)));
    }

    #[test]
    fn a_sharp_change_is_one_within_half_a_sample() {
        let knots = sharp_knots(&[2], &[1.0, 1.0, 3.0, 3.0], 0.0, 40.0, 1.0, |g| 10.0 * g as f64);
        let told: Vec<(f64, f64)> = knots.iter().map(|k| (k.at, k.value)).collect();
        assert_eq!(told, [(0.0, 1.0), (19.75, 1.0), (20.25, 3.0), (40.0, 3.0)]);
        // A step in the middle of 64 groups has one coefficient and one instant, sought among 64.
        assert_eq!(Form::Step(32).counts(64), (1, 2, 64.0));
        assert_eq!(Form::Line.columns(4), [[-0.75, -0.25, 0.25, 0.75]]);
    }

    #[test]
    fn a_step_of_the_level_is_placed_between_its_samples() {
        let drivers =
            crate::effect::Drivers { dt_s: 2.0, start_s: 100.0, samples: 1024, ..Default::default() };
        let residual = FlatResidual {
            white: vec![],
            flat: (0..1024).map(|i| if i < 512 { 1.0 } else { -2.0 }).collect(),
            per_deg_h: 1.0,
            ends: 0,
            usable: &[],
            drivers: &drivers,
            rounding_step: 0.0,
        };
        let samples: Vec<usize> = (0..1024).collect();
        let law = over_time(&residual, &samples).unwrap();
        let Law::Time(knots) = &law.law else { panic!("a law over time") };
        // Sample 512 lies at 1124 s, the one before at 1122 s; the last at 2146 s.
        let wanted = [(99.0, 1.0), (1122.5, 1.0), (1123.5, 2.0), (2146.0, 2.0)];
        assert_eq!(knots.len(), 4);
        for (knot, (at, value)) in knots.iter().zip(wanted) {
            assert!((knot.at - at).abs() < 1e-9 && (knot.value - value).abs() < 1e-4, "{knot:?}");
        }
        assert!((law.profile[511] - 1.0).abs() < 1e-4 && (law.profile[512] - 2.0).abs() < 1e-4);
        assert!((law.ratio - 2.0).abs() < 1e-4 && law.dispersion == 1.0);
        assert_eq!((law.free, law.parameters, law.trials), (1, 2, 64.0));
        // ½ (1024 ln 2.5 − 512 ln 4).
        assert!((law.gain - (512.0 * 2.5f64.ln() - 256.0 * 4f64.ln())).abs() < 1e-4, "{}", law.gain);
        assert!((law.place.from - 1123.0).abs() < 1e-9 && (law.place.to - 2146.0).abs() < 1e-9);
        // Every other row alone: the same levels from half of the values.
        let half: Vec<usize> = (0..1024).step_by(2).collect();
        assert!((over_time(&residual, &half).unwrap().ratio - 2.0).abs() < 1e-4);
    }

    #[test]
    fn a_level_of_nothing_on_one_side_is_no_change() {
        // Against groups of zero any level would gain without end: the change that is found keeps one group of the rest.
        let dead = changes(&groups(|i| f64::from(u8::from(i >= 20))));
        assert_eq!(dead.first(), Some(&Form::Step(21)));
        let hole = changes(&groups(|i| f64::from(u8::from(!(20..30).contains(&i)))));
        assert!(!hole.contains(&Form::Stretch(20, 30)), "{hole:?}");
        // A side of fewer samples than 48 is none either.
        let few: Vec<Group> =
            (0..64).map(|i| Group { square: if i < 60 { 1.0 } else { 9.0 }, dof: 8.0 }).collect();
        assert_eq!(changes(&few).first(), Some(&Form::Step(58)));
    }
}
