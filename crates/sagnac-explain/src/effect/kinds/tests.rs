//! The catalogue held against the contract, and every course against itself: what a fit finds must come back from its
//! parameters, and searches must find what is there.

use super::truths::{drivers, noise, true_values, truth, values};
use super::*;
use crate::effect::{Column, Drivers, Model, SearchContext, Value, Values};
use crate::numeric::cosine::dct2;
use std::collections::BTreeSet;

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
            let confuser = confuser.kind();
            assert!(confuser != kind && find(confuser).is_some(), "{kind}: {confuser}");
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
