//! The course of something that was not recorded, as knots that a claim can state.

use super::problem::Problem;
use super::tried::Tried;
use crate::effect::{Value, Values};
use crate::numeric::cosine::inverse_dct2;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::collections::BTreeMap;

/// Knots at most.
const KNOTS: usize = 512;
/// Seed of the draw.
const SEED: u64 = 0x5a67_6e61_6320_0006;

/// The course of a smooth process of a hypothesis at knots. A draw of what it may have been given the record, not the
/// expectation: what the expectation leaves of the record is quieter than the noise, and the claim would not fit.
pub fn knots(best: &Tried, index: usize, problem: &Problem) -> Values {
    let spectral = &problem.spectra.full;
    let own = spectral.powers(&best.hypothesis.noise.part_densities(index, spectral));
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(SEED);
    let (residual, powers) = (best.residual(&problem.spectra), best.powers(&problem.spectra));
    let modes = residual.iter().zip(own.iter().zip(&powers)).map(|(x, (s, p))| {
        let z: f64 = StandardNormal.sample(&mut rng);
        if s.is_finite() && p.is_finite() { x * s / p + z * (s * (1.0 - s / p).max(0.0)).sqrt() } else { 0.0 }
    });
    let course = inverse_dct2(&modes.collect::<Vec<f64>>());
    let group = course.len().div_ceil(KNOTS).max(1);
    let drivers = &problem.drivers;
    let middle = |g: usize, len: usize| drivers.time_s(g * group) + 0.5 * (len - 1) as f64 * drivers.dt_s;
    let chunks = || course.chunks(group).enumerate();
    let times = chunks().map(|(g, c)| middle(g, c.len())).collect();
    let values = chunks().map(|(_, c)| c.iter().sum::<f64>() / c.len() as f64).collect();
    BTreeMap::from([
        ("knots_time_s".to_owned(), Value::List(times)),
        ("knots_deg_h".to_owned(), Value::List(values)),
    ])
}
