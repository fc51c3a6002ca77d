//! The catalogue held against the contract, and every course against itself: what a fit finds must come back from its
//! parameters, and searches must find what is there.

use super::*;
use crate::effect::{
    ClaimedMean, Column, Drivers, Earth, Model, OtherDriver, SearchContext, Temperature, Value, Values,
};
use crate::numeric::cosine::dct2;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use std::collections::BTreeSet;
use std::f64::consts::PI;

/// Kinds of the contract, section 3, without `unknown`.
const KINDS: [&str; 42] = [
    "temp_linear",
    "temp_polynomial",
    "temp_rate",
    "thermal_lag",
    "temp_hysteresis",
    "warmup_exponential",
    "rate_ramp",
    "diurnal",
    "unobserved_driver",
    "excess_arw",
    "excess_flicker",
    "excess_rrw",
    "markov_short",
    "markov_long",
    "quasi_periodic",
    "line",
    "comb",
    "quantization",
    "bandwidth_filter",
    "noise_variance_time",
    "noise_variance_rate",
    "outlier_bursts",
    "random_telegraph",
    "bias_step",
    "heading_change",
    "earth_rate_projection",
    "table_harmonic",
    "reset_ripple",
    "sf_error",
    "sf_asymmetry",
    "sf_nonlinearity",
    "sf_temperature",
    "dead_zone",
    "saturation",
    "cross_axis",
    "supply_sensitivity",
    "column_driver",
    "noise_variance_driver",
    "sf_driver",
    "dropped_samples",
    "time_offset",
    "clock_drift",
];

#[test]
fn the_registry_holds_every_kind_of_the_contract_once() {
    let held: Vec<&str> = EFFECTS.iter().map(|e| e.kind()).collect();
    assert_eq!(held.len(), held.iter().collect::<BTreeSet<_>>().len(), "a kind stands there twice");
    for kind in KINDS {
        assert_eq!(find(kind).map(|e| e.kind()), Some(kind));
    }
    assert!(find("unknown").is_none());
}

#[test]
fn parameters_and_confusers_are_sound() {
    for effect in EFFECTS {
        let kind = effect.kind();
        assert!((1..=4).contains(&effect.confusers().len()), "{kind}");
        for confuser in effect.confusers() {
            assert!(*confuser != kind && find(confuser).is_some(), "{kind}: {confuser}");
        }
        let names: BTreeSet<&str> = effect.params().iter().map(|p| p.name).collect();
        assert_eq!(names.len(), effect.params().len(), "{kind}");
        assert!(effect.params().iter().all(|p| p.lower < p.upper), "{kind}");
        for param in effect.params() {
            let first = crate::effect::parameter(param.name).unwrap();
            let alike = (first.unit, first.signed, first.whole) == (param.unit, param.signed, param.whole);
            assert!(alike, "{kind}: {} means something else in another effect", param.name);
        }
        assert!(effect.params().iter().filter(|p| p.corrects_claim).count() <= 1, "{kind}");
    }
}

fn noise(seed: u64, n: usize, sigma: f64) -> Vec<f64> {
    let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(seed);
    (0..n)
        .map(|_| {
            let e: f64 = StandardNormal.sample(&mut rng);
            sigma * e
        })
        .collect()
}

/// Plateaus, sweeps and reversals of a table.
fn profile(t: f64) -> f64 {
    let sweep = 2.0 * (2.0 * PI * t / 170.0).sin() * (2.0 * PI * t / 1900.0).cos();
    match (t / 250.0) as usize % 4 {
        0 => 0.0,
        1 => 6.0,
        2 => sweep,
        _ => -9.0 * (2.0 * PI * t / 83.0).sin(),
    }
}

