//! Whether a single step of the level explains what was taken for slow noise: its spectrum is that of a random walk.

use super::affected::SLOW_NOISE;
use crate::estimate::{Finding, Holds};
use crate::evidence::GyroEvidence;
use crate::message::{Arg, Note, note};
use crate::noise::residual::{Jump, View};

/// Log-likelihood by which a step must explain the record better than slow noise, nats: a walk that a record barely shows is
/// about as likely as a step.
const MIN_ADVANTAGE_NATS: f64 = 2.0;

/// Finds the step, beside the slow noise of the model or in its place. What it adds makes slow noise look larger, so that an
/// upper bound still holds.
pub(super) fn examine(gyro: &GyroEvidence) -> Vec<Finding> {
    let found = &gyro.identification;
    let slow = [&found.bias_instability, &found.rate_random_walk, &found.rate_ramp];
    if slow.iter().all(|e| e.value.is_none()) {
        return vec![];
    }
    let Some(whitened) = &gyro.goodness.whitened else { return vec![] };
    let beside = gyro.goodness.failures().iter().any(|j| j.view == View::Jump);
    let beside = whitened.jump.filter(|_| beside).map(|jump| (jump, whitened.step_s));
    let instead = whitened.jump_instead.filter(|i| i.advantage >= MIN_ADVANTAGE_NATS);
    let Some((jump, step_s)) = beside.or(instead.map(|i| (i.jump, i.step_s))) else { return vec![] };
    vec![Finding {
        measurands: SLOW_NOISE.to_vec(),
        holds: Holds::UpperBound,
        found: found_at(&jump, jump.time_s(step_s, whitened.from_s)),
        advice: note!("criticism_advice.step"),
    }]
}

fn found_at(jump: &Jump, time_s: f64) -> Note {
    note!(
        "criticism_found.step",
        time_s = Arg::rounded(time_s, 6),
        size = Arg::figures(jump.size_deg_h, 3),
        deviations = Arg::rounded(jump.score.abs(), 2)
    )
}
