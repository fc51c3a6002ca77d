//! Whether the rate was rounded so coarsely that its noise does not carry it from step to step.
//!
//! Rounding of angle increments carries its remainder on, and means lose nothing. Rounding of a rate forgets it: unless noise moves
//! the rate by about half a step from sample to sample, the noise that is left is that of the steps, or none at all.

use super::affected::NOISE_MEASURANDS;
use crate::estimate::{Finding, Holds};
use crate::evidence::GyroEvidence;
use crate::message::note;
use crate::noise::coarse::RateRounding;

/// Finds a rate that noise does not carry from step to step.
pub(super) fn examine(gyro: &GyroEvidence) -> Vec<Finding> {
    let (found, more) = match gyro.rounding {
        RateRounding::Harmless => return vec![],
        RateRounding::Forgotten { step_deg_h } => {
            (note!("criticism_found.rate_rounding", step = step_deg_h), None)
        }
        RateRounding::Constant => (note!("criticism_found.constant_rate"), Some("static_bias")),
    };
    let advice = note!("criticism_advice.rate_rounding");
    let measurands = NOISE_MEASURANDS.into_iter().chain(more).collect();
    vec![Finding { measurands, holds: Holds::Nothing, found, advice }]
}
