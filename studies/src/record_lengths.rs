//! Lengths of records that `inspect` and `check` state for B and K, against simulated records of that length.

use crate::bench::noise_source::{NoiseSource, add};
use crate::study::{Asked, Case, Row, Study};
use rayon::prelude::*;
use sagnac::estimate::{Estimate, Limit, Rule, Verdict, judge};
use sagnac::noise::data::{BlockSeries, NoiseType};
use sagnac::noise::evidence::Evidence;
use sagnac::noise::expected::{decision_power, resolving_duration};
use sagnac::noise::identification::{Options, identify};
use sagnac::noise::model::NoiseModel;

/// A term has a value, and its limit decided, in 8 of 10 records of the stated length.
pub static STUDY: Study = Study {
    id: "record-lengths",
    title: "How long a record must be for B and K",
    method: "White noise of 0.002 deg/√h with flicker or a random walk of several sizes, sampled every 10 s. The length is the one \
             that is stated for the size, or for a limit; the records are sums of Markov processes and of steps that share no formula \
             with it, and are evaluated as those of a test are, every kind of term searched for. Stated is a share of 0.8 at the \
             length, for the value of the term, and for the verdicts on a unit at 1.5 times its limit and at half of it; shares within \
             0.1 of that count as held. A quarter of the length shows that the length is needed.",
    records: 400,
    cases,
};

/// Angle random walk of every record, deg/√h.
const N: f64 = 0.002;
/// Interval of the samples, s.
const INTERVAL_S: f64 = 10.0;
/// Risk of the limits.
const RISK: f64 = 0.05;
/// Shares that count as the stated one, 0.8.
const LEAST_SHARE: f64 = 0.7;
const MOST_SHARE: f64 = 0.9;

/// A slow term of some size.
#[derive(Debug, Clone, Copy)]
pub struct Slow {
    /// The term.
    pub term: NoiseType,
    /// Its coefficient, deg/h for B and deg/h/√h for K: the truth that is to be resolved, or the limit that is to be decided.
    pub size: f64,
}

/// The sizes of the study.
pub const SLOW: [Slow; 6] = [
    Slow { term: NoiseType::Flicker, size: 0.004 },
    Slow { term: NoiseType::Flicker, size: 0.008 },
    Slow { term: NoiseType::Flicker, size: 0.016 },
    Slow { term: NoiseType::RateRandomWalk, size: 0.003 },
    Slow { term: NoiseType::RateRandomWalk, size: 0.01 },
    Slow { term: NoiseType::RateRandomWalk, size: 0.03 },
];

impl Slow {
    fn background() -> NoiseModel {
        NoiseModel { n: N, ..NoiseModel::default() }
    }

    /// The length at which the size is stated to be resolved, h.
    pub fn resolved_h(self) -> Option<f64> {
        resolving_duration(self.term, self.size, &Slow::background(), INTERVAL_S)
    }

    /// The length at which the size as a limit is stated to be decided, h.
    pub fn decided_h(self) -> Option<f64> {
        let samples = (3600.0 / INTERVAL_S) as u64;
        decision_power(self.term, self.size, &Slow::background(), samples, INTERVAL_S, RISK)?
            .needed_duration_h
    }

    /// The term as it is found in a record of a unit that has `times` the size.
    fn found(self, times: f64, hours: f64, seed: u64) -> Estimate {
        let samples = (hours * 3600.0 / INTERVAL_S) as usize;
        let mut source = NoiseSource::new(seed);
        let mut mean = source.white(N, INTERVAL_S, samples);
        let size = times * self.size;
        let slow = match self.term {
            NoiseType::Flicker => source.flicker(size, INTERVAL_S, samples),
            _ => source.walk(size, INTERVAL_S, samples),
        };
        add(&mut mean, &slow);
        let blocks =
            BlockSeries { block_len: 1, first_index: 0, count: vec![1; samples], mean, rounding: vec![] };
        let noise = identify("rate", &Evidence::new(&blocks, None, INTERVAL_S, &[]), &Options::default());
        match self.term {
            NoiseType::Flicker => noise.bias_instability,
            _ => noise.rate_random_walk,
        }
    }

    /// Records of `hours` that give the term a value.
    pub fn resolved(self, hours: f64, records: u64, first: u64) -> u64 {
        let found = |seed: &u64| self.found(1.0, hours, *seed).value.is_some();
        (first..first + records).into_par_iter().filter(found).count() as u64
    }

    /// Records of `hours` of a unit at `times` the limit that have a verdict.
    pub fn judged(self, times: f64, verdict: Verdict, hours: f64, records: u64, first: u64) -> u64 {
        let limit = Limit {
            min: None,
            max: Some(self.size),
            rule: Rule::GuardBand,
            risk: RISK,
            source: String::new(),
        };
        let found = |seed: &u64| judge(&self.found(times, hours, *seed), &limit).verdict == verdict;
        (first..first + records).into_par_iter().filter(found).count() as u64
    }
}

fn cases() -> Vec<Case> {
    let of = |slow: Slow| {
        Case::new(format!("{} of {}", slow.term.id(), slow.size), move |records, seed| {
            rows(slow, records, 7_000_000 * seed)
        })
    };
    SLOW.into_iter().map(of).collect()
}

fn rows(slow: Slow, records: u64, first: u64) -> Vec<Row> {
    let about = Asked::Between(LEAST_SHARE, MOST_SHARE);
    let at_least = Asked::AtLeast(LEAST_SHARE);
    let mut rows = vec![];
    let id = slow.term.id();
    if let Some(hours) = slow.resolved_h() {
        let share = |claim: &str, asked, hours| {
            Row::share(id, claim, asked, slow.resolved(hours, records, first), records)
        };
        rows.push(Row::number(id, "length stated for its value, h", Asked::Nothing, hours, 1));
        rows.push(share("it has a value in a record of that length", about, hours));
        rows.push(share("it has a value in a quarter of that length", Asked::AtMost(0.5), 0.25 * hours));
    }
    if let Some(hours) = slow.decided_h() {
        let share = |claim: &str, times, verdict| {
            let hits = slow.judged(times, verdict, hours, records, first);
            Row::share(id, claim, at_least, hits, records)
        };
        rows.push(Row::number(id, "length stated for it as a limit, h", Asked::Nothing, hours, 1));
        rows.push(share(
            "a unit at 1.5 times the limit fails in a record of that length",
            1.5,
            Verdict::Fail,
        ));
        rows.push(share("a unit at half the limit passes in a record of that length", 0.5, Verdict::Pass));
    }
    rows
}
