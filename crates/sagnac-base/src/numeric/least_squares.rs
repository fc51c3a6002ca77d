//! Weighted linear least squares of columns with Gaussian priors, by the normal equations.

use crate::numeric::parallel;
use nalgebra::{DMatrix, DVector};

/// Normal equations of columns z with prior deviations σ against data x of variances p:
/// (Σ z z'/p + diag σ⁻²) c = Σ z x/p.
pub struct Normal {
    matrix: DMatrix<f64>,
    right: DVector<f64>,
    total: f64,
}

/// Values that are weighted at a time: they stay in the fastest cache, and a long record needs no memory for them.
const AT_ONCE: usize = 2048;

/// Σ a b/p for each of several columns b.
fn products<'a>(a: &[f64], powers: &[f64], columns: impl Iterator<Item = &'a [f64]>) -> Vec<f64> {
    let columns: Vec<&[f64]> = columns.collect();
    let mut sums = vec![0.0; columns.len()];
    let mut weighted = [0.0; AT_ONCE];
    for (part, (a, powers)) in a.chunks(AT_ONCE).zip(powers.chunks(AT_ONCE)).enumerate() {
        let count = a.len().min(powers.len());
        for (w, (x, p)) in weighted.iter_mut().zip(a.iter().zip(powers)) {
            *w = x / p;
        }
        for (sum, column) in sums.iter_mut().zip(&columns) {
            *sum += inner(&weighted[..count], column.get(part * AT_ONCE..).unwrap_or_default());
        }
    }
    sums
}

/// Σ a b. In eight sums, none of which waits for the other.
fn inner(a: &[f64], b: &[f64]) -> f64 {
    let n = a.len().min(b.len());
    let ((a, a_left), (b, b_left)) = (a[..n].as_chunks::<8>(), b[..n].as_chunks::<8>());
    let mut sums = [0.0; 8];
    for (a, b) in a.iter().zip(b) {
        for (sum, (x, y)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += x * y;
        }
    }
    sums.iter().sum::<f64>() + a_left.iter().zip(b_left).map(|(x, y)| x * y).sum::<f64>()
}

impl Normal {
    /// The equations for `columns` with prior deviations (infinite for none).
    pub fn new(columns: &[(&[f64], f64)], data: &[f64], powers: &[f64]) -> Normal {
        let p = columns.len();
        let mut matrix = DMatrix::zeros(p, p);
        let mut right = DVector::zeros(p);
        for (i, (a, deviation)) in columns.iter().enumerate() {
            let others = columns.iter().take(i + 1).map(|(b, _)| *b).chain([data]);
            let values = products(a, powers, others);
            for (j, value) in values.iter().enumerate().take(i + 1) {
                matrix[(i, j)] = *value;
                matrix[(j, i)] = *value;
            }
            matrix[(i, i)] += deviation.powi(-2);
            right[i] = values[i + 1];
        }
        Normal { matrix, right, total: products(data, powers, [data].into_iter())[0] }
    }

    /// The equations with more columns, against the same data less a fixed part.
    pub fn with(
        &self,
        old: &[(&[f64], f64)],
        new: &[&[f64]],
        data: &[f64],
        fixed: bool,
        powers: &[f64],
    ) -> Normal {
        let (p, q) = (old.len(), new.len());
        let mut matrix = DMatrix::zeros(p + q, p + q);
        matrix.view_mut((0, 0), (p, p)).copy_from(&self.matrix);
        let mut right = DVector::zeros(p + q);
        // Against the old columns, and against itself.
        let other = fixed.then(|| products(data, powers, old.iter().map(|(a, _)| *a).chain([data])));
        for i in 0..p {
            right[i] = other.as_ref().map_or(self.right[i], |other| other[i]);
        }
        let known = |j: usize| if j < p { old[j].0 } else { new[j - p] };
        let rows: Vec<Vec<f64>> = parallel::map(q, |i| {
            let against = (0..=p + i).map(known);
            products(new[i], powers, against.chain([data]))
        });
        for (i, row) in rows.into_iter().enumerate() {
            for (j, value) in row[..=p + i].iter().enumerate() {
                matrix[(p + i, j)] = *value;
                matrix[(j, p + i)] = *value;
            }
            right[p + i] = row[p + i + 1];
        }
        let total = other.map_or(self.total, |other| other[p]);
        Normal { matrix, right, total }
    }

    /// Coefficients, covariance, and the penalised sum of squares that is left. Columns that others hold already get
    /// no coefficient.
    pub fn solve(&self) -> (Vec<f64>, DMatrix<f64>, f64) {
        let p = self.right.len();
        if p == 0 {
            return (vec![], DMatrix::zeros(0, 0), self.total);
        }
        // Scaled to a unit diagonal; a ridge far below any information keeps collinear columns finite.
        let scale: Vec<f64> = (0..p).map(|i| self.matrix[(i, i)].max(1e-300).sqrt()).collect();
        let mut scaled = self.matrix.clone();
        for i in 0..p {
            for j in 0..p {
                scaled[(i, j)] /= scale[i] * scale[j];
            }
            scaled[(i, i)] += 1e-9;
        }
        let Some(factor) = scaled.cholesky() else {
            return (vec![0.0; p], DMatrix::zeros(p, p), self.total);
        };
        let right = DVector::from_fn(p, |i, _| self.right[i] / scale[i]);
        let solution = factor.solve(&right);
        let left = self.total - right.dot(&solution);
        let mut covariance = factor.inverse();
        for i in 0..p {
            for j in 0..p {
                covariance[(i, j)] /= scale[i] * scale[j];
            }
        }
        ((0..p).map(|i| solution[i] / scale[i]).collect(), covariance, left)
    }
}

