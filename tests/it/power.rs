//! Predicted power of a test against simulated records.

use sagnac::estimate::{Limit, Rule, Verdict, judge};
use sagnac::noise::data::{BlockSeries, NoiseType};
use sagnac::noise::evidence::Evidence;
use sagnac::noise::expected::{decision_power, expected_upper_limit};
use sagnac::noise::identification::{Options, identify};
use sagnac::noise::model::NoiseModel;
use sagnac::noise::simulate::{Setup, Simulator};

/// Share of simulated records with the given verdict.
fn simulated(
    model: &NoiseModel,
    term: NoiseType,
    limit: f64,
    samples: usize,
    tau0_s: f64,
    want: Verdict,
) -> f64 {
    let runs = 150;
    let limit =
        Limit { min: None, max: Some(limit), rule: Rule::GuardBand, risk: 0.05, source: String::new() };
    let mut hits = 0;
    for run in 0..runs {
        let mean =
            Simulator::new(model, &Setup::for_record(run + 40_000, tau0_s, samples as u64)).take(samples);
        let blocks =
            BlockSeries { block_len: 1, first_index: 0, count: vec![1; samples], mean, rounding: vec![] };
        let found = identify("rate", &Evidence::new(&blocks, None, tau0_s, &[]), &Options::standard_terms());
        let estimate = match term {
            NoiseType::Flicker => &found.bias_instability,
            _ => &found.rate_random_walk,
        };
        hits += usize::from(judge(estimate, &limit).verdict == want);
    }
    hits as f64 / runs as f64
}

#[test]
fn predicted_power_agrees_with_simulation() {
    let background = NoiseModel { n: 0.002, ..Default::default() };
    let (samples, tau0_s) = (3600, 10.0);
    for (term, limit) in [(NoiseType::Flicker, 0.005), (NoiseType::RateRandomWalk, 0.012)] {
        let power = decision_power(term, limit, &background, samples as u64, tau0_s, 0.05).unwrap();
        let over = background.with(term, 1.5 * limit);
        let under = background.with(term, 0.5 * limit);
        let fail = simulated(&over, term, limit, samples, tau0_s, Verdict::Fail);
        let pass = simulated(&under, term, limit, samples, tau0_s, Verdict::Pass);
        println!("{term:?} {power:?} simulated fail {fail} pass {pass}");
        assert!((power.fail_probability_at_1_5 - fail).abs() < 0.10, "{power:?} simulated {fail}");
        assert!((power.pass_probability_at_half - pass).abs() < 0.10, "{power:?} simulated {pass}");
    }
}

#[test]
fn expected_limit_is_the_median_of_simulated_limits() {
    let background = NoiseModel { n: 0.0023, ..Default::default() };
    let (samples, tau0_s) = (3600usize, 10.0);
    let expected = expected_upper_limit(NoiseType::Flicker, &background, samples as u64, tau0_s).unwrap();
    let mut limits: Vec<f64> = (0..101)
        .filter_map(|run| {
            let mean =
                Simulator::new(&background, &Setup::for_record(run, tau0_s, samples as u64)).take(samples);
            let blocks =
                BlockSeries { block_len: 1, first_index: 0, count: vec![1; samples], mean, rounding: vec![] };
            let found =
                identify("rate", &Evidence::new(&blocks, None, tau0_s, &[]), &Options::standard_terms());
            found.bias_instability.upper_limit.map(|l| l.value)
        })
        .collect();
    limits.sort_by(f64::total_cmp);
    let median = limits[limits.len() / 2];
    println!("expected {expected} median {median}");
    assert!((median / expected - 1.0).abs() < 0.2, "expected {expected}, median {median}");
}
