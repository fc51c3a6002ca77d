//! Generalised least squares without noise that the record does not show.

use crate::numeric::reml::{self, Fit};
use nalgebra::{DMatrix, DVector};

/// Share of the whole covariance below which a component does not count.
const MIN_VARIANCE_SHARE: f64 = 1e-3;

/// Fits a model as [`reml::fit`]; components without a share in the noise are left out of it, and so is the doubt about
/// them: how slow noise that is not seen might move the mean of the whole record is no part of a single mean. The first
/// `own` components are kept: each is all the noise that some rows have, however small beside that of others.
pub fn pruned_fit(
    y: &DVector<f64>,
    x: &DMatrix<f64>,
    fixed: &DMatrix<f64>,
    components: &[DMatrix<f64>],
    own: usize,
) -> Option<Fit> {
    let fit = reml::fit(y, x, fixed, components)?;
    let shown = shown(&fit, components);
    let kept: Vec<DMatrix<f64>> = (0..components.len())
        .filter(|k| *k < own || shown.contains(k))
        .map(|k| components[k].clone())
        .collect();
    if kept.len() == components.len() || kept.is_empty() {
        return Some(fit);
    }
    Some(reml::fit(y, x, fixed, &kept).unwrap_or(fit))
}

/// The components that have a share in the noise of a fit.
pub fn shown(fit: &Fit, components: &[DMatrix<f64>]) -> Vec<usize> {
    let parts: Vec<f64> =
        components.iter().zip(&fit.variance_components).map(|(v, s)| s * v.trace()).collect();
    let total: f64 = parts.iter().sum();
    (0..components.len()).filter(|k| parts[*k] > MIN_VARIANCE_SHARE * total).collect()
}
