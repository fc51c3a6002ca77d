//! The instant of a step, with its interval.
//!
//! The likelihood of an instant has several maxima and kinks, so that no drop of its logarithm gives an interval of a known
//! confidence. With every instant as likely beforehand, its probability given the recording is the likelihood with the
//! size of the step fitted; the interval spans the most probable instants that hold 95 % together.

use crate::mismatch::fitted_hypothesis::{FittedHypothesis, SpectralDataSet};
use crate::mismatch::hypothesis::PartModes;
use crate::mismatch::terms::MeanTerm;
use crate::numeric::cosine::{dct2, inverse_dct2};
use crate::numeric::order::SortByNumber;

/// Probability that an interval holds.
const INTERVAL_PROBABILITY: f64 = 0.95;
/// Places at which the weight of a step is computed; it is interpolated between.
const WEIGHT_POINTS: usize = 48;

/// The interval of the instant of a course that is a step of one size, s on the time of the recording. `None` for other
/// courses.
pub fn interval(inside: &MeanTerm, tried: &FittedHypothesis, spectra: &SpectralDataSet) -> Option<[f64; 2]> {
    let spectral = &spectra.full;
    let n = spectral.drivers.samples;
    let parts = PartModes::of_shape(inside.course()?, &inside.nonlinear_parameters, spectral);
    let ([column], [size]) = (parts.columns.as_slice(), inside.coefficients.as_slice()) else { return None };
    if n < 16 {
        return None;
    }
    let (residual, powers) = (tried.residual(spectra), tried.powers(spectra));
    let weighted: Vec<f64> = residual
        .iter()
        .zip(column)
        .zip(&powers)
        .map(|((r, z), p)| if p.is_finite() { (r + size * z) / p } else { 0.0 })
        .collect();
    let score = inverse_dct2(&weighted);
    let at = |place: usize| 1 + place * (n - 2) / WEIGHT_POINTS;
    let weight = |j: usize| {
        let step: Vec<f64> = (0..n).map(|i| f64::from(u8::from(i >= j))).collect();
        dct2(&step).iter().zip(&powers).skip(1).map(|(z, p)| z * z / p).sum::<f64>()
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
    let largest = gains.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut likely: Vec<(f64, usize)> =
        gains.iter().enumerate().map(|(j, g)| ((g - largest).exp(), j)).filter(|(p, _)| *p > 1e-9).collect();
    likely.sort_descending_by(|a| a.0);
    let whole: f64 = likely.iter().map(|l| l.0).sum();
    let (mut held, mut first, mut last) = (0.0, n, 0);
    for (p, j) in likely {
        (first, last) = (first.min(j), last.max(j));
        held += p;
        if held >= INTERVAL_PROBABILITY * whole {
            break;
        }
    }
    // Sample j is the first behind the step: the step falls into it or into the interval before.
    let time = |j: f64| spectral.drivers.time_s(0) + j * spectral.drivers.dt_s;
    (first <= last).then(|| [time(first as f64 - 1.0), time(last as f64)])
}
