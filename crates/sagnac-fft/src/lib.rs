//! Fourier transforms in double precision.
//!
//! The transforms of `rustfft` are generic and as large as a fifth of the analysis. A package that names their planner compiles
//! them anew with every change; behind these functions they are compiled once.

pub use realfft::num_complex::Complex;
pub use realfft::{ComplexToReal, RealToComplex};
pub use rustfft::Fft;

use std::sync::Arc;

/// Transform of `length` real numbers into `length / 2 + 1` complex ones, not normalised.
#[must_use]
pub fn real_forward(length: usize) -> Arc<dyn RealToComplex<f64>> {
    realfft::RealFftPlanner::new().plan_fft_forward(length)
}

/// Transform of `length / 2 + 1` complex numbers into `length` real ones, not normalised: after [`real_forward`], the
/// values times `length`.
#[must_use]
pub fn real_inverse(length: usize) -> Arc<dyn ComplexToReal<f64>> {
    realfft::RealFftPlanner::new().plan_fft_inverse(length)
}

/// Transform of `length` complex numbers, not normalised.
#[must_use]
pub fn complex_forward(length: usize) -> Arc<dyn Fft<f64>> {
    rustfft::FftPlanner::new().plan_fft_forward(length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cosine_has_one_mode_and_comes_back() {
        let n = 30;
        let cosine = |i: usize| (2.0 * std::f64::consts::PI * 3.0 * i as f64 / n as f64).cos();
        let mut values: Vec<f64> = (0..n).map(cosine).collect();
        let forward = real_forward(n);
        let mut modes = forward.make_output_vec();
        forward.process(&mut values, &mut modes).unwrap();
        for (k, mode) in modes.iter().enumerate() {
            let expected = if k == 3 { 15.0 } else { 0.0 };
            assert!((mode - Complex::new(expected, 0.0)).norm() < 1e-12, "mode {k}: {mode}");
        }
        real_inverse(n).process(&mut modes, &mut values).unwrap();
        assert!((0..n).all(|i| (values[i] - 30.0 * cosine(i)).abs() < 1e-12));
    }

    #[test]
    fn a_turning_number_has_one_mode() {
        let n = 7;
        let turn =
            |i: usize| Complex::from_polar(1.0, 2.0 * std::f64::consts::PI * 2.0 * i as f64 / n as f64);
        let mut values: Vec<Complex<f64>> = (0..n).map(turn).collect();
        complex_forward(n).process(&mut values);
        for (k, mode) in values.iter().enumerate() {
            let expected = if k == 2 { 7.0 } else { 0.0 };
            assert!((mode - Complex::new(expected, 0.0)).norm() < 1e-12, "mode {k}: {mode}");
        }
    }
}
