//! Parameters of a course.

use super::estimated::{Estimated, interval};
use super::instant;
use super::placed::Placed;
use crate::effect::{Effect, MeanModel, Unmodelled, Value};
use crate::estimate::SCORE_TWO_SIDED_95;
use crate::mismatch::finding::ParameterValue;
use crate::mismatch::fitted_hypothesis::{FittedHypothesis, SpectralDataSet};
use crate::mismatch::terms::summed;
use nalgebra::DMatrix;

/// Standard deviation of a course over the record.
fn rms(sum: &[f64]) -> f64 {
    let n = sum.len().max(1) as f64;
    let mean = sum.iter().sum::<f64>() / n;
    (sum.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / n).sqrt()
}

/// As the noise at hand and the columns beside the course tell them.
pub(super) fn of_course(
    effect: &'static dyn Effect,
    course: &'static dyn MeanModel,
    index: usize,
    best: &FittedHypothesis,
    spectra: &SpectralDataSet,
) -> Estimated {
    let placed = Placed::new(course, index, best, spectra);
    let drivers = &placed.spectral.drivers;
    let nonlinear_parameters = &placed.inside.nonlinear_parameters;
    let (_, coefficients) = placed.log_likelihood(nonlinear_parameters);
    let covariance = placed.covariance(&coefficients);
    let free = placed.free_number();
    let deviation_of_shape = free.map_or(f64::NAN, |i| covariance[(i, i)].sqrt());
    let profile = placed.profile(deviation_of_shape);
    let values = course.parameters(nonlinear_parameters, &coefficients, drivers);
    let parts = course.regressors(nonlinear_parameters, drivers);
    let series = summed(&parts.columns, &coefficients, parts.offset.as_ref(), drivers.samples);
    let spread = rms(&series);
    // Everything that is a function of shape and coefficients, with the rms last.
    let all = |nonlinear_parameters: &[f64], coefficients: &[f64]| {
        let mut out = course.parameters(nonlinear_parameters, coefficients, drivers);
        let parts = course.regressors(nonlinear_parameters, drivers);
        out.push(rms(&summed(&parts.columns, coefficients, parts.offset.as_ref(), drivers.samples)));
        out
    };
    let mut deviations = propagate(nonlinear_parameters, &coefficients, &covariance, all);
    let Unmodelled { first_parameter, rms: of_spread } = course.unmodelled(nonlinear_parameters, drivers);
    if let ([first, .., last], Some(value)) = (&mut deviations[..], values.first()) {
        *first = first.hypot(first_parameter * value);
        *last = last.hypot(of_spread * spread);
    }
    let mut out = Estimated::default();
    for (i, (param, value)) in effect.params().iter().zip(&values).enumerate() {
        if !value.is_finite() {
            continue;
        }
        out.stated.insert(param.name.to_owned(), Value::Number(*value));
        if !param.reported {
            continue;
        }
        // A parameter that the shape alone determines takes the interval of the shape.
        let by_shape = profile.as_ref().and_then(|ends| {
            let still = course.parameters(
                nonlinear_parameters,
                &coefficients.iter().map(|c| 1.01 * c).collect::<Vec<_>>(),
                drivers,
            );
            if still.get(i) != Some(value) {
                return None;
            }
            hull(ends.iter().map(|shape| course.parameters(shape, &coefficients, drivers).get(i).copied()))
        });
        let Some(mut ci95) = by_shape.or_else(|| interval(param, *value, deviations[i])) else { continue };
        if param.instant
            && let Some([from, to]) = instant::interval(placed.inside, best, spectra)
        {
            ci95 = [from.min(*value), to.max(*value)];
        }
        let unit = param.unit.to_owned();
        out.reported.insert(param.name.to_owned(), ParameterValue { value: *value, unit, ci95 });
    }
    for (name, list) in course.lists(nonlinear_parameters, &coefficients, drivers) {
        out.stated.insert(name.to_owned(), Value::List(list));
    }
    out.formula = course.formula(nonlinear_parameters, &coefficients, drivers);
    for (name, text) in course.texts(nonlinear_parameters, drivers) {
        out.texts.insert(name.to_owned(), text.clone());
        out.stated.insert(name.to_owned(), Value::Text(text));
    }
    let deviation = deviations.last().copied().unwrap_or(f64::NAN).hypot(placed.nuisance_deviation(&series));
    if spread.is_finite() && deviation.is_finite() && spread > 0.0 {
        let factor = (SCORE_TWO_SIDED_95 * deviation / spread).min(30.0).exp();
        // A course without coefficients is as large as its shape makes it, by a model of what goes on within a sample that
        // is no truer than the recording can tell its size.
        let told = (SCORE_TWO_SIDED_95 * placed.size_deviation(&series)).min(30.0).exp();
        let by_shape = profile.filter(|_| coefficients.is_empty()).and_then(|ends| {
            let [a, b] = hull(ends.iter().map(|shape| all(shape, &[]).last().copied()))?;
            Some([a.min(spread / told), b.max(spread * told)])
        });
        let ci95 = by_shape.unwrap_or([spread / factor, spread * factor]);
        out.reported
            .insert("rms_deg_h".to_owned(), ParameterValue { value: spread, unit: "deg/h".to_owned(), ci95 });
    }
    out
}

