//! Positions against the Earth's rotation and turns of a triad by known angles: whether their intervals hold what went in.

use super::bench::EARTH;
use super::judged::Count;
use super::{asked, blocks_of};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use sagnac::measurand::{
    CROSS_AXIS, KnownInputEvidence, SCALE_FACTOR, SCALE_FACTOR_BIAS, SCALE_FACTOR_ERROR,
};
use sagnac::noise::static_bias::{Orientation, Uncertain, earth_rate};
use sagnac::rate_table::known;
use sagnac::rate_table::noise::Rows;
use sagnac::rate_table::setup::{Input, ReferenceInput};
use sagnac::rate_table::turns;
use sagnac::recording::Role;

#[path = "../thermal_study/chamber/mod.rs"]
mod chamber;

use chamber::{Chance, Noise, noise};

const LATITUDE: f64 = 55.98;
/// Standard uncertainties of headings and elevations, deg.
const OFF: (f64, f64) = (0.1, 0.02);
const KINDS: [(&str, Noise); 3] = [
    ("white", Noise { n: 0.003, b: 0.0, k: 0.0 }),
    ("flicker", Noise { n: 0.003, b: 0.006, k: 0.0 }),
    ("walk", Noise { n: 0.003, b: 0.003, k: 0.02 }),
];

/// Earth rate along a direction, deg/h, from its vectors: north, east, up.
fn along(heading: f64, elevation: f64) -> f64 {
    let (h, e, l) = (heading.to_radians(), elevation.to_radians(), LATITUDE.to_radians());
    let axis = [e.cos() * h.cos(), e.cos() * h.sin(), e.sin()];
    let earth = [EARTH * l.cos(), 0.0, EARTH * l.sin()];
    axis.iter().zip(earth).map(|(a, e)| a * e).sum()
}

/// Scale factor error and bias of six positions, ten minutes each, twice.
fn in_positions(model: Noise, seed: u64) -> [Count; 2] {
    const POSITIONS: [(f64, f64); 6] =
        [(0.0, 90.0), (0.0, -90.0), (0.0, 0.0), (180.0, 0.0), (90.0, 0.0), (270.0, 0.0)];
    const EACH_S: usize = 600;
    let mut chance = Chance::new(seed);
    let (error_ppm, bias) = (4000.0, 0.4);
    let positions: Vec<(f64, f64)> = POSITIONS.iter().chain(&POSITIONS).copied().collect();
    let mut y = noise(Noise { n: 0.0, ..model }, 1.0, EACH_S * positions.len(), &mut chance);
    // What drifts has no mean of its own: that of the test is a part of its bias.
    let drift = y.iter().sum::<f64>() / y.len() as f64;
    let mut list = vec![];
    for (k, (heading, elevation)) in positions.iter().enumerate() {
        let input = along(heading + OFF.0 * chance.normal(), elevation + OFF.1 * chance.normal());
        for v in &mut y[k * EACH_S..(k + 1) * EACH_S] {
            *v += (1.0 + 1e-6 * error_ppm) * input + bias + 60.0 * model.n * chance.normal();
        }
        list.push(ReferenceInput {
            phase: None,
            from_s: Some((k * EACH_S) as f64),
            to_s: Some(((k + 1) * EACH_S) as f64),
            channel: None,
            input: Input::Position { heading: (*heading, OFF.0), elevation: (*elevation, OFF.1) },
        });
    }
    let blocks = blocks_of(vec![("rate", Role::Rate, y)], 1.0);
    let expected = |heading: (f64, f64), elevation: (f64, f64)| {
        let uncertain = |(value, uncertainty)| Uncertain { value, uncertainty };
        let rate = earth_rate(&Orientation {
            latitude_deg: uncertain((LATITUDE, 0.0)),
            heading_deg: uncertain(heading),
            elevation_deg: uncertain(elevation),
        });
        (rate.value, rate.uncertainty)
    };
    let stretches = known::stretches(&blocks, &list, &[]);
    let found = known::positions(&blocks, &list, &stretches, 0, &expected).expect("positions");
    let inputs: Vec<(f64, f64)> = positions.iter().map(|(h, e)| expected((*h, OFF.0), (*e, OFF.1))).collect();
    let [told_bias, told_factor] = told(model, &inputs, EACH_S as f64);
    let mut counts = [Count::default(), Count::default()];
    let evidence = KnownInputEvidence { positions: &[found], turns: None };
    let error = &SCALE_FACTOR_ERROR.evaluate_known_input(&evidence)[0];
    counts[0].take(error, error_ppm, Some(1e6 * told_factor));
    counts[1].take(&SCALE_FACTOR_BIAS.evaluate_known_input(&evidence)[0], bias + drift, Some(told_bias));
    counts
}

