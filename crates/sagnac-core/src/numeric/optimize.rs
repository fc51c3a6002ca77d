//! Minimisation and root finding: searches along one variable (bisection, golden sections, the peak of a parabola through
//! three points), step halving, and quadratic functions with bounded variables, of which Newton steps are made.

use nalgebra::{DMatrix, DVector};

/// Bisection: halves the span between `inside`, where `holds` is true, and `outside`, where it is false, `times` times or
/// until no number lies between. Gives the ends of the span that is left, in the same order.
pub fn bisect(mut inside: f64, mut outside: f64, times: usize, holds: impl Fn(f64) -> bool) -> (f64, f64) {
    for _ in 0..times {
        let middle = 0.5 * (inside + outside);
        if middle == inside || middle == outside {
            break;
        }
        if holds(middle) { inside = middle } else { outside = middle }
    }
    (inside, outside)
}

/// The argument of the minimum of a function with a single minimum between `low` and `high`, by `times` golden sections
/// (Kiefer 1953): each leaves 0.618 of the span.
pub fn golden_section(mut low: f64, mut high: f64, times: usize, of: impl Fn(f64) -> f64) -> f64 {
    const RATIO: f64 = 0.618_033_988_749_895;
    for _ in 0..times {
        let (a, b) = (high - RATIO * (high - low), low + RATIO * (high - low));
        if of(a) < of(b) { high = b } else { low = a }
    }
    0.5 * (low + high)
}

/// Position of the peak of the parabola through `values[at]` and its two neighbours, in grid steps from `at`, between −0.5
/// and 0.5. 0 where a neighbour is missing or the three points do not bend downwards.
pub fn parabolic_peak(values: &[f64], at: usize) -> f64 {
    let (Some(here), Some(after)) = (values.get(at), values.get(at + 1)) else { return 0.0 };
    let Some(before) = at.checked_sub(1).and_then(|i| values.get(i)) else { return 0.0 };
    let curve = before + after - 2.0 * here;
    if curve < 0.0 { (0.5 * (before - after) / curve).clamp(-0.5, 0.5) } else { 0.0 }
}

/// Tries steps of length 1, ½, ¼, … at most `times` times and gives what the first acceptable one gave.
pub fn halved_steps<T>(times: usize, mut acceptable: impl FnMut(f64) -> Option<T>) -> Option<T> {
    let mut step = 1.0;
    for _ in 0..times {
        if let Some(accepted) = acceptable(step) {
            return Some(accepted);
        }
        step *= 0.5;
    }
    None
}

/// The x ≥ 0 that minimises ½xᵀHx − bᵀx, with x = 0 where not `free`: every active set is tried and the best feasible
/// one kept, so that the answer is exact. For a few unknowns only: 2^N sets.
pub fn nonnegative_quadratic<const N: usize>(h: &[[f64; N]; N], b: &[f64; N], free: &[bool; N]) -> [f64; N] {
    let mut best = ([0.0; N], 0.0);
    for set in 1u32..(1 << N) {
        let indices: Vec<usize> = (0..N).filter(|i| set >> i & 1 == 1).collect();
        if indices.iter().any(|&i| !free[i] || h[i][i] <= 0.0) {
            continue;
        }
        let scale: Vec<f64> = indices.iter().map(|&i| h[i][i].sqrt()).collect();
        let n = indices.len();
        let matrix = DMatrix::from_fn(n, n, |i, j| h[indices[i]][indices[j]] / (scale[i] * scale[j]));
        let right = DVector::from_fn(n, |i, _| b[indices[i]] / scale[i]);
        let Some(solution) = matrix.cholesky().map(|c| c.solve(&right)) else { continue };
        if solution.iter().any(|x| *x < 0.0 || !x.is_finite()) {
            continue;
        }
        let value = -0.5 * solution.dot(&right);
        if value < best.1 {
            let mut x = [0.0; N];
            for (i, &index) in indices.iter().enumerate() {
                x[index] = solution[i] / scale[i];
            }
            best = (x, value);
        }
    }
    best.0
}

/// The δ ≥ `lower` that minimises ½δᵀHδ − gᵀδ for a positive semidefinite H: one bounded step of Newton's method. An active
/// set that bounds the entry furthest outside and lets go of one whose gradient points inside. Entries without curvature
/// stay at 0, and all of them where H has no Cholesky factor.
/// Source: Lawson and Hanson, Solving Least Squares Problems (1974), chapter 23.
pub fn bounded_quadratic(h: &DMatrix<f64>, g: &DVector<f64>, lower: &[f64]) -> DVector<f64> {
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
    fn the_span_that_is_left_holds_the_root() {
        let (inside, outside) = bisect(1.0, 2.0, 50, |x| x * x < 2.0);
        assert!(inside * inside < 2.0 && outside * outside >= 2.0 && outside - inside < 1e-14);
        let (inside, outside) = bisect(2.0, 1.0, 200, |x| x * x > 2.0);
        assert!(inside > outside && inside * inside > 2.0, "{inside} {outside}");
    }

    #[test]
    fn the_minimum_of_a_parabola_is_found() {
        assert!((golden_section(-1.0, 4.0, 60, |x| (x - 0.7).powi(2)) - 0.7).abs() < 1e-7);
    }

    #[test]
    fn bounds_hold_and_the_rest_is_solved_without_the_bound_entry() {
        let h = DMatrix::from_row_slice(3, 3, &[2.0, 1.9, 0.0, 1.9, 2.0, 0.0, 0.0, 0.0, 0.0]);
        let g = DVector::from_vec(vec![2.0, 1.0, 5.0]);
        let delta = bounded_quadratic(&h, &g, &[-10.0, -0.5, -1.0]);
        // Unbounded: δ1 = −4.6; held at −0.5, δ0 = (2 + 0.95)/2.
        assert!(
            (delta[1] + 0.5).abs() < 1e-12 && (delta[0] - 1.475).abs() < 1e-6 && delta[2] == 0.0,
            "{delta}"
        );
        let open = bounded_quadratic(&h, &g, &[f64::NEG_INFINITY, f64::NEG_INFINITY, 0.0]);
        assert!((2.0 * open[0] + 1.9 * open[1] - 2.0).abs() < 1e-6);
    }
}
