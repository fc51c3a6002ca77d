//! The logarithm of a determinant from the factor of the matrix.

use nalgebra::{Cholesky, Dyn};

/// ln det V of V = LLᵀ.
pub fn log_determinant(factor: &Cholesky<f64, Dyn>) -> f64 {
    2.0 * factor.l_dirty().diagonal().iter().map(|d| d.ln()).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    #[test]
    fn it_is_that_of_the_determinant() {
        let v = DMatrix::from_row_slice(2, 2, &[4.0, 1.0, 1.0, 3.0]);
        let factor = Cholesky::new(v).unwrap();
        assert!((log_determinant(&factor) - 11f64.ln()).abs() < 1e-12);
    }
}