/// Standard uncertainties of bias and factor of a fit that is told the strengths of the noise. `inputs` have theirs.
fn told(model: Noise, inputs: &[(f64, f64)], each_s: f64) -> [f64; 2] {
    let rows = Rows {
        mid_s: (0..inputs.len()).map(|k| (k as f64 + 0.5) * each_s).collect(),
        length_s: vec![each_s; inputs.len()],
        step: (0..inputs.len()).collect(),
    };
    let directions = DVector::from_iterator(inputs.len(), inputs.iter().map(|i| i.1 * i.1));
    let v = rows.white() * model.n.powi(2)
        + rows.flicker() * model.b.powi(2)
        + rows.random_walk() * model.k.powi(2)
        + DMatrix::from_diagonal(&directions);
    let x = DMatrix::from_fn(inputs.len(), 2, |i, j| if j == 0 { 1.0 } else { inputs[i].0 });
    let of = (x.transpose() * v.try_inverse().unwrap() * x).try_inverse().unwrap();
    [of[(0, 0)].sqrt(), of[(1, 1)].sqrt()]
}

/// A triad that is turned by known angles.
struct Triad {
    noise: Noise,
    /// True when every turn is made forth and back, which cancels what the Earth's rotation adds.
    back: bool,
    /// Standard uncertainty of an angle, deg.
    angle: f64,
}

/// A turn about an axis, deg.
#[derive(Clone, Copy)]
struct Turn {
    axis: usize,
    stated: f64,
    turned: f64,
}

/// Output of each axis per rate about each.
const MATRIX: [[f64; 3]; 3] = [[1.002, 0.0015, -0.0008], [-0.0011, 0.998, 0.0006], [0.0004, -0.0019, 1.0005]];
const BIAS: [f64; 3] = [12.0, -30.0, 5.0];

fn turned(v: [f64; 3], axis: usize, angle: f64) -> [f64; 3] {
    let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut out = v;
    // The Earth's vector in the frame of the unit turns against it.
    out[a] = v[a] * angle.cos() + v[b] * angle.sin();
    out[b] = v[b] * angle.cos() - v[a] * angle.sin();
    out
}

fn of_triad(triad: &Triad, seed: u64) -> [Count; 2] {
    const DT: f64 = 0.1;
    let mut chance = Chance::new(seed);
    let mut earth = [chance.normal(), chance.normal(), chance.normal()];
    let size = earth.iter().map(|v| v * v).sum::<f64>().sqrt();
    earth = earth.map(|v| EARTH * v / size);
    // Rest, and for each axis turns of 360 deg in 36 s with rests of 20 s.
    let turns: &[f64] = if triad.back { &[360.0, -360.0] } else { &[360.0] };
    let mut segments: Vec<(usize, Option<Turn>)> = vec![(3000, None)];
    for axis in 0..3 {
        for angle in turns {
            let turned = angle + triad.angle * chance.normal();
            segments.push((360, Some(Turn { axis, stated: *angle, turned })));
            segments.push((200, None));
        }
    }
    let total = segments.iter().map(|s| s.0).sum();
    let mut y: Vec<Vec<f64>> = (0..3).map(|_| noise(triad.noise, DT, total, &mut chance)).collect();
    let channels = ["rate_x", "rate_y", "rate_z"];
    let (mut at, mut list) = (0, vec![]);
    for (count, turn) in segments {
        let (from_s, to_s) = (Some(at as f64 * DT), Some((at + count) as f64 * DT));
        let input = match turn {
            Some(Turn { stated, .. }) => Input::Turn { angle: (stated, triad.angle) },
            None => Input::Rest,
        };
        let channel = turn.map(|t| channels[t.axis].to_owned());
        list.push(ReferenceInput { phase: None, from_s, to_s, channel, input });
        for i in at..at + count {
            let mut rate = earth;
            if let Some(Turn { axis, turned: angle, .. }) = turn {
                let per_sample = angle / count as f64;
                let half = turned(earth, axis, 0.5 * per_sample.to_radians());
                earth = turned(earth, axis, per_sample.to_radians());
                rate = half;
                rate[axis] += 3600.0 * per_sample / DT;
            }
            for (k, own) in y.iter_mut().enumerate() {
                own[i] += BIAS[k] + (0..3).map(|j| MATRIX[k][j] * rate[j]).sum::<f64>();
            }
        }
        at += count;
    }
    let blocks = blocks_of(channels.into_iter().zip(y).map(|(id, y)| (id, Role::Rate, y)).collect(), DT);
    let stretches = known::stretches(&blocks, &list, &[]);
    let found = turns::turns(&blocks, &list, &stretches).expect("turns");
    let mut counts = [Count::default(), Count::default()];
    let place = |name: &str| channels.iter().position(|c| *c == name).expect("a channel");
    let evidence = KnownInputEvidence { positions: &[], turns: Some(&found) };
    for e in SCALE_FACTOR.evaluate_known_input(&evidence) {
        let k = place(&e.channel);
        counts[0].take(&e, MATRIX[k][k], None);
    }
    for e in CROSS_AXIS.evaluate_known_input(&evidence) {
        let (output, axis) = e.channel.split_once("<-").expect("two axes");
        counts[1].take(&e, MATRIX[place(output)][place(axis)], None);
    }
    counts
}

