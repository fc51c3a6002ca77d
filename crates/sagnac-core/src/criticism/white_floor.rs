//! Whether the white noise of a record is seen where its limit is read from.
//!
//! A process, a resonance or a filter can stand for the white floor of a record. Where the record is too short for a level beyond
//! them, what the fit leaves to white noise says nothing of that level.

use crate::estimate::{Finding, Holds};
use crate::evidence::GyroEvidence;
use crate::message::{Arg, note};
use crate::noise::composite::{Composite, Part};
use crate::noise::data::NoiseType;
use std::f64::consts::PI;

/// Lengths of the memory of an output that a record must have for its white level to be read.
const MIN_LENGTH_IN_MEMORIES: f64 = 50.0;
/// Share of the Allan variance that white noise must have at some averaging time to be seen.
const MIN_SHARE: f64 = 0.5;

/// Finds that no white level is seen.
pub(super) fn examine(gyro: &GyroEvidence) -> Vec<Finding> {
    let found = &gyro.identification;
    let model = found.described.model.without_lines();
    let memories = model.markov.iter().chain(&model.quasi_periodic).map(|d| d.decay_time_s);
    let filter = model.bandwidth.map(|f| 1.0 / (2.0 * PI * f.cutoff_hz(gyro.tau0_s)));
    let Some(shortest_s) = memories.chain(filter).reduce(f64::min) else { return vec![] };
    if found.plateau.is_some() || found.angle_random_walk.value.is_some() && is_seen(gyro, &model) {
        return vec![];
    }
    vec![Finding {
        measurands: vec!["angle_random_walk", "angle_random_walk_white"],
        holds: Holds::Nothing,
        found: note!(
            "criticism_found.white_floor",
            memory_s = Arg::rounded(shortest_s, 2),
            length_s = Arg::rounded(gyro.usable_s(), 3)
        ),
        advice: note!(
            "criticism_advice.white_floor",
            length_s = Arg::rounded(MIN_LENGTH_IN_MEMORIES * shortest_s.max(gyro.tau0_s), 2)
        ),
    }]
}

/// Whether white noise makes most of the curve of the model anywhere.
fn is_seen(gyro: &GyroEvidence, model: &Composite) -> bool {
    let white = Part::Term(NoiseType::AngleRandomWalk);
    gyro.octaves.iter().any(|p| {
        let tau_s = p.point.m as f64 * gyro.tau0_s;
        let own = model.part_allan_variance(white, tau_s, gyro.tau0_s);
        own >= MIN_SHARE * model.allan_variance(tau_s, gyro.tau0_s)
    })
}
