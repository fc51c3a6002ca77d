//! The parts of the identification study are themselves checked here: the usual methods on exact variances, the claims
//! against hand-made identifications, the exchange of a filter and a Markov process.

use sagnac::estimate::{Estimate, Spread};
use sagnac::noise::family::Estimator;
use sagnac::noise::identification::{MarkovFound, QuasiPeriodicFound};
use sagnac::noise::model::{NoiseModel, TERMS};
use sagnac_studies::identification::allan::{self, Point};
use sagnac_studies::identification::alternatives::{log_log, minimum, nonnegative_variances, slopes};
use sagnac_studies::identification::claims::{estimate_of, false_claims, swapped};
use sagnac_studies::identification::mixes::{Kind, Mix, TAU0_S, mixes};
use sagnac_studies::identification::oracle::Oracle;
use sagnac_studies::identification::record::{digest, identify};
use sagnac_studies::identification::run::simulated;
use sagnac_studies::identification::whittle::Layout;

fn mix(name: &str) -> Mix {
    mixes().into_iter().find(|m| m.name == name).expect("a mix")
}

/// Allan variances without any error at octaves.
fn exact(model: &NoiseModel, octaves: u32) -> Vec<Point> {
    (0..octaves)
        .map(|i| {
            let tau_s = f64::from(1u32 << i);
            Point { tau_s, variance: model.allan_variance(tau_s), windows: 1e5 / tau_s }
        })
        .collect()
}

#[test]
fn fits_give_back_exact_variances() {
    let model = NoiseModel { n: 0.002, b: 0.006, k: 0.01, r: 0.02, q: 0.2 };
    let points = exact(&model, 18);
    for values in [log_log(&points), nonnegative_variances(&points)] {
        for (value, term) in values.into_iter().zip(TERMS) {
            let ratio = value.expect("visible") / model.coefficient(term);
            assert!((ratio - 1.0).abs() < 1e-6, "{term:?}: {ratio}");
        }
    }
    let white = NoiseModel { n: 0.002, ..Default::default() };
    for values in [log_log(&exact(&white, 14)), nonnegative_variances(&exact(&white, 14))] {
        assert!((values[0].expect("N") / 0.002 - 1.0).abs() < 1e-9);
        assert_eq!(values[1..], [None; 4]);
    }
}

#[test]
fn slopes_are_read_where_one_term_rules_and_the_minimum_shows_a_false_floor() {
    // Quantisation rules below 100 s, random walk above 10⁴ s.
    let model = NoiseModel { n: 0.001, k: 0.05, q: 3.0, ..Default::default() };
    let read = slopes(&exact(&model, 18));
    assert!((read[3].expect("Q") / 3.0 - 1.0).abs() < 0.05, "{read:?}");
    assert!((read[2].expect("K") / 0.05 - 1.0).abs() < 0.1, "{read:?}");
    // Published: N and K alone have a minimum of 1.0745699 √(NK), which reads as B = 1.6176 √(NK).
    let (n, k): (f64, f64) = (0.002, 0.005);
    let points: Vec<Point> = (100..4000)
        .map(|i| f64::from(i) * 2.0)
        .map(|tau_s| {
            let model = NoiseModel { n, k, ..Default::default() };
            Point { tau_s, variance: model.allan_variance(tau_s), windows: 1.0 }
        })
        .collect();
    let b = minimum(&points)[1].expect("a minimum");
    assert!((b / (n * k).sqrt() - 1.0745699 / 0.664).abs() < 1e-4, "{b}");
}

#[test]
fn variances_agree_with_those_of_the_program() {
    let y = simulated(&mix("N+B+K"), 20_000, 3);
    let theirs = digest(&y, TAU0_S);
    let curve = theirs.deviations.curve(Estimator::Allan).expect("a curve");
    let points = allan::octaves(&y, TAU0_S, 0.2);
    assert!(points.len() >= 11);
    for (i, p) in points.iter().enumerate() {
        let other = curve.points.iter().find(|q| q.m == 1 << i).expect("an octave");
        assert!((p.variance.sqrt() / other.deviation - 1.0).abs() < 1e-9, "{}", p.tau_s);
    }
}

fn measured(id: &'static str, value: f64) -> Estimate {
    let spread = Spread::Normal { standard_uncertainty: 0.1 * value };
    Estimate::measured(id, "rate", value, "unit", spread, "hand")
}

#[test]
fn claims_are_set_against_the_truth() {
    let white = mix("N");
    let both = mix("N+short Markov+quasi-periodic");
    let mut found = identify(&digest(&simulated(&white, 4096, 9), TAU0_S)).identification;
    assert_eq!(false_claims(&found, &white.truth), Vec::<&str>::new());
    let process = |time: f64| MarkovFound {
        sigma: measured("markov_sigma", time / 100.0),
        correlation_time: measured("markov_time", time),
    };
    found.markov = vec![process(300.0), process(1.4)];
    found.quasi_periodic = vec![QuasiPeriodicFound {
        amplitude: measured("amplitude", 0.1),
        frequency: measured("frequency", 0.081),
        coherence_time: measured("coherence", 55.0),
    }];
    found.cutoff = Some(measured("cutoff", 0.1));
    found.rate_ramp = measured("rate_ramp", 0.1);
    assert_eq!(false_claims(&found, &white.truth), ["R", "Markov", "Markov", "quasi-periodic", "filter"]);
    assert_eq!(false_claims(&found, &both.truth), ["R", "Markov", "filter"]);
    // Of two processes the one that is nearest to the truth of 1.5 s is judged.
    for q in both.quantities() {
        let value = estimate_of(&found, &q, &both.truth).and_then(|e| e.value);
        let expected = match q.kind {
            Kind::MarkovSigma => Some(1.4 / 100.0),
            Kind::MarkovTime => Some(1.4),
            Kind::PeriodicFrequency => Some(0.081),
            Kind::PeriodicTime => Some(55.0),
            _ => continue,
        };
        assert_eq!(value, expected, "{}", q.label);
    }
    assert!(estimate_of(&found, &mix("N moving average").quantities()[1], &white.truth).is_some());
}

/// Δ ln L of the exchanged structure against the true one, for one record.
fn exchange(name: &str, filter: bool) -> f64 {
    let mix = mix(name);
    let samples = 36_000;
    let y = simulated(&mix, samples, 21);
    let mut found = identify(&digest(&y, TAU0_S)).identification;
    (found.markov, found.cutoff) = (vec![], None);
    if filter {
        found.cutoff = Some(measured("cutoff", 0.1));
    } else {
        found.markov = vec![MarkovFound { sigma: measured("s", 0.1), correlation_time: measured("t", 2.0) }];
    }
    let (other, parameters) = swapped(&found, &mix.truth).expect("an exchange");
    let layout = Layout::new(samples, &mix.truth);
    let data = layout.data(&y);
    let own = mix.parameters();
    let fit =
        |start, parameters: &[_]| Oracle { layout: &layout, data: &data, parameters, start }.fit().deviance;
    0.5 * (fit(&other, &parameters) - fit(&mix.truth, &own))
}

#[test]
fn an_exchange_of_filter_and_markov_process_is_weighed_by_the_record() {
    // A third of the power white and unfiltered is no filter: hundreds of units of ln L.
    let told_apart = exchange("N+short Markov", true);
    assert!(told_apart > 30.0, "{told_apart}");
    // White noise behind a filter is a Markov process: the exchange costs nothing beyond the flicker's filtering.
    let same = exchange("N+B first-order filter", false);
    assert!(same.abs() < 3.0, "{same}");
}
