//! The instant of a step, with its interval.
//!
//! The likelihood of an instant has several maxima and kinks, so that no drop of its logarithm gives an interval of a known
//! confidence. With every instant as likely beforehand, its probability given the recording is the likelihood with the
//! size of the step fitted; the interval spans the most probable instants that hold 95 % together.

use crate::effect::MeanModel;
use crate::mismatch::fitted_hypothesis::{FittedHypothesis, SpectralDataSet};
use crate::mismatch::hypothesis::PartModes;
use crate::mismatch::spectral_data::SpectralData;
use crate::mismatch::terms::MeanTerm;
use crate::numeric::cosine::{dct2, inverse_dct2};
use crate::numeric::least_squares::Normal;
use crate::numeric::order::SortByNumber;
use crate::numeric::parallel;

/// Probability that an interval holds.
const INTERVAL_PROBABILITY: f64 = 0.95;
/// Places at which the weight of a step is computed; it is interpolated between.
const WEIGHT_POINTS: usize = 48;
/// Instants at which a course of several columns is fitted anew.
const FITTED_INSTANTS: usize = 256;

/// The interval of the instant of a course, s on the time of the recording. `None` for other courses, and for short records.
pub fn interval(inside: &MeanTerm, tried: &FittedHypothesis, spectra: &SpectralDataSet) -> Option<[f64; 2]> {
    let (spectral, course) = (&spectra.full, inside.course()?);
    if spectral.drivers.samples < 16 {
        return None;
    }
    let parts = PartModes::of_shape(course, &inside.nonlinear_parameters, spectral);
    // What is left without the course.
    let mut left = tried.residual(spectra);
    for (column, size) in parts.columns.iter().zip(&inside.coefficients) {
        left.iter_mut().zip(column).for_each(|(r, z)| *r += size * z);
    }
    let powers = tried.powers(spectra);
    match (inside.nonlinear_parameters.as_slice(), inside.coefficients.len()) {
        ([_], 1) => of_step(&left, &powers, spectral),
        ([_], 2..) => of_columns(course, &left, &powers, spectral),
        _ => None,
    }
}

/// That of a course of several columns, on a grid of instants: a table that turns may hide for a long while that it has begun.
fn of_columns(
    course: &dyn MeanModel,
    left: &[f64],
    powers: &[f64],
    spectral: &SpectralData,
) -> Option<[f64; 2]> {
    let bounds = *course.bounds(&spectral.drivers).first()?;
    let count = FITTED_INSTANTS.min(spectral.drivers.samples / 4);
    let step = bounds.width() / count as f64;
    let edge = |i: usize| bounds.low + step * i as f64;
    // Only differences of the log-likelihood count.
    let gain = |i: usize| {
        let columns = PartModes::of_shape(course, &[edge(i) + 0.5 * step], spectral).columns;
        let free: Vec<(&[f64], f64)> = columns.iter().map(|c| (c.as_slice(), f64::INFINITY)).collect();
        let (_, _, unexplained) = Normal::new(&free, left, powers).solve();
        -0.5 * unexplained
    };
    let [first, last] = most_probable(&parallel::map(count, gain))?;
    Some([first, last + 1].map(|i| spectral.drivers.start_s + edge(i)))
}

/// That of a step of one size: the sum of what is left from each instant on tells its gain at once.
fn of_step(left: &[f64], powers: &[f64], spectral: &SpectralData) -> Option<[f64; 2]> {
    let n = spectral.drivers.samples;
    let weighted: Vec<f64> =
        left.iter().zip(powers).map(|(r, p)| if p.is_finite() { r / p } else { 0.0 }).collect();
    let score = inverse_dct2(&weighted);
    let at = |place: usize| 1 + place * (n - 2) / WEIGHT_POINTS;
    let weight = |j: usize| {
        let step: Vec<f64> = (0..n).map(|i| f64::from(u8::from(i >= j))).collect();
        dct2(&step).iter().zip(powers).skip(1).map(|(z, p)| z * z / p).sum::<f64>()
    };
    let weights: Vec<f64> = (0..=WEIGHT_POINTS).map(|p| weight(at(p))).collect();
    let (mut gains, mut sum, mut place) = (vec![f64::NEG_INFINITY; n], 0.0, WEIGHT_POINTS - 1);
    for j in (1..n).rev() {
        sum += score[j];
        while place > 0 && j < at(place) {
            place -= 1;
        }
        let (from, to) = (at(place), at(place + 1));
        let x = (j as f64 - from as f64) / (to.max(from + 1) - from) as f64;
        let w = weights[place] + (weights[place + 1] - weights[place]) * x.clamp(0.0, 1.0);
        if w > 0.0 {
            gains[j] = 0.5 * sum * sum / w;
        }
    }
    let [first, last] = most_probable(&gains)?;
    // Sample j is the first behind the step: the step falls into it or into the interval before.
    let time = |j: f64| spectral.drivers.time_s(0) + j * spectral.drivers.dt_s;
    Some([time(first as f64 - 1.0), time(last as f64)])
}

/// First and last of the most probable instants that hold the probability of an interval together, by the gain of each.
fn most_probable(gains: &[f64]) -> Option<[usize; 2]> {
    let largest = gains.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut likely: Vec<(f64, usize)> =
        gains.iter().enumerate().map(|(j, g)| ((g - largest).exp(), j)).filter(|(p, _)| *p > 1e-9).collect();
    likely.sort_descending_by(|a| a.0);
    let whole: f64 = likely.iter().map(|l| l.0).sum();
    let (mut held, mut first, mut last) = (0.0, usize::MAX, 0);
    for (p, j) in likely {
        (first, last) = (first.min(j), last.max(j));
        held += p;
        if held >= INTERVAL_PROBABILITY * whole {
            break;
        }
    }
    (first <= last).then_some([first, last])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instants_far_apart_that_are_as_probable_are_both_held() {
        let mut gains = vec![0.0; 100];
        (gains[20], gains[70], gains[71]) = (50.0, 49.5, 49.0);
        assert_eq!(most_probable(&gains), Some([20, 71]));
        gains[20] = 60.0;
        assert_eq!(most_probable(&gains), Some([20, 20]));
        assert_eq!(most_probable(&[]), None);
    }
}
