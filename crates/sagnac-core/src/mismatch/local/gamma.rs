//! Levels of noise by regression: mean squares of groups follow scaled χ² laws whose logarithm is linear in columns.

use nalgebra::{DMatrix, DVector};

/// Mean square of a group and its degrees of freedom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Group {
    /// Mean square.
    pub square: f64,
    /// Values in it.
    pub dof: f64,
}

/// A fit of ln g² = Σ β x.
#[derive(Debug, Clone)]
pub struct GammaFit {
    /// ln g² of each group.
    pub log_squares: Vec<f64>,
    /// Covariance of the coefficients, that of the constant first.
    pub covariance: DMatrix<f64>,
    /// Log-likelihood over that of one level for all.
    pub gain: f64,
}

/// Mean square of all groups.
pub fn mean_square(groups: &[Group]) -> f64 {
    let dof: f64 = groups.iter().map(|g| g.dof).sum();
    groups.iter().map(|g| g.dof * g.square).sum::<f64>() / dof.max(1e-300)
}

fn log_likelihood(groups: &[Group], log_squares: &[f64]) -> f64 {
    -0.5 * groups.iter().zip(log_squares).map(|(g, l)| g.dof * (l + g.square * (-l).exp())).sum::<f64>()
}

/// Fits columns beside a constant by Fisher scoring.
pub fn fit(groups: &[Group], columns: &[Vec<f64>]) -> Option<GammaFit> {
    let p = columns.len() + 1;
    let level = mean_square(groups);
    if !(level > 0.0 && level.is_finite()) || groups.len() < 2 * p {
        return None;
    }
    let x = |j: usize, i: usize| if j == 0 { 1.0 } else { columns[j - 1][i] };
    let mut information = DMatrix::zeros(p, p);
    for (i, group) in groups.iter().enumerate() {
        for a in 0..p {
            for b in 0..p {
                information[(a, b)] += 0.5 * group.dof * x(a, i) * x(b, i);
            }
        }
    }
    let covariance = information.clone().cholesky()?.inverse();
    let mut beta = DVector::zeros(p);
    beta[0] = level.ln();
    let logs = |beta: &DVector<f64>| -> Vec<f64> {
        (0..groups.len()).map(|i| (0..p).map(|j| beta[j] * x(j, i)).sum::<f64>()).collect()
    };
    let mut log_squares = logs(&beta);
    let constant = log_likelihood(groups, &log_squares);
    let mut best = constant;
    for _ in 0..40 {
        let gradient = DVector::from_fn(p, |j, _| {
            let one =
                |(i, g): (usize, &Group)| 0.5 * g.dof * x(j, i) * (g.square * (-log_squares[i]).exp() - 1.0);
            groups.iter().enumerate().map(one).sum::<f64>()
        });
        let mut step = &covariance * gradient;
        let mut moved = false;
        for _ in 0..20 {
            let next = &beta + &step;
            let tried = logs(&next);
            let got = log_likelihood(groups, &tried);
            if got > best {
                moved = got - best > 1e-9;
                (beta, log_squares, best) = (next, tried, got);
                break;
            }
            step *= 0.4;
        }
        if !moved {
            break;
        }
    }
    Some(GammaFit { log_squares, covariance, gain: best - constant })
}

/// Spread of the groups about a fit over what χ² laws give, at least 1: the factor by which heavy tails or correlation
/// make gains of nothing larger.
pub fn overdispersion(groups: &[Group], log_squares: &[f64], parameters: usize) -> f64 {
    let one = |(g, l): (&Group, &f64)| 0.5 * g.dof * (g.square * (-l).exp() - 1.0).powi(2);
    let sum: f64 = groups.iter().zip(log_squares).map(one).sum();
    (sum / (groups.len() as f64 - parameters as f64).max(1.0)).max(1.0)
}
