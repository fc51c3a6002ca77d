//! Monte Carlo of the identification against simulated truth: coverage, false claims, efficiency. A few
//! fast mixes; the study itself is `identification_study`.

use sagnac::noise::data::BlockSeries;
use sagnac::noise::evidence::Evidence;
use sagnac::noise::identification::linear_fit::{Likelihood, Structure};
use sagnac::noise::identification::{Options, identify};
use sagnac::noise::model::{NoiseModel, TERMS};
use sagnac::noise::simulate::{Setup, Simulator};

/// What a set of records of one mix showed. Arrays follow `TERMS`.
#[derive(Default)]
struct Tally {
    claimed: [usize; 5],
    covered: [usize; 5],
    square_error: [f64; 5],
    limits: [usize; 5],
    limits_hold: [usize; 5],
    false_claims: usize,
    bound: [f64; 5],
}

fn study(model: &NoiseModel, hours: f64, tau0_s: f64, records: u64, seed: u64) -> Tally {
    let samples = (hours * 3600.0 / tau0_s) as usize;
    let mut tally = Tally::default();
    let present: Structure = TERMS.map(|t| model.coefficient(t) != 0.0);
    let expected = Evidence::expected(model, samples as u64, tau0_s);
    let covariance = Likelihood::new(&expected).expect("evidence").covariance_bound(model, &present);
    for (i, bound) in tally.bound.iter_mut().enumerate() {
        *bound = covariance[i][i].sqrt() / model.coefficient(TERMS[i]).abs().max(1e-300);
    }
    for run in 0..records {
        let setup =
            Setup { bias_deg_h: 0.37, ..Setup::for_record(seed * 1_000_003 + run, tau0_s, samples as u64) };
        let mean = Simulator::new(model, &setup).take(samples);
        let blocks =
            BlockSeries { block_len: 1, first_index: 0, count: vec![1; samples], mean, rounding: vec![] };
        let found = identify("rate", &Evidence::new(&blocks, None, tau0_s, &[]), &Options::standard_terms());
        let [n, b, k, r, q] = found.estimates();
        let mut wrong = false;
        for (i, estimate) in [n, b, k, q, r].into_iter().enumerate() {
            let truth = model.coefficient(TERMS[i]);
            match estimate.value {
                Some(value) => {
                    tally.claimed[i] += 1;
                    wrong |= !present[i];
                    if present[i] {
                        tally.square_error[i] += (value / truth - 1.0).powi(2);
                        let interval = estimate.interval95().expect("an interval");
                        tally.covered[i] += usize::from(interval.low <= truth && truth <= interval.high);
                    }
                }
                None => {
                    let limit = estimate.upper_limit.expect("an upper limit");
                    tally.limits[i] += 1;
                    tally.limits_hold[i] += usize::from(truth.abs() <= limit.value);
                }
            }
        }
        tally.false_claims += usize::from(wrong);
    }
    tally
}

#[test]
fn white_noise_alone_shows_nothing_else() {
    let model = NoiseModel { n: 0.0023, ..Default::default() };
    let tally = study(&model, 10.0, 10.0, 60, 77);
    assert_eq!(tally.claimed[0], 60);
    assert!(tally.false_claims <= 5, "{} of 60", tally.false_claims);
    assert!(tally.covered[0] >= 53, "{} of 60", tally.covered[0]);
    assert!(tally.limits_hold.iter().zip(tally.limits).all(|(hold, of)| *hold == of));
}

#[test]
fn flicker_is_found_where_the_record_shows_it_with_honest_intervals() {
    let model = NoiseModel { n: 0.002, b: 0.006, ..Default::default() };
    let tally = study(&model, 100.0, 20.0, 50, 78);
    assert_eq!(tally.claimed[1], 50);
    assert!(tally.covered[0] >= 43 && tally.covered[1] >= 43, "{:?}", tally.covered);
    assert!(tally.false_claims <= 6, "{} of 50", tally.false_claims);
    let rms = (tally.square_error[1] / 50.0).sqrt();
    assert!(rms < 1.35 * tally.bound[1], "rms {rms}, bound {}", tally.bound[1]);
}

#[test]
fn random_walk_is_not_taken_for_flicker() {
    let model = NoiseModel { n: 0.0023, k: 0.006, ..Default::default() };
    let tally = study(&model, 100.0, 20.0, 50, 79);
    assert_eq!(tally.claimed[2], 50);
    assert!(tally.covered[2] >= 43, "{:?}", tally.covered);
    assert!(tally.false_claims <= 6, "{} of 50", tally.false_claims);
}