/// Takes a column times a coefficient out of data.
pub fn subtract(data: &mut [f64], column: &[f64], coefficient: f64) {
    if coefficient != 0.0 {
        data.iter_mut().zip(column).for_each(|(d, c)| *d -= coefficient * c);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ONES: [f64; 4] = [1.0; 4];
    const LINE: [f64; 4] = [0.0, 1.0, 2.0, 3.0];

    #[test]
    fn a_line_through_points_is_solved_with_its_covariance() {
        // 2 + 3x at x = 0..3, variance ½: Σ1 = 4, Σx = 6, Σx² = 14, determinant 20.
        let data = [2.0, 5.0, 8.0, 11.0];
        let columns: [(&[f64], f64); 2] = [(&ONES, f64::INFINITY), (&LINE, f64::INFINITY)];
        let (c, covariance, left) = Normal::new(&columns, &data, &[0.5; 4]).solve();
        assert!((c[0] - 2.0).abs() < 1e-6 && (c[1] - 3.0).abs() < 1e-6, "{c:?}");
        for (at, expected) in
            [((0, 0), 0.5 * 14.0 / 20.0), ((1, 1), 0.5 * 4.0 / 20.0), ((0, 1), -0.5 * 6.0 / 20.0)]
        {
            assert!((covariance[at] - expected).abs() < 1e-6, "{at:?}: {}", covariance[at]);
        }
        assert!(left.abs() < 1e-4, "{left}");
    }

    #[test]
    fn a_prior_draws_a_coefficient_towards_zero() {
        // Four values of 3 with variance 1 and a prior of deviation ½: 12/(4 + 4).
        let (c, covariance, left) = Normal::new(&[(&ONES, 0.5)], &[3.0; 4], &ONES).solve();
        assert!((c[0] - 1.5).abs() < 1e-8 && (covariance[(0, 0)] - 0.125).abs() < 1e-8);
        // 4 (3 − 1.5)² + (1.5/½)².
        assert!((left - 18.0).abs() < 1e-6, "{left}");
    }

    #[test]
    fn columns_added_later_solve_as_if_they_had_been_there() {
        let data = [1.0, -2.0, 4.0, 0.5];
        let powers = [0.5, 1.0, 2.0, 4.0];
        let columns: [(&[f64], f64); 2] = [(&ONES, 2.0), (&LINE, f64::INFINITY)];
        let at_once = Normal::new(&columns, &data, &powers).solve();
        let later = Normal::new(&columns[..1], &data, &powers);
        let later = later.with(&columns[..1], &[&LINE], &data, false, &powers).solve();
        assert!(at_once.0.iter().zip(&later.0).all(|(a, b)| (a - b).abs() < 1e-12));
        assert!((at_once.2 - later.2).abs() < 1e-12);
        // The same column twice: the fit is the same, whichever of the two has the coefficient.
        let twice: [(&[f64], f64); 2] = [(&ONES, f64::INFINITY), (&ONES, f64::INFINITY)];
        let (c, _, _) = Normal::new(&twice, &[3.0; 4], &ONES).solve();
        assert!((c[0] + c[1] - 3.0).abs() < 1e-6, "{c:?}");
        assert_eq!(Normal::new(&[], &data, &ONES).solve().2, 21.25);
    }

    #[test]
    fn nothing_is_taken_out_for_no_coefficient() {
        let mut data = vec![1.0, 2.0];
        subtract(&mut data, &[f64::INFINITY, 1.0], 0.0);
        subtract(&mut data, &[1.0, 0.5], 2.0);
        assert_eq!(data, [-1.0, 1.0]);
    }

    #[test]
    fn several_columns_added_against_other_data_solve_as_if_at_once() {
        let square: [f64; 4] = [0.0, 1.0, 4.0, 9.0];
        let (data, powers) = ([1.0, -2.0, 4.0, 0.5], [0.5, 1.0, 2.0, 4.0]);
        let left = [0.3, 1.0, -2.0, 2.5];
        let first: [(&[f64], f64); 1] = [(&ONES, 2.0)];
        let all: [(&[f64], f64); 3] = [(&ONES, 2.0), (&LINE, f64::INFINITY), (&square, f64::INFINITY)];
        let begun = Normal::new(&first, &data, &powers);
        for (fixed, data) in [(false, &data), (true, &left)] {
            let later = begun.with(&first, &[&LINE, &square], data, fixed, &powers).solve();
            let at_once = Normal::new(&all, data, &powers).solve();
            assert!(later.0.iter().zip(&at_once.0).all(|(a, b)| (a - b).abs() < 1e-9), "{fixed}: {later:?}");
            assert!((later.1 - at_once.1).amax() < 1e-9 && (later.2 - at_once.2).abs() < 1e-9, "{fixed}");
        }
    }

    #[test]
    fn sums_end_with_the_shortest_of_the_series() {
        let sums = products(&[1.0, 3.0], &[4.0, 2.0, 1.0], [&[2.0, 4.0, 9.0][..], &[2.0]].into_iter());
        assert_eq!(sums, [6.5, 0.5]);
        let long = vec![1.0; AT_ONCE + 5];
        let rising: Vec<f64> = (0..AT_ONCE + 5).map(|i| i as f64).collect();
        let n = (AT_ONCE + 5) as f64;
        assert_eq!(products(&rising, &[0.5; AT_ONCE + 5], [&long[..]].into_iter()), [n * (n - 1.0)]);
        // Ten terms over the eight sums.
        assert_eq!(inner(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0], &[2.0; 10]), 110.0);
    }
}
