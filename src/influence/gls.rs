//! Generalised least squares without noise that the record does not show.

use crate::numeric::reml::{self, Fit};
use nalgebra::{DMatrix, DVector};

/// Share of the whole covariance below which a component does not count.
const SHARE: f64 = 1e-3;

/// Fits a model as [`reml::fit`]; components without a share in the noise are left out of it, and so is the doubt about
/// them: how slow noise that is not seen might move the mean of the whole record is no part of a single mean.
pub fn lean(
    y: &DVector<f64>,
    x: &DMatrix<f64>,
    fixed: &DMatrix<f64>,
    components: &[DMatrix<f64>],
) -> Option<Fit> {
    let fit = reml::fit(y, x, fixed, components)?;
    let parts: Vec<f64> = components.iter().zip(&fit.strengths).map(|(v, s)| s * v.trace()).collect();
    let total: f64 = parts.iter().sum();
    let kept: Vec<DMatrix<f64>> =
        components.iter().zip(&parts).filter(|(_, p)| **p > SHARE * total).map(|(v, _)| v.clone()).collect();
    if kept.len() == components.len() || kept.is_empty() {
        return Some(fit);
    }
    Some(reml::fit(y, x, fixed, &kept).unwrap_or(fit))
}
