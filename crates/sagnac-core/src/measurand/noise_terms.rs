//! N, B, K, R and Q of the joint fit (IEEE Std 952 Annex C).

use super::{GyroEvidence, Measurand, Options};
use crate::estimate::Estimate;

pub(super) struct NoiseTerms;

/// Id of the white noise alone.
const WHITE_PART: &str = "angle_random_walk_white";

impl Measurand for NoiseTerms {
    fn ids(&self) -> &'static [&'static str] {
        &[
            "angle_random_walk",
            WHITE_PART,
            "bias_instability",
            "rate_random_walk",
            "rate_ramp",
            "quantization",
        ]
    }

    fn evaluate(&self, id: &str, gyro: &GyroEvidence, _: &Options) -> Option<Estimate> {
        let found = &gyro.identification;
        match id {
            "angle_random_walk" => Some(found.read_angle_random_walk().clone()),
            WHITE_PART => Some(Estimate { id: WHITE_PART, ..found.angle_random_walk.clone() }),
            _ => found.estimates().into_iter().find(|e| e.id == id).cloned(),
        }
    }
}
