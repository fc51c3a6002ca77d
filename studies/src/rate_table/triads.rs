//! Scale factors and cross-axis terms of a triad that is turned by known angles.

use super::evaluation::blocks_of;
use crate::bench::EARTH;
use crate::bench::chance::{Chance, Noise, noise};
use crate::coverage::{Coverage, over_seeds};
use crate::study::{Asked, Case};
use sagnac::measurand::{CROSS_AXIS, KnownInputEvidence, SCALE_FACTOR};
use sagnac::rate_table::setup::{Input, ReferenceInput};
use sagnac::rate_table::{known, turns};
use sagnac::recording::Role;

/// A triad that is turned by known angles.
pub struct Triad {
    /// Noise of every axis.
    pub noise: Noise,
    /// True when every turn is made forth and back, which cancels what the Earth's rotation adds.
    pub back: bool,
    /// Standard uncertainty of an angle, deg.
    pub angle: f64,
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

fn of_triad(triad: &Triad, seed: u64) -> [Coverage; 2] {
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
    let mut counts = [Coverage::default(), Coverage::default()];
    let place = |name: &str| channels.iter().position(|c| *c == name).expect("a channel");
    let evidence = KnownInputEvidence { positions: &[], turns: Some(&found) };
    for e in SCALE_FACTOR.evaluate_known_input(&evidence) {
        let k = place(&e.channel);
        counts[0].take(Some(&e), MATRIX[k][k], None);
    }
    for e in CROSS_AXIS.evaluate_known_input(&evidence) {
        let (output, axis) = e.channel.split_once("<-").expect("two axes");
        counts[1].take(Some(&e), MATRIX[place(output)][place(axis)], None);
    }
    counts
}

/// Scale factors and cross-axis terms of many tests.
pub fn triads(triad: &Triad, runs: u64, first: u64) -> [Coverage; 2] {
    over_seeds(first, runs, |seed| of_triad(triad, seed))
}

/// White noise of a triad.
pub const LOUD: Noise = Noise { n: 0.3, b: 0.0, k: 0.0 };

pub(super) fn cases() -> Vec<Case> {
    let with_flicker = Noise { b: 3.0, ..LOUD };
    let case = |(kind, noise, back): (&str, Noise, bool)| {
        Case::new(format!("turns of 360°, {kind}"), move |records, seed| {
            let triad = Triad { noise, back, angle: 0.02 };
            let [own, cross] = triads(&triad, records, 1_000_000 + 100_000_000 * (seed - 1));
            [own.rows("scale_factor", Asked::Nothing), cross.rows("cross_axis", Asked::Nothing)].concat()
        })
    };
    [
        ("white, forth and back", LOUD, true),
        ("flicker, forth and back", with_flicker, true),
        ("white, one sense", LOUD, false),
    ]
    .into_iter()
    .map(case)
    .collect()
}