/// Least and largest of some values; `None` where they are all the same, or one is missing.
fn hull(values: impl Iterator<Item = Option<f64>>) -> Option<[f64; 2]> {
    let widened = |[low, high]: [f64; 2], value: Option<f64>| value.map(|x| [low.min(x), high.max(x)]);
    let mut values = values;
    let hull = values.try_fold([f64::INFINITY, f64::NEG_INFINITY], widened)?;
    (hull[0] < hull[1]).then_some(hull)
}

/// Standard deviations of functions of shape and coefficients by their numerical derivatives.
fn propagate(
    nonlinear_parameters: &[f64],
    coefficients: &[f64],
    covariance: &DMatrix<f64>,
    functions: impl Fn(&[f64], &[f64]) -> Vec<f64>,
) -> Vec<f64> {
    let (d, p) = (nonlinear_parameters.len(), nonlinear_parameters.len() + coefficients.len());
    let count = functions(nonlinear_parameters, coefficients).len();
    let mut slopes: Vec<Vec<f64>> = vec![];
    for i in 0..p {
        let deviation = covariance[(i, i)].max(0.0).sqrt();
        if deviation == 0.0 {
            // A known parameter is not moved: a whole number less a little is another one.
            slopes.push(vec![0.0; count]);
            continue;
        }
        let step = 0.05 * deviation;
        let moved = |sign: f64| {
            let (mut s, mut c) = (nonlinear_parameters.to_vec(), coefficients.to_vec());
            if i < d {
                s[i] += sign * step
            } else {
                c[i - d] += sign * step
            }
            functions(&s, &c)
        };
        let (up, down) = (moved(1.0), moved(-1.0));
        slopes.push(up.iter().zip(&down).map(|(a, b)| (a - b) / (2.0 * step)).collect());
    }
    (0..count)
        .map(|k| {
            let mut sum = 0.0f64;
            for i in 0..p {
                for j in 0..p {
                    sum += slopes[i][k] * covariance[(i, j)] * slopes[j][k];
                }
            }
            if sum < 0.0 { 0.0 } else { sum.sqrt() }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deviations_of_products_and_sums_follow_from_those_of_their_parts() {
        // A nonlinear 3 ± 0.1 and a coefficient 4 ± 0.2, independent: 12 ± √(0.4² + 0.6²), 7 ± √0.05.
        let covariance = DMatrix::from_row_slice(2, 2, &[0.01, 0.0, 0.0, 0.04]);
        let both = |a: &[f64], b: &[f64]| vec![a[0] * b[0], a[0] + b[0]];
        let deviations = propagate(&[3.0], &[4.0], &covariance, both);
        assert!((deviations[0] - 0.52f64.sqrt()).abs() < 1e-9, "{deviations:?}");
        assert!((deviations[1] - 0.05f64.sqrt()).abs() < 1e-9, "{deviations:?}");
        // With a correlation of −1 the sum is known to the difference.
        let opposed = DMatrix::from_row_slice(2, 2, &[0.01, -0.02, -0.02, 0.04]);
        assert!((propagate(&[3.0], &[4.0], &opposed, both)[1] - 0.1).abs() < 1e-9);
    }

    #[test]
    fn a_whole_number_leaves_the_deviation_to_the_coefficient() {
        // The column of that number is counted in units of 4; another number is no column.
        let covariance = DMatrix::from_row_slice(2, 2, &[0.0, 0.0, 0.0, 0.04]);
        let of_column = |a: &[f64], b: &[f64]| vec![if a[0] as usize == 3 { b[0] / 4.0 } else { f64::NAN }];
        let deviations = propagate(&[3.0], &[4.0], &covariance, of_column);
        assert!((deviations[0] - 0.05).abs() < 1e-9, "{deviations:?}");
        // What cannot be told has no deviation.
        let none = propagate(&[2.0], &[4.0], &covariance, of_column);
        assert!(none[0].is_nan(), "{none:?}");
    }

    #[test]
    fn the_rms_of_a_course_is_about_its_mean() {
        assert_eq!(rms(&[5.0, 9.0, 5.0, 9.0]), 2.0);
        assert_eq!(rms(&[]), 0.0);
    }
}