/// A record of 50 minutes with every column moving.
fn drivers() -> Drivers {
    let (n, dt) = (6000usize, 0.5);
    let time = |i: usize| i as f64 * dt;
    let series = |f: &dyn Fn(f64) -> f64| Some((0..n).map(|i| f(time(i))).collect::<Vec<f64>>());
    let mut angle = 0.0;
    let table_angle = (0..n)
        .map(|i| {
            angle += profile(time(i)) * dt;
            f64::rem_euclid(angle - 0.5 * profile(time(i)) * dt, 360.0)
        })
        .collect();
    Drivers {
        dt_s: dt,
        start_s: 1000.0,
        samples: n,
        averaged: 1,
        temperature: series(&|t| 25.0 + 15.0 * (2.0 * PI * t / 2100.0).sin() + 3.0 * (t / 300.0).cos()),
        smooth_temperature: None,
        table_rate: series(&profile),
        table_angle: Some(table_angle),
        outer_rate: series(&|t| if t % 700.0 < 300.0 { 3.0 } else { -1.0 }),
        supply: series(&|t| 27.0 + 0.5 * (t / 41.0).sin()),
        others: series(&|t| 1010.0 + 4.0 * (t / 390.0).sin() + 0.001 * t)
            .map(|values| OtherDriver {
                column: Column::of_name("pressure_hPa"),
                smooth: values.clone(),
                values,
            })
            .into_iter()
            .collect(),
        claim: ClaimedMean {
            bias_deg_h: -3.0,
            temperature: Some(Temperature { coefficient_deg_h_per_degc: 0.02, reference_degc: 20.0 }),
            scale_factor_ppm: Some(12.0),
            earth: None,
        },
    }
}

/// The same length in days, for what needs days; at rest.
fn days() -> Drivers {
    let n = 6000;
    let temperature = Some((0..n).map(|i| 20.0 + (f64::from(i) / 500.0).sin()).collect());
    Drivers { dt_s: 60.0, samples: n as usize, averaged: 1, temperature, ..Drivers::default() }
}

/// A table at headings, with the Earth rate in the claim.
fn headings() -> Drivers {
    let all = drivers();
    let earth = Some(Earth { latitude_deg: 56.0, azimuth_deg: 12.0 });
    Drivers { table_rate: None, claim: ClaimedMean { scale_factor_ppm: None, earth, ..all.claim }, ..all }
}

/// Parameters of a truth for each course: drivers, numbers in the order of its parameters, list if any. White noise of
/// 0.05 deg/h is added to it.
fn truth(kind: &str) -> (Drivers, Vec<f64>) {
    match kind {
        "temp_linear" => (drivers(), vec![0.023]),
        "temp_polynomial" => (drivers(), vec![25.0, 15.0]),
        "temp_rate" => (drivers(), vec![0.02]),
        "thermal_lag" => (drivers(), vec![130.0]),
        "temp_hysteresis" => (drivers(), vec![0.05, 2.0, 0.0, 1.0]),
        "warmup_exponential" => (drivers(), vec![0.2, 210.0]),
        "rate_ramp" => (drivers(), vec![0.1]),
        "diurnal" => (days(), vec![0.02, 86_400.0, 40.0]),
        "line" => (drivers(), vec![0.2345, 0.01, 117.0]),
        "comb" => (drivers(), vec![0.0612]),
        "bias_step" => (drivers(), vec![0.05, 2111.3]),
        // At one heading: a table that turns shows the new heading in all its projections.
        "heading_change" => (Drivers { table_angle: None, ..drivers() }, vec![0.05, 2111.3]),
        "earth_rate_projection" => (headings(), vec![0.02, -20.0]),
        "table_harmonic" => (headings(), vec![3.0, 0.02, 77.0]),
        "reset_ripple" => (drivers(), vec![911.0, 0.05, 33.0, -2.95]),
        "sf_error" => (drivers(), vec![-4.0]),
        "sf_asymmetry" => (drivers(), vec![5.0]),
        "sf_nonlinearity" => (drivers(), vec![6.0, 9.0]),
        "sf_temperature" => (drivers(), vec![0.4]),
        "dead_zone" => (drivers(), vec![150.0, 0.8, 0.0]),
        "saturation" => (drivers(), vec![8.99]),
        "cross_axis" => (drivers(), vec![0.02]),
        "supply_sensitivity" => (drivers(), vec![0.05]),
        "temp_response" => (drivers(), vec![25.0, 15.0]),
        "column_driver" => (drivers(), vec![f64::NAN, 1010.0, 5.0]),
        "sf_driver" => (drivers(), vec![20.0, 27.0]),
        "sf_unrecorded" => (drivers(), vec![1000.0, 3000.0]),
        "time_offset" => (drivers(), vec![3.21]),
        "clock_drift" => (drivers(), vec![-870.0]),
        "column_law" => (drivers(), vec![]),
        "column_product" => (drivers(), vec![0.0, 25.0, 15.0, 27.0, 0.5]),
        "column_curve" => (drivers(), vec![0.0, 27.0, 0.5]),
        "drifting_line" => (drivers(), vec![0.2345, 1e-5, 0.015, 117.0, 2499.75]),
        _ => panic!("no truth for {kind}"),
    }
}

