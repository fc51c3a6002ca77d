//! Whether a single step of the level explains what was taken for slow noise: its spectrum is that of a random walk.

use super::affected::SLOW_NOISE;
use crate::estimate::{Finding, Holds};
use crate::evidence::GyroEvidence;
use crate::message::{Arg, Note};
use crate::noise::residual::View;

/// Finds the step. What it adds makes slow noise look larger, so that an upper bound still holds.
pub(super) fn examine(gyro: &GyroEvidence) -> Vec<Finding> {
    let found = &gyro.identification;
    let slow = [&found.bias_instability, &found.rate_random_walk, &found.rate_ramp];
    let failures = gyro.goodness.failures();
    let Some(jump) = failures.iter().find(|j| j.view == View::Jump) else { return vec![] };
    if slow.iter().all(|e| e.value.is_none()) {
        return vec![];
    }
    vec![Finding {
        measurands: SLOW_NOISE.to_vec(),
        holds: Holds::UpperBound,
        found: Note::new("criticism_found.step")
            .with("time_s", Arg::rounded(0.5 * (jump.departure.from + jump.departure.to), 6))
            .with("size", Arg::figures(jump.departure.excess, 3))
            .with("deviations", Arg::rounded(jump.statistic.abs(), 2)),
        advice: Note::new("criticism_advice.step"),
    }]
}
