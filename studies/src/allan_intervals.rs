//! Intervals of the Allan deviation on simulated records. A short version is a unit test of `sagnac_core::noise::intervals`.

use crate::study::{Asked, Case, Row, Study};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;
use sagnac::estimate::Interval;
use sagnac::noise::allan::{AllanAccumulator, AllanPlan};
use sagnac::noise::data::NoiseType;
use sagnac::noise::family::Estimator;
use sagnac::noise::intervals::bounded;
use sagnac::noise::tau_grid::TauGrid;

/// Coverage of both intervals at six averaging times.
pub static STUDY: Study = Study {
    id: "allan-deviation",
    title: "Intervals of the Allan deviation of simulated records",
    method: "Records of 1000 samples of white noise and of random walk, whose Allan deviation is known in closed form. Degrees of \
             freedom are those of the true kind of noise.",
    records: 20_000,
    cases,
};

/// Averaging times in samples.
const FACTORS: [u64; 6] = [4, 8, 16, 32, 64, 128];

fn cases() -> Vec<Case> {
    let case = |name, walk| {
        Case::new(name, move |records, seed| {
            let first = 1_000_000 * (seed - 1);
            rows(records, coverage(walk, first..first + records))
        })
    };
    vec![case("white noise", false), case("random walk", true)]
}

fn rows(records: u64, hits: [[u64; 2]; 6]) -> Vec<Row> {
    let mut rows = vec![];
    for (m, [one_sigma, two_sigma]) in FACTORS.into_iter().zip(hits) {
        let quantity = format!("σ(τ), τ of {m} samples");
        let share = |claim: &str, asked, hits| Row::share(quantity.clone(), claim, asked, hits, records);
        rows.push(share("68.3 % interval holds the truth", Asked::Between(0.653, 0.713), one_sigma));
        rows.push(share("95 % interval holds the truth", Asked::Between(0.93, 0.97), two_sigma));
    }
    rows
}

/// Records whose intervals of one standard deviation and of 95 % hold the truth, for each averaging time.
fn coverage(walk: bool, seeds: std::ops::Range<u64>) -> [[u64; 2]; 6] {
    let add = |a: [[u64; 2]; 6], b: [[u64; 2]; 6]| std::array::from_fn(|i| [0, 1].map(|k| a[i][k] + b[i][k]));
    seeds.into_par_iter().map(|seed| held(walk, seed)).reduce(|| [[0; 2]; 6], add)
}

fn held(walk: bool, seed: u64) -> [[u64; 2]; 6] {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut level = 0.0;
    let samples: Vec<f64> = (0..1000)
        .map(|_| {
            let step: f64 = StandardNormal.sample(&mut rng);
            level += step;
            if walk { level } else { step }
        })
        .collect();
    let mut allan = AllanAccumulator::new(AllanPlan {
        tau0_s: 1.0,
        grid: TauGrid::List(FACTORS.map(|m| m as f64).to_vec()),
        exact: false,
        estimators: vec![Estimator::Allan],
    });
    allan.push(&samples, 0, false);
    let set = allan.finish();
    let noise = if walk { NoiseType::RateRandomWalk } else { NoiseType::AngleRandomWalk };
    let mut hits = [[0; 2]; 6];
    for (hit, point) in hits.iter_mut().zip(&set.curves[0].points) {
        let m = point.m as f64;
        // Means over m samples: variances 1/m of white noise, (2m² + 1)/(6m) of a walk with steps of variance 1.
        let truth = if walk { (2.0 * m * m + 1.0) / (6.0 * m) } else { 1.0 / m }.sqrt();
        let bounds = bounded(Estimator::Allan, point, &set.stretches, noise);
        let inside = |i: Option<Interval>| u64::from(i.is_some_and(|i| i.low <= truth && truth <= i.high));
        *hit = [inside(bounds.interval68), inside(bounds.interval95)];
    }
    hits
}
