//! Order of the polynomial by blocked cross-validation over whole ramps.
//!
//! Each ramp with the dwell behind it is held out in turn. With Q = P⁻¹ − P⁻¹X(XᵀP⁻¹X)⁻¹XᵀP⁻¹ the prediction error of a
//! held-out stretch from all the rest, coefficients fitted and slow noise carried over from it, is Q_BB⁻¹(Qy)_B, with
//! covariance Q_BB⁻¹ (deletion formula of best linear unbiased prediction). The lowest order is taken whose predictive density
//! falls short of the largest by no more than one standard error of the difference, estimated from its scatter over the stretches
//! (Breiman et al. 1984).

use super::course::{Course, Span, Terms};
use super::gls::{Modes, Solved};
use super::posterior;
use crate::numeric::cholesky::log_determinant;
use crate::numeric::cosine::inverse_dct2;
use crate::recording::window::TimeSpan;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;

/// Highest degree of the polynomial that is tried.
pub const MAX_ORDER: usize = 6;
/// Blocks of the record for this purpose at most.
const MAX_BLOCKS: usize = 480;

/// One degree of the polynomial with its score in cross-validation.
#[derive(Debug, Clone, PartialEq)]
pub struct Tried {
    /// Order.
    pub order: usize,
    /// Sum of the logarithms of the predictive densities of all stretches.
    pub log_score: f64,
    /// The same of every stretch.
    pub scores: Vec<f64>,
    /// Rms of the prediction errors, deg/h.
    pub held_out_rms: f64,
    /// Length of the means that were predicted, s.
    pub average_s: f64,
}

/// Every order with its score. `folds` are the held-out stretches, s from the start of the recording.
pub fn try_orders(
    course: &Course,
    span: Span,
    folds: &[TimeSpan],
    terms: impl Fn(usize) -> Terms,
    highest: usize,
) -> Vec<Tried> {
    let coarse = course.merged(course.len().div_ceil(MAX_BLOCKS));
    let modes = Modes::new(coarse.len(), coarse.block_s);
    let data = modes.of(&coarse.rate_deg_h);
    (1..=highest.min(MAX_ORDER))
        .filter_map(|order| {
            let terms = terms(order);
            let (best, _) = posterior::best(&coarse, terms, span)?;
            let columns: Vec<Vec<f64>> =
                coarse.columns(&terms, &best.shape, &span).iter().map(|c| modes.of(c)).collect();
            let (scores, held_out_rms) = score(&coarse, &data, &columns, &best.fitted.solved, folds)?;
            let log_score = scores.iter().sum();
            Some(Tried { order, log_score, scores, held_out_rms, average_s: coarse.block_s })
        })
        .collect()
}

/// Loss of score, in natural logarithms, that a lower order may cost in any case.
const ALLOWED_SCORE_LOSS: f64 = 1.5;

/// The lowest order that predicts the stretches as well as the best one does, within one standard error of the difference.
pub fn choose(tried: &[Tried]) -> Option<&Tried> {
    let best = tried.iter().max_by(|a, b| a.log_score.total_cmp(&b.log_score))?;
    tried.iter().find(|t| {
        let losses: Vec<f64> = best.scores.iter().zip(&t.scores).map(|(b, t)| b - t).collect();
        losses.iter().sum::<f64>() <= standard_error(&losses).max(ALLOWED_SCORE_LOSS)
    })
}

/// Standard error of a sum of numbers by their scatter.
fn standard_error(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    if n > 1.0 { (squares * n / (n - 1.0)).sqrt() } else { 0.0 }
}

fn score(
    course: &Course,
    data: &[f64],
    columns: &[Vec<f64>],
    solved: &Solved,
    folds: &[TimeSpan],
) -> Option<(Vec<f64>, f64)> {
    let n = course.len();
    let inverse: Vec<f64> = solved.powers.iter().map(|p| 1.0 / p).collect();
    let back = |modes: &dyn Fn(usize) -> f64| {
        let all: Vec<f64> = std::iter::once(0.0).chain((0..n - 1).map(modes)).collect();
        inverse_dct2(&all)
    };
    let residual = |k: usize| {
        let fitted: f64 = columns.iter().zip(solved.coefficients.iter()).map(|(c, b)| c[k] * b).sum();
        data[k] - fitted
    };
    // Q y equals P⁻¹ times the residual of the whole fit.
    let projected = back(&|k| inverse[k] * residual(k));
    let influence: Vec<Vec<f64>> = columns.iter().map(|c| back(&|k| inverse[k] * c[k])).collect();
    let kernel = kernel(&inverse, n);
    let (mut scores, mut squares, mut count) = (vec![], 0.0, 0usize);
    for fold in folds {
        let at = |t: f64| (((t - course.first_s) / course.block_s).round().max(0.0) as usize).min(n);
        let (from, to) = (at(fold.from_s), at(fold.to_s));
        if to <= from + 1 || to - from >= n {
            continue;
        }
        let m = to - from;
        let p = columns.len();
        let u = DMatrix::from_fn(m, p, |i, j| influence[j][from + i]);
        let correction = &u * &solved.covariance * u.transpose();
        let q = DMatrix::from_fn(m, m, |i, j| {
            let (a, b) = (from + i, from + j);
            0.5 * (kernel[a.abs_diff(b)] + kernel[a + b + 1]) - correction[(i, j)]
        });
        let right = DVector::from_fn(m, |i, _| projected[from + i]);
        let ridge = 1e-12 * q.diagonal().max();
        let factor = (q + DMatrix::identity(m, m) * ridge).cholesky()?;
        let errors = factor.solve(&right);
        let log_determinant = log_determinant(&factor);
        scores.push(0.5 * log_determinant - 0.5 * errors.dot(&right));
        squares += errors.norm_squared();
        count += m;
    }
    (count > 0).then(|| (scores, (squares / count as f64).sqrt()))
}

