//! Overlapping Allan variances at octaves, and least squares with nonnegative unknowns, as the usual methods use them.

use nalgebra::{DMatrix, DVector};

/// An Allan variance.
#[derive(Debug, Clone, Copy)]
pub struct Point {
    /// Averaging time, s.
    pub tau_s: f64,
    /// (deg/h)²
    pub variance: f64,
    /// Disjoint windows of this length in the record.
    pub windows: f64,
}

/// Overlapping Allan variances of rate samples at octaves from τ0 up to `longest` of the record.
pub fn octaves(y: &[f64], tau0_s: f64, longest: f64) -> Vec<Point> {
    let count = y.len();
    let mut sum = Vec::with_capacity(count + 1);
    let (first, mut total) = (y[0], 0.0);
    sum.push(0.0);
    for v in y {
        total += v - first;
        sum.push(total);
    }
    let mut out = vec![];
    let mut m = 1;
    while m as f64 <= longest * count as f64 && 2 * m < count {
        let terms = count - 2 * m + 1;
        let squares: f64 = (0..terms).map(|i| (sum[i + 2 * m] - 2.0 * sum[i + m] + sum[i]).powi(2)).sum();
        let variance = squares / (2.0 * (m as f64).powi(2) * terms as f64);
        out.push(Point { tau_s: m as f64 * tau0_s, variance, windows: count as f64 / m as f64 });
        m *= 2;
    }
    out
}

/// min Σ (Ax − b)² over x ≥ 0, every set of positive unknowns tried.
pub fn nonnegative(rows: &[Vec<f64>], right: &[f64]) -> Vec<f64> {
    let unknowns = rows.first().map_or(0, Vec::len);
    let mut best = (vec![0.0; unknowns], right.iter().map(|b| b * b).sum::<f64>());
    for set in 1u32..1 << unknowns {
        let active: Vec<usize> = (0..unknowns).filter(|i| set >> i & 1 == 1).collect();
        let scale: Vec<f64> =
            active.iter().map(|i| rows.iter().map(|r| r[*i] * r[*i]).sum::<f64>().sqrt()).collect();
        if scale.iter().any(|s| *s <= 0.0) || rows.len() < active.len() {
            continue;
        }
        let matrix = DMatrix::from_fn(rows.len(), active.len(), |i, j| rows[i][active[j]] / scale[j]);
        let b = DVector::from_column_slice(right);
        let Ok(solution) = matrix.clone().svd(true, true).solve(&b, 1e-12) else { continue };
        if solution.iter().any(|x| *x < 0.0) {
            continue;
        }
        let rest = (&matrix * &solution - &b).norm_squared();
        if rest < best.1 {
            let mut x = vec![0.0; unknowns];
            for (j, i) in active.iter().enumerate() {
                x[*i] = solution[j] / scale[j];
            }
            best = (x, rest);
        }
    }
    best.0
}
