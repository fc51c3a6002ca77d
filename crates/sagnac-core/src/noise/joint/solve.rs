//! One bounded step of Fisher scoring.

use nalgebra::{DMatrix, DVector};

/// min ½δᵀHδ − gᵀδ with δ ≥ lower, by active sets; entries without curvature stay at 0.
pub(super) fn bounded_step(h: &DMatrix<f64>, g: &DVector<f64>, lower: &[f64]) -> DVector<f64> {
    let p = g.len();
    let scale: Vec<f64> = (0..p).map(|i| h[(i, i)].max(0.0).sqrt()).collect();
    let mut bound: Vec<bool> = scale.iter().map(|s| *s <= 0.0 || !s.is_finite()).collect();
    let dead = bound.clone();
    let mut delta = DVector::zeros(p);
    for _ in 0..4 * p + 4 {
        for i in 0..p {
            if bound[i] {
                delta[i] = if dead[i] { 0.0 } else { lower[i] };
            }
        }
        let free: Vec<usize> = (0..p).filter(|i| !bound[*i]).collect();
        if !free.is_empty() {
            let n = free.len();
            let matrix = DMatrix::from_fn(n, n, |a, b| {
                let ridge = if a == b { 1e-9 } else { 0.0 };
                h[(free[a], free[b])] / (scale[free[a]] * scale[free[b]]) + ridge
            });
            let right = DVector::from_fn(n, |a, _| {
                let held: f64 = (0..p).filter(|j| bound[*j]).map(|j| h[(free[a], j)] * delta[j]).sum();
                (g[free[a]] - held) / scale[free[a]]
            });
            let Some(solution) = matrix.cholesky().map(|c| c.solve(&right)) else { return DVector::zeros(p) };
            for (a, &i) in free.iter().enumerate() {
                delta[i] = solution[a] / scale[i];
            }
        }
        let worst = free.iter().copied().filter(|i| delta[*i] < lower[*i]).max_by(|a, b| {
            ((lower[*a] - delta[*a]) * scale[*a]).total_cmp(&((lower[*b] - delta[*b]) * scale[*b]))
        });
        if let Some(i) = worst {
            bound[i] = true;
            continue;
        }
        // A bound entry whose gradient points inside is let go.
        let pull = |i: usize| {
            let slope: f64 = (0..p).map(|j| h[(i, j)] * delta[j]).sum::<f64>() - g[i];
            slope / scale[i]
        };
        let released = (0..p)
            .filter(|i| bound[*i] && !dead[*i])
            .map(|i| (i, pull(i)))
            .filter(|(_, s)| *s < -1e-9)
            .min_by(|a, b| a.1.total_cmp(&b.1));
        match released {
            Some((i, _)) => bound[i] = false,
            None => break,
        }
    }
    delta
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_hold_and_the_rest_is_solved_without_the_bound_entry() {
        let h = DMatrix::from_row_slice(3, 3, &[2.0, 1.9, 0.0, 1.9, 2.0, 0.0, 0.0, 0.0, 0.0]);
        let g = DVector::from_vec(vec![2.0, 1.0, 5.0]);
        let delta = bounded_step(&h, &g, &[-10.0, -0.5, -1.0]);
        // Unbounded: δ1 = −4.6; held at −0.5, δ0 = (2 + 0.95)/2.
        assert!(
            (delta[1] + 0.5).abs() < 1e-12 && (delta[0] - 1.475).abs() < 1e-6 && delta[2] == 0.0,
            "{delta}"
        );
        let open = bounded_step(&h, &g, &[f64::NEG_INFINITY, f64::NEG_INFINITY, 0.0]);
        assert!((2.0 * open[0] + 1.9 * open[1] - 2.0).abs() < 1e-6);
    }
}
