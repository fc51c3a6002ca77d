//! Scale factor error and bias of positions against the Earth's rotation.

use super::evaluation::blocks_of;
use crate::bench::EARTH;
use crate::bench::chance::{Chance, Noise, noise};
use crate::coverage::{Coverage, over_seeds};
use crate::study::{Asked, Case};
use nalgebra::{DMatrix, DVector};
use sagnac::measurand::{KnownInputEvidence, SCALE_FACTOR_BIAS, SCALE_FACTOR_ERROR};
use sagnac::noise::static_bias::{Orientation, Uncertain, earth_rate};
use sagnac::rate_table::known;
use sagnac::rate_table::noise::Rows;
use sagnac::rate_table::setup::{Input, ReferenceInput};
use sagnac::recording::Role;

const LATITUDE: f64 = 55.98;
/// Standard uncertainties of headings and elevations, deg.
const OFF: (f64, f64) = (0.1, 0.02);
/// Kinds of noise.
pub const KINDS: [(&str, Noise); 3] = [
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
fn in_positions(model: Noise, seed: u64) -> [Coverage; 2] {
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
    let evidence = KnownInputEvidence { positions: &[found], turns: None };
    let error = &SCALE_FACTOR_ERROR.evaluate_known_input(&evidence)[0];
    let offset = &SCALE_FACTOR_BIAS.evaluate_known_input(&evidence)[0];
    [
        Coverage::of(Some(error), error_ppm, Some(1e6 * told_factor)),
        Coverage::of(Some(offset), bias + drift, Some(told_bias)),
    ]
}

/// Standard uncertainties of bias and factor of a fit given the strengths of the noise. `inputs` have theirs.
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
    let of = (x.transpose() * v.try_inverse().expect("a design") * x).try_inverse().expect("a design");
    [of[(0, 0)].sqrt(), of[(1, 1)].sqrt()]
}

/// Scale factor error and bias of many tests in positions.
pub fn positions_study(model: Noise, runs: u64, first: u64) -> [Coverage; 2] {
    over_seeds(first, runs, |seed| in_positions(model, seed))
}

pub(super) fn cases() -> Vec<Case> {
    let case = |(kind, model): (&str, Noise)| {
        Case::new(format!("twelve positions, {kind}"), move |records, seed| {
            let [error, bias] = positions_study(model, records, 1_000_000 + 100_000_000 * (seed - 1));
            [error.rows("scale_factor_error", Asked::Nothing), bias.rows("scale_factor_bias", Asked::Nothing)]
                .concat()
        })
    };
    KINDS.into_iter().map(case).collect()
}
