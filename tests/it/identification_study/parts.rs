//! Identification with parts beside N, B, K, Q and R: quantisation that another part could stand for, and intervals
//! without a second search.

use sagnac::noise::composite::{Composite, Sampling};
use sagnac::noise::data::NoiseType;
use sagnac::noise::evidence::Evidence;
use sagnac::noise::identification::{
    Identification, Options, complete, describe, identify as identify_terms,
};
use sagnac::noise::model::NoiseModel;
use sagnac_studies::identification::generator::Generator;
use sagnac_studies::identification::mixes::{Mix, TAU0_S, mixes};
use sagnac_studies::identification::record::{digest, identify};
use sagnac_studies::identification::run::simulated;

const SAMPLES: usize = 36_000;

fn mix(name: &str) -> Mix {
    mixes().into_iter().find(|m| m.name == name).expect("a mix")
}

fn identified(y: &[f64]) -> Identification {
    identify(&digest(y, TAU0_S)).identification
}

#[test]
fn quantisation_that_trades_against_a_short_process_is_not_claimed() {
    let mix = mix("N+short Markov");
    // In this record chance makes quantisation gain 8.5 to 20 in 2 ln L, and N would be a quarter too small.
    let seed = 31_008_010u64.wrapping_mul(1_000_003).wrapping_add(185);
    let found = identified(&Generator::new(&mix, SAMPLES, TAU0_S).record(seed, 0.37));
    assert!(found.likelihood_ratios[3] > 8.5 && found.likelihood_ratios[3] < 20.0);
    assert!(!found.claims(NoiseType::Quantization));
    let n = &found.angle_random_walk;
    // Cramér-Rao bound 0.84 %.
    let error = n.value.expect("N") / mix.truth.terms.n - 1.0;
    assert!(error.abs() < 0.042, "{error}");
    // What was not claimed may still hold a part of the level.
    let held = n.interval95().expect("an interval");
    assert!(held.low < 0.9 * mix.truth.terms.n && held.high > mix.truth.terms.n, "{held:?}");
}

#[test]
fn quantisation_that_shows_beside_a_short_process_is_claimed() {
    let plain = mix("N+short Markov");
    let truth = Composite { terms: NoiseModel { q: 0.1, ..plain.truth.terms }, ..plain.truth };
    let mix = Mix { name: "N+Q+short Markov", truth };
    for seed in 0..3 {
        let found = identified(&simulated(&mix, SAMPLES, 8_100 + seed));
        assert!(found.likelihood_ratios[3] > 20.0, "{:?}", found.likelihood_ratios);
        assert!(
            found.claims(NoiseType::Quantization) && found.markov.len() == 1,
            "{:?}",
            found.described.model
        );
        for (estimate, truth) in [(&found.quantization, 0.1), (&found.angle_random_walk, mix.truth.terms.n)] {
            let score = estimate.interval95().expect("an interval");
            // Three intervals a term: one and a half times the half width is a score of 2.9.
            let (low, high) = (1.25 * score.low - 0.25 * score.high, 1.25 * score.high - 0.25 * score.low);
            assert!(low < truth && truth < high, "{}: {score:?}", estimate.id);
        }
    }
}

#[test]
fn intervals_after_a_description_are_those_of_a_whole_identification() {
    let options = Options { sampling: Sampling::Averaging, ..Options::default() };
    for name in ["N+B", "N+K", "N+short Markov", "N+quasi-periodic", "N moving average"] {
        let record = digest(&simulated(&mix(name), SAMPLES, 77), TAU0_S);
        let evidence = Evidence::new(&record.blocks, Some(&record.welch.spectrum), TAU0_S, &[]);
        let described = describe("rate", &evidence, &options);
        let completed = complete("rate", &evidence, &options, &described);
        assert_eq!(completed, identify_terms("rate", &evidence, &options), "{name}");
        assert_eq!(
            (completed.model, &completed.described),
            (described.model, &described.described),
            "{name}"
        );
    }
}
