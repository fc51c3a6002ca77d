//! What follows from a Cholesky factor: the inverse and the logarithm of the determinant.

use nalgebra::{Cholesky, DMatrix, Dyn};

/// Size below which a triangle is inverted column by column.
const MAX_DIRECT_SIZE: usize = 24;

/// V⁻¹ = L⁻ᵀL⁻¹.
pub fn inverse(factor: &Cholesky<f64, Dyn>) -> DMatrix<f64> {
    let l = triangle(&factor.l());
    l.transpose() * l
}

/// The inverse of a lower triangle: for blocks A, B below it and C, those of the inverse are A⁻¹, −C⁻¹BA⁻¹ and C⁻¹.
fn triangle(l: &DMatrix<f64>) -> DMatrix<f64> {
    let n = l.nrows();
    let mut out = DMatrix::zeros(n, n);
    if n <= MAX_DIRECT_SIZE {
        for j in 0..n {
            out[(j, j)] = 1.0 / l[(j, j)];
            for i in j + 1..n {
                let sum: f64 = (j..i).map(|k| l[(i, k)] * out[(k, j)]).sum();
                out[(i, j)] = -sum / l[(i, i)];
            }
        }
        return out;
    }
    let (m, rest) = (n / 2, n - n / 2);
    let a = triangle(&l.view((0, 0), (m, m)).into_owned());
    let c = triangle(&l.view((m, m), (rest, rest)).into_owned());
    let below = &c * l.view((m, 0), (rest, m)) * &a;
    out.view_mut((0, 0), (m, m)).copy_from(&a);
    out.view_mut((m, m), (rest, rest)).copy_from(&c);
    out.view_mut((m, 0), (rest, m)).copy_from(&-below);
    out
}

/// ln det V of V = LLᵀ.
pub fn log_determinant(factor: &Cholesky<f64, Dyn>) -> f64 {
    2.0 * factor.l_dirty().diagonal().iter().map(|d| d.ln()).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    #[test]
    fn times_the_matrix_it_is_the_identity() {
        for n in [1, 5, 24, 25, 90, 131] {
            let v = DMatrix::from_fn(n, n, |i, j| (-(i.abs_diff(j) as f64) / 7.0).exp())
                + DMatrix::identity(n, n) * 0.1;
            let found = inverse(&v.clone().cholesky().unwrap());
            let off = (&found * &v - DMatrix::identity(n, n)).amax();
            assert!(off < 1e-10, "{n}: {off}");
            assert!((&found - found.transpose()).amax() < 1e-12);
        }
    }

    #[test]
    fn it_is_that_of_the_determinant() {
        let v = DMatrix::from_row_slice(2, 2, &[4.0, 1.0, 1.0, 3.0]);
        let factor = Cholesky::new(v).unwrap();
        assert!((log_determinant(&factor) - 11f64.ln()).abs() < 1e-12);
    }
}