fn together(all: Vec<[Count; 2]>) -> [Count; 2] {
    let mut sums = [Count::default(), Count::default()];
    for counts in all {
        for (sum, c) in sums.iter_mut().zip(counts) {
            sum.add(c);
        }
    }
    sums
}

fn positions_study(model: Noise, runs: u64, first: u64) -> [Count; 2] {
    together((first..first + runs).into_par_iter().map(|seed| in_positions(model, seed)).collect())
}

fn triads(triad: &Triad, runs: u64, first: u64) -> [Count; 2] {
    together((first..first + runs).into_par_iter().map(|seed| of_triad(triad, seed)).collect())
}

const LOUD: Noise = Noise { n: 0.3, b: 0.0, k: 0.0 };

#[test]
fn positions_and_turns_hold_what_went_in() {
    for (kind, model) in KINDS {
        for count in positions_study(model, 16, 300) {
            // Of 16 at 95 %, fewer than 12 come about less than once in 1000.
            assert!(count.errors.len() == 16 && count.held >= 12, "{kind} {}", count.held);
        }
    }
    let back = Triad { noise: LOUD, back: true, angle: 0.02 };
    let [own, cross] = triads(&back, 12, 300);
    assert!(own.errors.len() == 36 && own.held >= 29, "{}", own.held);
    assert!(cross.errors.len() == 72 && cross.held >= 60, "{}", cross.held);
}

#[test]
fn the_earths_rotation_widens_what_crosses_the_axis_of_a_turn_in_one_sense() {
    let quiet = Noise { n: 0.003, ..LOUD };
    let [own, cross] = triads(&Triad { noise: quiet, back: false, angle: 0.002 }, 20, 300);
    assert!(own.held >= 50 && cross.held >= 110, "{} {}", own.held, cross.held);
    // Forth and back nothing of it is left.
    let [_, both] = triads(&Triad { noise: quiet, back: true, angle: 0.002 }, 4, 300);
    assert!(both.widths.iter().all(|w| *w < 0.1 * cross.widths[0]), "{:?} {}", both.widths, cross.widths[0]);
}

#[test]
#[ignore = "SAGNAC_RUNS=n cargo test --release --test rate_table -- --ignored --nocapture long_study_of_positions"]
fn long_study_of_positions() {
    let (runs, first) = (asked("SAGNAC_RUNS", 1000), asked("SAGNAC_FIRST", 1_000_000));
    for (kind, model) in KINDS {
        let [error, bias] = positions_study(model, runs, first);
        error.say(&format!("positions, {kind}: scale factor error"));
        bias.say(&format!("positions, {kind}: bias"));
    }
    let with_flicker = Noise { b: 3.0, ..LOUD };
    for (kind, noise, back) in
        [("white", LOUD, true), ("flicker", with_flicker, true), ("white, one sense", LOUD, false)]
    {
        let [own, cross] = triads(&Triad { noise, back, angle: 0.02 }, runs, first);
        own.say(&format!("turns, {kind}: scale factor"));
        cross.say(&format!("turns, {kind}: cross-axis"));
    }
}