/// (2/n) Σₖ wₖ cos(πkm/n) for m = 0 … 2n − 1.
fn kernel(weights: &[f64], n: usize) -> Vec<f64> {
    let cosines: Vec<f64> = (0..2 * n).map(|j| (PI * j as f64 / n as f64).cos()).collect();
    (0..2 * n)
        .map(|m| {
            let sum: f64 =
                weights.iter().enumerate().map(|(i, w)| w * cosines[((i + 1) * m) % (2 * n)]).sum();
            2.0 / n as f64 * sum
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Held-out errors by fitting the rest, with dense matrices.
    fn dense(y: &[f64], x: &[f64], powers: &[f64], from: usize, to: usize) -> Vec<f64> {
        let n = y.len();
        // A mode of order zero with a variance far above all: a constant that is not known.
        let variance = |k: usize| if k == 0 { 1e7 } else { powers[k - 1] };
        let c = DMatrix::from_fn(n, n, |k, i| {
            let norm = if k == 0 { (1.0 / n as f64).sqrt() } else { (2.0 / n as f64).sqrt() };
            norm * (PI * k as f64 * (i as f64 + 0.5) / n as f64).cos()
        });
        let s = c.transpose() * DMatrix::from_fn(n, n, |i, j| if i == j { variance(i) } else { 0.0 }) * &c;
        let rest: Vec<usize> = (0..n).filter(|i| *i < from || *i >= to).collect();
        let held: Vec<usize> = (from..to).collect();
        let pick = |a: &[usize], b: &[usize]| DMatrix::from_fn(a.len(), b.len(), |i, j| s[(a[i], b[j])]);
        let srr = pick(&rest, &rest).try_inverse().unwrap();
        let xr = DVector::from_fn(rest.len(), |i, _| x[rest[i]]);
        let yr = DVector::from_fn(rest.len(), |i, _| y[rest[i]]);
        let beta = (xr.transpose() * &srr * &yr)[0] / (xr.transpose() * &srr * &xr)[0];
        let carried = pick(&held, &rest) * &srr * (&yr - &xr * beta);
        held.iter().enumerate().map(|(i, h)| y[*h] - x[*h] * beta - carried[i]).collect()
    }

    fn tried(order: usize, scores: [f64; 4]) -> Tried {
        let log_score = scores.iter().sum();
        Tried { order, log_score, scores: scores.to_vec(), held_out_rms: 0.0, average_s: 60.0 }
    }

    #[test]
    fn the_lowest_order_within_one_standard_error_is_taken() {
        let curve = [
            tried(1, [180.0, 182.0, 470.0, 470.0]),
            tried(3, [204.4, 220.8, 514.4, 506.9]),
            tried(5, [202.0, 224.4, 516.0, 506.4]),
        ];
        // Ahead by 2.3, with a standard error of 4.8.
        assert_eq!(choose(&curve).unwrap().order, 3);
        // Ahead by 8 at every stretch alike.
        let ahead = [tried(3, [204.4, 220.8, 514.4, 506.9]), tried(5, [206.4, 222.8, 516.4, 508.9])];
        assert_eq!(choose(&ahead).unwrap().order, 5);
        assert_eq!(choose(&[]), None);
    }

    #[test]
    fn held_out_errors_are_those_of_fitting_the_rest() {
        let n = 40;
        let y: Vec<f64> = (0..n).map(|i| ((i * 37 % 11) as f64).sin() + 0.1 * i as f64).collect();
        let x: Vec<f64> = (0..n).map(|i| (0.2 * i as f64).sin()).collect();
        let modes = Modes::new(n, 60.0);
        let solved = modes.solve(&modes.of(&y), &[modes.of(&x)], &[0.05, 0.5, 0.8]).unwrap();
        let course = Course {
            block_s: 60.0,
            first_s: 0.0,
            rate_deg_h: y.clone(),
            temperature_deg_c: x.clone(),
            bridged: 0.0,
        };
        let folds = [TimeSpan { from_s: 600.0, to_s: 1200.0 }];
        let (_, rms) = score(&course, &modes.of(&y), &[modes.of(&x)], &solved, &folds).unwrap();
        let errors = dense(&y, &x, &solved.powers, 10, 20);
        let expected = (errors.iter().map(|e| e * e).sum::<f64>() / 10.0).sqrt();
        assert!((rms / expected - 1.0).abs() < 1e-4, "{rms} {expected}");
    }
}