fn values(effect: &dyn Effect, numbers: &[f64], lists: Vec<(&'static str, Vec<f64>)>) -> Values {
    let numbers = effect.params().iter().zip(numbers).filter(|(_, x)| x.is_finite());
    let numbers = numbers.map(|(p, x)| (p.name.to_owned(), Value::Number(*x)));
    numbers.chain(lists.into_iter().map(|(name, x)| (name.to_owned(), Value::List(x)))).collect()
}

fn true_values(effect: &dyn Effect, numbers: &[f64]) -> Values {
    let lists = match effect.kind() {
        "temp_polynomial" => vec![("coefficients_deg_h", vec![0.01, 0.05, -0.03])],
        "sf_unrecorded" => vec![("coefficients_ppm", vec![2.0, -3.0])],
        "column_law" => vec![
            ("centers", vec![1010.0, 25.0]),
            ("half_ranges", vec![5.0, 15.0]),
            ("coefficients_deg_h", vec![0.01]),
        ],
        "column_product" => vec![("coefficients_deg_h", vec![0.03, 0.0, 0.01])],
        "column_curve" => vec![("coefficients_deg_h", vec![0.01, 0.03])],
        "comb" => vec![
            ("harmonics", vec![1.0, 2.0, 4.0]),
            ("coefficients_deg_h", vec![0.03, 0.0, 0.0, 0.02, 0.015, 0.01]),
        ],
        // A curve, a delay and a play at once.
        "temp_response" | "column_driver" => vec![
            ("terms", vec![1.0, 2.0, 12.0, 13.0]),
            ("scales", vec![0.0, 0.0, 375.0, 0.2]),
            ("coefficients_deg_h", vec![0.02, -0.03, 0.04, 0.02]),
        ],
        _ => vec![],
    };
    let column = match effect.kind() {
        "column_driver" => Some("pressure_hPa"),
        "sf_driver" => Some("supply_v"),
        _ => None,
    };
    let terms = (effect.kind() == "column_law").then_some("rate pressure_hPa * value temp_degC");
    let text = |name: &str, text: &str| (name.to_owned(), Value::Text(text.to_owned()));
    let texts = column.map(|c| text("column", c)).into_iter().chain(terms.map(|t| text("terms", t)));
    values(effect, numbers, lists).into_iter().chain(texts).collect()
}

/// Gain that the truth itself would have.
fn own_gain(course: &[f64], context: &SearchContext<'_>) -> f64 {
    let modes = dct2(course);
    let sum = modes.iter().zip(context.modes).zip(context.powers).skip(1);
    sum.map(|((f, r), p)| (r * f - 0.5 * f * f) / p).sum()
}

#[test]
fn courses_come_back_from_their_parameters_and_searches_find_them() {
    let sigma = 0.05;
    for effect in EFFECTS {
        let Model::Mean(course) = effect.model() else { continue };
        let kind = effect.kind();
        let (drivers, numbers) = truth(kind);
        assert!(course.applies(&drivers), "{kind}");
        assert!(effect.needs().iter().all(|c| drivers.column(*c).is_some()), "{kind}");
        let truth = course.course(&true_values(*effect, &numbers), &drivers).unwrap();
        let n = drivers.samples;
        let mut residual = noise(11, n, sigma);
        residual.iter_mut().zip(&truth).for_each(|(r, t)| *r += t);
        let power = sigma * sigma;
        let modes = dct2(&residual);
        let mean = residual.iter().sum::<f64>() / n as f64;
        let score: Vec<f64> = residual.iter().map(|r| (r - mean) / power).collect();
        let mut powers = vec![power; n];
        powers[0] = f64::INFINITY;
        let context = SearchContext { score: &score, modes: &modes, powers: &powers };
        let best = own_gain(&truth, &context);
        assert!(best > 10.0, "{kind}: the truth itself gains {best}");

        let starts = course.starts(&drivers, &context);
        assert!(starts.trials >= 1.0 && (1..=4).contains(&starts.points.len()), "{kind}: {starts:?}");
        let bounds = course.bounds(&drivers);
        let mut found = f64::NEG_INFINITY;
        for nonlinear_parameters in &starts.points {
            assert_eq!(nonlinear_parameters.len(), bounds.len(), "{kind}");
            for (x, bounds) in nonlinear_parameters.iter().zip(&bounds) {
                assert!(bounds.contains(*x), "{kind}: {x} outside {bounds:?}");
            }
            let parts = course.regressors(nonlinear_parameters, &drivers);
            found = found.max(crate::effect::shared::search::gain_of(parts.clone(), &context));
            let columns = parts.columns.iter().chain(&parts.nuisance).chain(&parts.offset);
            assert!(columns.flatten().all(|x| x.is_finite()), "{kind}");

            // The fitted course and that of its parameters are one.
            let coefficients: Vec<f64> = (0..parts.columns.len()).map(|k| 0.7 - 0.4 * k as f64).collect();
            let mut fitted = parts.offset.clone().unwrap_or_else(|| vec![0.0; n]);
            for (column, c) in parts.columns.iter().zip(&coefficients) {
                fitted.iter_mut().zip(column).for_each(|(f, x)| *f += c * x);
            }
            let numbers = course.parameters(nonlinear_parameters, &coefficients, &drivers);
            assert_eq!(numbers.len(), effect.params().len(), "{kind}");
            let lists = course.lists(nonlinear_parameters, &coefficients, &drivers);
            let texts = course.texts(nonlinear_parameters, &drivers).into_iter();
            let texts = texts.map(|(name, text)| (name.to_owned(), Value::Text(text)));
            let stated = values(*effect, &numbers, lists).into_iter().chain(texts).collect();
            let again = course.course(&stated, &drivers).unwrap();
            let size = fitted.iter().map(|x| x.abs()).fold(1e-12, f64::max);
            let apart = fitted.iter().zip(&again).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(apart < 1e-9 * size, "{kind}: {apart} of {size}");
            assert_eq!(again.len(), n, "{kind}");

            let places = course.places(nonlinear_parameters, &coefficients, &drivers);
            assert!((1..=3).contains(&places.len()), "{kind}");
            assert_eq!(places[0].domain, effect.domain(), "{kind}");
            assert!(places.iter().all(|p| p.from <= p.to), "{kind}: {places:?}");
            assert!(
                course.steps(&drivers).len() == bounds.len() || course.steps(&drivers).is_empty(),
                "{kind}"
            );
        }
        // Half of it is enough for a local search to go on from.
        assert!(found > 0.5 * best, "{kind}: found {found} of {best}, {starts:?}");
    }
}

#[test]
fn nothing_applies_without_its_columns_and_nothing_breaks() {
    let resting = Drivers {
        temperature: Some(vec![20.0; 6000]),
        table_rate: Some(vec![0.0; 6000]),
        table_angle: Some(vec![30.0; 6000]),
        outer_rate: Some(vec![0.0; 6000]),
        supply: Some(vec![27.0; 6000]),
        others: vec![],
        ..drivers()
    };
    let nothing = Drivers { dt_s: 1.0, ..Drivers::default() };
    let short = Drivers { dt_s: 1.0, samples: 3, averaged: 1, ..Drivers::default() };
    for effect in EFFECTS {
        let Model::Mean(course) = effect.model() else { continue };
        let moved_by_a_column =
            !effect.needs().is_empty() || ["time_offset", "clock_drift"].contains(&effect.kind());
        if moved_by_a_column {
            assert!(!course.applies(&resting), "{}", effect.kind());
        }
        for drivers in [&resting, &nothing, &short] {
            let zeros = vec![0.0; drivers.samples];
            let ones = vec![1.0; drivers.samples];
            let context = SearchContext { score: &zeros, modes: &zeros, powers: &ones };
            for nonlinear_parameters in course.starts(drivers, &context).points {
                course.regressors(&nonlinear_parameters, drivers);
            }
            course.bounds(drivers);
            course.regressors(&[], drivers);
            course.parameters(&[], &[], drivers);
            course.places(&[], &[], drivers);
            assert!(course.course(&Values::new(), drivers).is_none(), "{}", effect.kind());
        }
    }
}

#[test]
fn modes_in_closed_form_are_those_of_the_course() {
    let mut closed = vec![];
    for effect in EFFECTS {
        let Model::Mean(course) = effect.model() else { continue };
        let (drivers, _) = truth(effect.kind());
        let nonlinear_parameters: Vec<f64> =
            course.bounds(&drivers).iter().map(|b| 0.6 * b.low + 0.4 * b.high).collect();
        let Some(modes) = course.modes(&nonlinear_parameters, &drivers) else { continue };
        let parts = course.regressors(&nonlinear_parameters, &drivers);
        assert!(parts.offset.is_none() && parts.nuisance.is_empty() && parts.columns.len() == modes.len());
        for (modes, column) in modes.iter().zip(&parts.columns) {
            let wanted = crate::numeric::cosine::dct2(column);
            let off = modes.iter().zip(&wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-7, "{}: {off}", effect.kind());
        }
        closed.push(effect.kind());
    }
    assert!(closed.contains(&"line"), "{closed:?}");
}

#[test]
fn averages_see_the_course_that_the_samples_see() {
    // Slow courses are fitted to averages, where the means of the samples must be the same course.
    for effect in EFFECTS {
        let Model::Mean(course) = effect.model() else { continue };
        let (drivers, numbers) = truth(effect.kind());
        if course.resolution() != crate::effect::Resolution::Averaged {
            continue;
        }
        let values = true_values(*effect, &numbers);
        let fine = crate::effect::averages(&course.course(&values, &drivers).unwrap(), 8);
        let coarse = course.course(&values, &drivers.averages(8)).unwrap();
        let about = |x: &[f64]| {
            let mean = x.iter().sum::<f64>() / x.len() as f64;
            x.iter().map(|v| v - mean).collect::<Vec<f64>>()
        };
        let (fine, coarse) = (about(&fine), about(&coarse));
        let rms = |x: &[f64]| (x.iter().map(|v| v * v).sum::<f64>() / x.len() as f64).sqrt();
        let apart: Vec<f64> = fine.iter().zip(&coarse).map(|(a, b)| a - b).collect();
        assert!(rms(&apart) < 0.01 * rms(&fine), "{}: {} of {}", effect.kind(), rms(&apart), rms(&fine));
    }
}

#[test]
fn columns_of_needs_are_those_of_the_contract() {
    let needs = |kind: &str| find(kind).map(|e| e.needs().to_vec());
    assert_eq!(needs("sf_temperature"), Some(vec![Column::TableRate, Column::Temperature]));
    assert_eq!(needs("cross_axis"), Some(vec![Column::OuterRate]));
    assert_eq!(needs("rate_ramp"), Some(vec![]));
}
