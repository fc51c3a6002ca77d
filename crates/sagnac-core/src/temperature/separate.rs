//! Whether rate of temperature, lag and hysteresis can be told apart by the schedule.
//!
//! Each regressor, the derivative by the lag among them, is compared with what all others leave of it, in the metric of the
//! noise. The variance inflation (the diagonal of the scaled information times that of its inverse) does not depend on
//! the size of the noise or of the effects: it is a property of the schedule and of the curvature of the bias.

use super::course::{Course, Shape};
use super::course::{Span, Terms};
use super::gls::Modes;
use super::posterior::Best;
use nalgebra::DMatrix;

/// Inflation of the variance from which terms count as one.
pub const INSEPARABLE_INFLATION: f64 = 200.0;

/// How far each term is told from the others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Separation {
    /// Inflation of the variance of the sensitivity to the rate of temperature.
    pub rate: f64,
    /// Of the lag; infinite where the bias does not depend on temperature.
    pub lag: f64,
    /// Of the hysteresis.
    pub hysteresis: f64,
    /// Condition number of the scaled regressors.
    pub condition: f64,
}

/// Variance inflations of rate, lag and hysteresis at the best fit; `None` where a regressor is zero.
pub fn separation(course: &Course, terms: &Terms, span: &Span, best: &Best) -> Option<Separation> {
    let modes = Modes::new(course.len(), course.block_s);
    let columns = course.columns(terms, &best.shape, span);
    let step = (0.05 * best.shape.lag_s).max(course.block_s);
    let later = Shape { lag_s: best.shape.lag_s + step, ..best.shape };
    let moved = course.columns(terms, &later, span);
    let coefficients = &best.fitted.solved.coefficients;
    let by_lag: Vec<f64> = (0..course.len())
        .map(|i| {
            let change = columns.iter().zip(&moved).zip(coefficients.iter()).take(terms.order);
            change.map(|((a, b), c)| c * (b[i] - a[i]) / step).sum()
        })
        .collect();
    let all: Vec<Vec<f64>> = columns.iter().chain(std::iter::once(&by_lag)).map(|c| modes.of(c)).collect();
    let inverse: Vec<f64> = best.fitted.solved.powers.iter().map(|p| 1.0 / p).collect();
    let p = all.len();
    let mut a = DMatrix::from_fn(p, p, |i, j| {
        all[i].iter().zip(&all[j]).zip(&inverse).map(|((x, y), w)| x * y * w).sum::<f64>()
    });
    let scale: Vec<f64> = (0..p).map(|i| a[(i, i)].sqrt()).collect();
    if scale.iter().any(|s| !s.is_finite() || *s <= 0.0) {
        return None;
    }
    for i in 0..p {
        for j in 0..p {
            a[(i, j)] /= scale[i] * scale[j];
        }
    }
    let eigen = a.clone().symmetric_eigen();
    let condition = eigen.eigenvalues.max() / eigen.eigenvalues.min().max(1e-15);
    let inflation = (a + DMatrix::identity(p, p) * 1e-12).try_inverse()?;
    let of = |at: Option<usize>| at.map_or(f64::INFINITY, |i| inflation[(i, i)]);
    Some(Separation {
        rate: of(terms.rate_at()),
        lag: of(Some(p - 1)),
        hysteresis: of(terms.hysteresis_at()),
        condition,
    })
}
