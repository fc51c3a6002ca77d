//! N, B, K, R and Q of the joint fit (IEEE Std 952 Annex C).

use super::{GyroEvidence, Measurand, Options};
use crate::estimate::Estimate;

pub(super) struct NoiseTerms;

impl Measurand for NoiseTerms {
    fn ids(&self) -> &'static [&'static str] {
        &["angle_random_walk", "bias_instability", "rate_random_walk", "rate_ramp", "quantization"]
    }

    fn evaluate(&self, id: &str, gyro: &GyroEvidence, _: &Options) -> Option<Estimate> {
        gyro.identification.estimates().into_iter().find(|e| e.id == id).cloned()
    }
}
