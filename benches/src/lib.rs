//! The recording that is analysed by every bench, and bare kernels to compare with.

pub mod limits;

use sagnac::noise::model::NoiseModel;
use sagnac::noise::simulate::{Setup, Simulator};

/// Time between samples, s.
pub const TAU0_S: f64 = 0.01;

/// Angular rate in deg/h of a gyroscope at rest, one per sample; the same in every run.
#[must_use]
pub fn simulated_rate(samples: usize) -> Vec<f64> {
    let model = NoiseModel { n: 0.002, b: 0.004, ..Default::default() };
    Simulator::new(&model, &Setup::for_record(1, TAU0_S, samples as u64)).take(samples)
}
