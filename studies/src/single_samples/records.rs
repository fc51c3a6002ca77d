//! Records of simulated noise, changed and set against a claim of the noise alone.

use sagnac::config::model::{Claim, Uncertainty};
use sagnac::effect::{ClaimedMean, Column, Detector, Jumps, Outliers, find};
use sagnac::mismatch::fitted_hypothesis::FittedHypothesis;
use sagnac::mismatch::jumps::jumps;
use sagnac::mismatch::problem::Problem;
use sagnac::mismatch::regular::Regular;
pub use sagnac::mismatch::samples::levels;
use sagnac::mismatch::samples::outliers;
use sagnac::noise::model::NoiseModel;
use sagnac::noise::simulate::{Setup, Simulator};
use std::collections::BTreeMap;

/// Noise at 10 Hz.
#[derive(Debug, Clone, Copy)]
pub struct Model {
    /// deg/√h.
    pub n: f64,
    /// deg/h.
    pub b: f64,
    /// deg/h/√h.
    pub k: f64,
}

/// White noise of 0.57 deg/h a sample.
pub const WHITE: Model = Model { n: 0.003, b: 0.0, k: 0.0 };
/// With flicker.
pub const FLICKER: Model = Model { n: 0.003, b: 0.05, k: 0.0 };
/// With a random walk.
pub const WALK: Model = Model { n: 0.003, b: 0.0, k: 0.3 };

/// Sample rate, Hz.
pub const RATE_HZ: f64 = 10.0;

impl Model {
    /// Deviation of the white noise of a sample, deg/h.
    pub fn sigma(self) -> f64 {
        60.0 * self.n * RATE_HZ.sqrt()
    }

    /// Its own claim.
    pub fn claim(self) -> Claim {
        Claim {
            case: String::new(),
            description: Default::default(),
            sample_rate_hz: RATE_HZ,
            columns: None,
            noise: NoiseModel { n: self.n, b: self.b, k: self.k, ..NoiseModel::default() },
            quantization_lsb_arcsec: 0.0,
            mean: ClaimedMean::default(),
            uncertainty: Uncertainty { n_rel: 0.015, b_rel: 0.12, k_rel: 0.15, ..Uncertainty::default() },
            effects: vec![],
        }
    }

    /// A draw of it, deg/h.
    pub fn draw(self, samples: usize, seed: u64) -> Vec<f64> {
        let noise = NoiseModel { n: self.n, b: self.b, k: self.k, ..NoiseModel::default() };
        let setup = Setup::for_record(seed, 1.0 / RATE_HZ, samples as u64);
        Simulator::new(&noise, &setup).take(samples)
    }

    /// A draw that `change` changed, against the claim of the noise alone.
    pub fn problem(
        self,
        samples: usize,
        seed: u64,
        change: impl Fn(&mut [f64]),
    ) -> (Problem, FittedHypothesis) {
        self.with_columns(samples, seed, &BTreeMap::new(), change)
    }

    /// The same with columns.
    pub fn with_columns(
        self,
        samples: usize,
        seed: u64,
        columns: &BTreeMap<Column, Vec<f64>>,
        change: impl Fn(&mut [f64]),
    ) -> (Problem, FittedHypothesis) {
        let mut rate = self.draw(samples, seed);
        change(&mut rate);
        against(&self.claim(), &rate, columns)
    }
}

/// A record against a claim.
pub fn against(
    claim: &Claim,
    rate: &[f64],
    columns: &BTreeMap<Column, Vec<f64>>,
) -> (Problem, FittedHypothesis) {
    let time: Vec<f64> = (0..rate.len()).map(|i| i as f64 / RATE_HZ).collect();
    let columns = columns.iter().map(|(c, v)| (*c, v.as_slice())).collect();
    let regular = Regular::new(&time, rate, &columns, RATE_HZ).expect("a regular record");
    let problem = Problem::new(&regular, claim);
    let tried = problem.baseline();
    (problem, tried)
}

/// Bursts in the residual of a hypothesis.
pub fn bursts(problem: &Problem, tried: &FittedHypothesis) -> Option<Outliers> {
    let Some(Detector::Outliers(detector)) = find("outlier_bursts")?.detector() else { return None };
    outliers(detector, problem, tried)
}

/// Jumps between two levels in the residual of a hypothesis.
pub fn telegraph(problem: &Problem, tried: &FittedHypothesis) -> Option<Jumps> {
    let Some(Detector::Jumps(detector)) = find("random_telegraph")?.detector() else { return None };
    jumps(detector, problem, tried)
}
