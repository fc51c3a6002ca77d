//! Whether the rate was rounded so coarsely that its noise does not carry it from step to step.
//!
//! Rounding of angle increments carries its remainder on, and means lose nothing. Rounding of a rate forgets it: unless noise moves
//! the rate by about half a step from sample to sample, the noise that is left is that of the steps.

use super::affected::NOISE;
use crate::estimate::{Finding, Holds};
use crate::evidence::GyroEvidence;
use crate::message::Note;

/// Finds a rate that noise does not carry from step to step.
pub(super) fn examine(gyro: &GyroEvidence) -> Vec<Finding> {
    let Some(step_deg_h) = gyro.forgotten_step_deg_h else { return vec![] };
    vec![Finding {
        measurands: NOISE.to_vec(),
        holds: Holds::Nothing,
        found: Note::new("criticism_found.rate_rounding").with("step", step_deg_h),
        advice: Note::new("criticism_advice.rate_rounding"),
    }]
}
