//! Predicted power of a test at rest against simulated records. A short version is `tests/it/power.rs`.

use crate::study::{Asked, Case, Row, Study};
use rayon::prelude::*;
use sagnac::estimate::{Estimate, Limit, Rule, Verdict, judge};
use sagnac::noise::data::{BlockSeries, NoiseType};
use sagnac::noise::evidence::Evidence;
use sagnac::noise::expected::{Power, decision_power, expected_upper_limit};
use sagnac::noise::identification::{Identification, Options, identify};
use sagnac::noise::model::NoiseModel;
use sagnac::noise::simulate::{Setup, Simulator};

/// What `check` and a report predict of a test that is yet to be made.
pub static STUDY: Study = Study {
    id: "predicted-power",
    title: "Predicted power of a test at rest",
    method: "White noise of 0.002 deg/√h over 10 h, with flicker or a random walk of 1.5 times its limit, of half of it, and \
             without any; the shares of records that fail and pass, and the median of the upper limits of B, are set against \
             what is predicted from the noise alone.",
    records: 1000,
    cases,
};

/// Samples of a record and their interval, s: 10 h.
const SAMPLES: usize = 3600;
const INTERVAL_S: f64 = 10.0;
/// Angle random walk of every record, deg/√h.
const BACKGROUND: NoiseModel = NoiseModel { n: 0.002, b: 0.0, k: 0.0, r: 0.0, q: 0.0 };
/// How far a predicted probability may lie from the simulated share.
const TOLERANCE: f64 = 0.05;

/// A limit on a term of the noise.
#[derive(Debug, Clone, Copy)]
pub struct Limited {
    /// The term.
    pub term: NoiseType,
    /// Its limit, in the unit of its coefficient.
    pub limit: f64,
}

/// The limits of the study: B of 0.005 deg/h, and K of 0.012 deg/h/√h.
pub const LIMITS: [Limited; 2] = [
    Limited { term: NoiseType::Flicker, limit: 0.005 },
    Limited { term: NoiseType::RateRandomWalk, limit: 0.012 },
];

impl Limited {
    /// What is predicted of a unit at 1.5 times the limit and at half of it.
    pub fn predicted(self) -> Option<Power> {
        decision_power(self.term, self.limit, &BACKGROUND, SAMPLES as u64, INTERVAL_S, 0.05)
    }

    /// Records of a unit at `times` its limit that have a verdict.
    pub fn simulated(self, times: f64, verdict: Verdict, records: u64, first: u64) -> u64 {
        let limit = Limit {
            min: None,
            max: Some(self.limit),
            rule: Rule::GuardBand,
            risk: 0.05,
            source: String::new(),
        };
        let model = BACKGROUND.with(self.term, times * self.limit);
        let found = |seed: &u64| judge(&self.estimate(&identified(&model, *seed)), &limit).verdict == verdict;
        (first..first + records).into_par_iter().filter(found).count() as u64
    }

    fn estimate(self, noise: &Identification) -> Estimate {
        match self.term {
            NoiseType::Flicker => noise.bias_instability.clone(),
            _ => noise.rate_random_walk.clone(),
        }
    }
}

fn identified(model: &NoiseModel, seed: u64) -> Identification {
    let setup = Setup::for_record(seed, INTERVAL_S, SAMPLES as u64);
    let mean = Simulator::new(model, &setup).take(SAMPLES);
    let blocks =
        BlockSeries { block_len: 1, first_index: 0, count: vec![1; SAMPLES], mean, rounding: vec![] };
    identify("rate", &Evidence::new(&blocks, None, INTERVAL_S, &[]), &Options::standard_terms())
}

/// The expected upper limit on B of records of white noise, and the median of those of simulated ones, deg/h.
pub fn upper_limits(records: u64, first: u64) -> Option<(f64, f64)> {
    let expected = expected_upper_limit(NoiseType::Flicker, &BACKGROUND, SAMPLES as u64, INTERVAL_S)?;
    let mut limits: Vec<f64> = (first..first + records)
        .into_par_iter()
        .filter_map(|seed| identified(&BACKGROUND, seed).bias_instability.upper_limit.map(|l| l.value))
        .collect();
    limits.sort_by(f64::total_cmp);
    Some((expected, *limits.get(limits.len() / 2)?))
}

fn cases() -> Vec<Case> {
    let of_limits = LIMITS.map(|limited| {
        Case::new(format!("limit on {}", limited.term.id()), move |records, seed| {
            let Some(power) = limited.predicted() else { return vec![] };
            let row = |claim: &str, times: f64, verdict: Verdict, predicted: f64| {
                let asked = Asked::Between(predicted - TOLERANCE, predicted + TOLERANCE);
                let hits = limited.simulated(times, verdict, records, 40_000 + 1_000_000 * seed);
                Row::share(limited.term.id(), claim, asked, hits, records)
            };
            let (fails, passes) = (power.fail_probability_at_1_5, power.pass_probability_at_half);
            vec![
                row("a unit at 1.5 times the limit fails as predicted", 1.5, Verdict::Fail, fails),
                row("a unit at half the limit passes as predicted", 0.5, Verdict::Pass, passes),
            ]
        })
    });
    let limit = Case::new("expected upper limit on B", |records, seed| {
        let Some((expected, median)) = upper_limits(records, 1_000_000 * seed) else { return vec![] };
        let asked = Asked::Between(0.95, 1.05);
        vec![Row::number(
            "bias_instability",
            "median upper limit over the expected",
            asked,
            median / expected,
            records,
        )]
    });
    of_limits.into_iter().chain([limit]).collect()
}
