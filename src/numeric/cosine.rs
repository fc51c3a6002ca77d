//! Orthonormal discrete cosine transform of type II.

use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use std::sync::{Arc, Mutex, PoisonError};

/// Lengths whose plans are kept. All threads share them: the tables of a long record are large.
const KEPT: usize = 16;
static PLANS: Mutex<Vec<Plan>> = Mutex::new(vec![]);

/// What transforms of one length share.
#[derive(Clone)]
struct Plan {
    n: usize,
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
    /// sin and cos of πk/2n for k up to n/2.
    turns: Arc<Vec<(f64, f64)>>,
}

fn plan(n: usize) -> Plan {
    let mut plans = PLANS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(at) = plans.iter().position(|p| p.n == n) {
        let found = plans.remove(at);
        plans.push(found.clone());
        return found;
    }
    let mut planner = RealFftPlanner::<f64>::new();
    let angle = std::f64::consts::PI / (2.0 * n as f64);
    let made = Plan {
        n,
        forward: planner.plan_fft_forward(n),
        inverse: planner.plan_fft_inverse(n),
        turns: Arc::new((0..=n / 2).map(|k| (angle * k as f64).sin_cos()).collect()),
    };
    if plans.len() == KEPT {
        plans.remove(0);
    }
    plans.push(made.clone());
    made
}

/// The orthonormal DCT-II: c_k = √(2/M) Σ_j y_j cos(πk(j+½)/M), c_0 = Σ y / √M.
///
/// One real Fourier transform of the same length (Makhoul 1980). White noise of variance σ² gives coefficients of
/// variance σ² that are independent of one another. Empty in, empty out.
pub fn dct2(values: &[f64]) -> Vec<f64> {
    let n = values.len();
    if n < 2 {
        return values.to_vec();
    }
    let mut ordered: Vec<f64> = values.iter().step_by(2).copied().collect();
    ordered.extend(values.iter().skip(1).step_by(2).rev());
    let plan = plan(n);
    let mut spectrum = plan.forward.make_output_vec();
    if plan.forward.process(&mut ordered, &mut spectrum).is_err() {
        return vec![f64::NAN; n];
    }
    let scale = (2.0 / n as f64).sqrt();
    // The transform leaves nothing of use in its input, whose memory serves again.
    let mut out = ordered;
    for (k, (v, (sin, cos))) in spectrum.iter().zip(plan.turns.iter()).enumerate() {
        // V_k e^{-iπk/2n}: the real part is c_k, minus the imaginary part is c_{n−k}.
        out[k] = scale * (v.re * cos + v.im * sin);
        if k > 0 && n - k > k {
            out[n - k] = scale * (v.re * sin - v.im * cos);
        }
    }
    out[0] *= std::f64::consts::FRAC_1_SQRT_2;
    out
}

/// The inverse of [`dct2`]: values with the given coefficients.
pub fn inverse_dct2(coefficients: &[f64]) -> Vec<f64> {
    let n = coefficients.len();
    if n < 2 {
        return coefficients.to_vec();
    }
    let plan = plan(n);
    let mut spectrum = plan.inverse.make_input_vec();
    let scale = (n as f64 / 2.0).sqrt();
    for (k, (v, (sin, cos))) in spectrum.iter_mut().zip(plan.turns.iter()).enumerate() {
        let (here, mirrored) = (coefficients[k], if k > 0 { coefficients[n - k] } else { 0.0 });
        v.re = scale * (here * cos + mirrored * sin);
        v.im = scale * (here * sin - mirrored * cos);
    }
    spectrum[0].re *= std::f64::consts::SQRT_2;
    spectrum[0].im = 0.0;
    if n.is_multiple_of(2) {
        // Real for a real series; what is left of it is rounding.
        spectrum[n / 2].im = 0.0;
    }
    let mut ordered = plan.inverse.make_output_vec();
    if plan.inverse.process(&mut spectrum, &mut ordered).is_err() {
        return vec![f64::NAN; n];
    }
    drop(spectrum);
    (0..n)
        .map(|j| {
            let at = if j % 2 == 0 { j / 2 } else { n - 1 - j / 2 };
            ordered[at] / n as f64
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_gives_the_values_back() {
        for n in [1usize, 2, 3, 8, 17, 64, 101] {
            let y: Vec<f64> = (0..n).map(|i| ((i * i + 3) as f64).sin()).collect();
            for (a, b) in y.iter().zip(inverse_dct2(&dct2(&y))) {
                assert!((a - b).abs() < 1e-13, "{n}");
            }
        }
    }

    #[test]
    fn agrees_with_the_sum_that_defines_it() {
        for n in [2usize, 3, 8, 9, 31] {
            let y: Vec<f64> = (0..n).map(|j| ((j * j * 7 + 3) % 11) as f64 - 4.5).collect();
            let c = dct2(&y);
            for (k, value) in c.iter().enumerate() {
                let sum: f64 = y
                    .iter()
                    .enumerate()
                    .map(|(j, y)| y * (std::f64::consts::PI * k as f64 * (j as f64 + 0.5) / n as f64).cos())
                    .sum();
                let norm = if k == 0 { 1.0 } else { 2.0 } / n as f64;
                assert!((sum * norm.sqrt() - value).abs() < 1e-11, "n {n} k {k}");
            }
        }
    }
}
