//! Simulated units as the comparison sees them.
#![allow(dead_code, reason = "each test file uses its own part")]

use sagnac::measurand::GyroEvidence;
use sagnac::noise::composite::{Composite, Sampling};
use sagnac::noise::digest::{DigestPlan, RateAccumulator};
use sagnac::noise::family::Estimator;
use sagnac::noise::intervals::bounded;
use sagnac::noise::motion::Motion;
use sagnac::noise::simulate::{Setup, Simulator};
use sagnac::noise::spectral_record::SpectralRecord;

/// A simulated record as one pass leaves it, with what was identified from it.
pub fn simulate(model: &Composite, hours: f64, tau0_s: f64, seed: u64) -> GyroEvidence {
    let count = (hours * 3600.0 / tau0_s).round() as usize;
    let setup = Setup { bias_deg_h: 0.37, ..Setup::for_record(seed, tau0_s, count as u64) };
    let samples = Simulator::of(model, &setup).take(count);
    let mut pass = RateAccumulator::new(DigestPlan::new(tau0_s));
    pass.push(&samples, 0, false);
    let digest = pass.finish();
    let record = SpectralRecord {
        blocks: &digest.blocks,
        welch: Some(&digest.welch.spectrum),
        tau0_s,
        lines: &[],
        sampling: Sampling::Averaging,
    };
    let identification = record.identify("rate").ranged.identification;
    let curve = digest.deviations.curve(Estimator::Allan).expect("the overlapping Allan deviation");
    let octaves: Vec<_> = curve
        .points
        .iter()
        .map(|p| {
            let noise = identification.supported.dominant(p.m as f64 * tau0_s);
            bounded(Estimator::Allan, p, &curve.stretches, noise)
        })
        .collect();
    GyroEvidence {
        goodness: Default::default(),
        channel: "rate".into(),
        several: false,
        tau0_s,
        longest_stretch_s: count as f64 * tau0_s,
        sigma_tau: octaves.clone(),
        octaves,
        digest,
        identification,
        lines: vec![],
        withheld_line: None,
        motion: Motion::Unknown,
        earth: None,
        over_temperature: None,
        warm_up: None,
    }
}

pub fn share(a: usize, b: usize) -> f64 {
    a as f64 / b.max(1) as f64
}

/// The quantile of a sample.
pub fn quantile(values: &mut [f64], p: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let at = (p * (values.len() - 1) as f64).round() as usize;
    values.get(at).copied().unwrap_or(f64::NAN)
}

/// A number from the environment.
pub fn from_env(name: &str, otherwise: u64) -> u64 {
    std::env::var(name).ok().and_then(|r| r.parse().ok()).unwrap_or(otherwise)
}
