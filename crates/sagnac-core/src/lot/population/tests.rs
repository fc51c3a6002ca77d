use super::*;
use crate::lot::batches::Batches;
use crate::lot::censored::Sample;

const PROMISE: Promise = Promise { proportion: 0.95, confidence: 0.95 };

/// The normal scores of n units, in one or more lots in turn.
fn scores(n: usize) -> impl Iterator<Item = f64> {
    (0..n).map(move |i| normal_quantile((i as f64 + 0.5) / n as f64))
}

fn units(values: impl Iterator<Item = f64>, standard: f64, lots: usize) -> Vec<Unit> {
    values
        .enumerate()
        .map(|(i, value)| Unit { lot: i % lots, reading: Reading::Value { value, standard } })
        .collect()
}

#[test]
fn without_errors_the_bound_is_the_exact_one() {
    let found = Population::of(&units(scores(30), 0.0, 1)).unwrap();
    let bound = found.bound(Of::True, Side::Upper, PROMISE).unwrap();
    let exact = 2.21984 * variance(&scores(30).collect::<Vec<_>>()).sqrt();
    assert!((bound.value - exact).abs() < 1e-5 && bound.method == Method::ExactNormal, "{bound:?}");
    let lower = found.bound(Of::Measured, Side::Lower, PROMISE).unwrap();
    assert!((lower.value + bound.value).abs() < 1e-9);
    let typical = found.typical(0.95);
    // Student's 97.5 % point of 29 degrees of freedom.
    assert!((typical.high - 2.04523 * found.between_units() / 30.0_f64.sqrt()).abs() < 1e-5);
}

#[test]
fn draws_without_errors_give_the_exact_bound() {
    let mut of = Population::of(&units(scores(30), 0.0, 1)).unwrap();
    let exact = of.bound(Of::True, Side::Upper, PROMISE).unwrap().value;
    let (typical, spread) = (of.typical(0.95), of.between_units());
    of.simple = false;
    let drawn = of.bound(Of::True, Side::Upper, PROMISE).unwrap();
    assert_eq!(drawn.method, Method::NormalWithErrors);
    assert!((drawn.value / exact - 1.0).abs() < 0.01, "{} is not {exact}", drawn.value);
    assert!((of.typical(0.95).high / typical.high - 1.0).abs() < 0.03);
    assert!((of.between_units() / spread - 1.0).abs() < 0.03);
}

#[test]
fn errors_are_taken_out_of_the_spread_and_put_into_the_bound_of_measured_values() {
    // A spread of 1 of which errors of 0.6 make up 0.36: 0.8 is left.
    let found = Population::of(&units(scores(400), 0.6, 1)).unwrap();
    assert!((found.between_units() - 0.8).abs() < 0.02, "{}", found.between_units());
    let at = |of: Of| found.bound(of, Side::Upper, PROMISE).unwrap().value;
    // At the median the bounds would be 1.645·0.8 and 1.645.
    assert!((1.645 * 0.8..1.645 * 0.8 * 1.12).contains(&at(Of::True)), "{}", at(Of::True));
    assert!((1.645..1.645 * 1.12).contains(&at(Of::Measured)), "{}", at(Of::Measured));
}

#[test]
fn few_lots_have_the_bound_of_the_analysis_of_variance() {
    let values = [3.0, -2.0, 0.0, 1.2, -0.7];
    let batches: Vec<Vec<f64>> = values.iter().map(|lot| scores(8).map(|z| lot + z).collect()).collect();
    let by_variance = Batches::of(&batches).unwrap().distance(PROMISE).unwrap();
    let all: Vec<Unit> = batches
        .iter()
        .enumerate()
        .flat_map(|(lot, b)| {
            b.iter().map(move |value| Unit { lot, reading: Reading::Value { value: *value, standard: 0.0 } })
        })
        .collect();
    let found = Population::of(&all).unwrap();
    let distance = found.bound(Of::True, Side::Upper, PROMISE).unwrap().value - found.typical(0.95).value;
    assert!((distance / by_variance - 1.0).abs() < 0.1, "{distance} is not {by_variance}");
    assert!((1.5..3.0).contains(&found.between_lots().unwrap()), "{:?}", found.between_lots());
    // Of four lots the spread between them is not stated.
    let four: Vec<Unit> = all.into_iter().filter(|u| u.lot < 4).collect();
    assert_eq!(Population::of(&four).unwrap().between_lots(), None);
}

#[test]
fn bounded_values_enter_as_the_likelihood_has_it() {
    let z: Vec<f64> = scores(60).collect();
    let (low, high) = z.split_at(18);
    let limit = low.iter().copied().fold(f64::NEG_INFINITY, f64::max) + 0.01;
    let reading = |v: f64, known: bool| match known {
        true => Reading::Value { value: v, standard: 1e-4 },
        false => Reading::AtMost { bound: limit, standard: 1e-4 },
    };
    let all: Vec<Unit> = high
        .iter()
        .map(|v| reading(*v, true))
        .chain(low.iter().map(|v| reading(*v, false)))
        .map(|reading| Unit { lot: 0, reading })
        .collect();
    let found = Population::of(&all).unwrap();
    let check = Sample { values: high.to_vec(), bounds: vec![limit; 18] };
    let best = check.fit().unwrap();
    let (from, to) = check.mean_interval(0.95).unwrap();
    let typical = found.typical(0.95);
    assert!((typical.value - best.mean).abs() < 0.03, "{typical:?} {best:?}");
    assert!((found.between_units() / best.deviation - 1.0).abs() < 0.05);
    assert!((typical.low - from).abs() < 0.05 && (typical.high - to).abs() < 0.05, "{typical:?} {from} {to}");
    assert_eq!(found.bounded(), 18);
}

#[test]
fn shares_above_a_limit_are_those_of_the_law() {
    let found = Population::of(&units(scores(200), 0.3, 1)).unwrap();
    let deviation = found.between_units();
    let share = found.share_above(1.645 * deviation, 0.95);
    assert!((share.value - 0.05).abs() < 0.004, "{share:?}");
    assert!(share.low < 0.04 && share.high > 0.06 && share.high < 0.1, "{share:?}");
}

#[test]
fn a_law_that_is_not_normal_is_bounded_without_one() {
    let heavy = || scores(100).map(|z| z * z * z);
    let found = Population::of(&units(heavy(), 0.0, 1)).unwrap();
    assert!(found.normality().unwrap() < NOT_NORMAL);
    let bound = found.bound(Of::True, Side::Upper, Promise { proportion: 0.97, confidence: 0.9 }).unwrap();
    let largest = heavy().fold(0.0, f64::max);
    assert!(bound.value <= largest && bound.method == Method::OrderStatistic, "{bound:?}");
}

#[test]
fn what_tells_no_population_is_none() {
    assert_eq!(Population::of(&[]), None);
    assert_eq!(Population::of(&units(scores(4), 0.0, 1)), None);
    assert_eq!(Population::of(&units([1.0; 9].into_iter(), 0.1, 1)), None);
    assert_eq!(Population::of(&units([1.0, 2.0, 3.0, 4.0, 5.0, f64::NAN].into_iter(), 0.1, 1)), None);
}
