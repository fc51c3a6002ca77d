//! Places without a sample, filled with a draw of what the noise may have done there given everything around.
//!
//! A draw, not the expectation: the expectation has less power than the noise and would pass for a quiet stretch. For
//! residual x with covariance C and a simulated z of the same covariance, z + E[x − z | what is present] is such a
//! draw. The expectation minimises the quadratic form of C⁻¹ over the missing places, by conjugate gradients in the
//! cosine domain.

use crate::numeric::cosine::{dct2, inverse_dct2};
use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use sagnac_fft::real_forward;

/// Steps of the conjugate gradients.
const MAX_STEPS: usize = 40;
/// Missing values up to which the equations are solved at once.
const MAX_EXACT: usize = 600;

/// Fills `values` where `present` is false by a draw that is fixed by `seed`. `powers` are the variances of the cosine
/// modes; that of mode 0 may be infinite.
pub fn fill(values: &mut [f64], present: &[bool], powers: &[f64], seed: u64) {
    if present.iter().all(|p| *p) || values.len() < 2 {
        return;
    }
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let drawn: Vec<f64> = powers
        .iter()
        .map(|p| {
            let z: f64 = StandardNormal.sample(&mut rng);
            if p.is_finite() { z * p.sqrt() } else { 0.0 }
        })
        .collect();
    let drawn = inverse_dct2(&drawn);
    let mut difference: Vec<f64> = values.iter().zip(&drawn).map(|(x, z)| x - z).collect();
    expect(&mut difference, present, powers);
    for i in 0..values.len() {
        if !present[i] {
            values[i] = drawn[i] + difference[i];
        }
    }
}

/// Replaces the missing values by their expectation given the rest; begins from what stands there.
pub fn expect(values: &mut [f64], present: &[bool], powers: &[f64]) {
    let missing: Vec<usize> = (0..values.len()).filter(|i| !present[*i]).collect();
    let inverse: Vec<f64> = powers.iter().map(|p| 1.0 / p).collect();
    if missing.len() <= MAX_EXACT && solved(values, &missing, &inverse).is_some() {
        return;
    }
    let apply = |full: &[f64]| -> Vec<f64> {
        let modes: Vec<f64> = dct2(full).iter().zip(&inverse).map(|(x, w)| x * w).collect();
        let back = inverse_dct2(&modes);
        missing.iter().map(|i| back[*i]).collect()
    };
    let mut residual: Vec<f64> = apply(values).iter().map(|g| -g).collect();
    let mut direction = residual.clone();
    let mut square: f64 = residual.iter().map(|r| r * r).sum();
    let first = square;
    let mut full = vec![0.0; values.len()];
    for _ in 0..MAX_STEPS {
        if square <= 1e-16 * first || square == 0.0 {
            break;
        }
        missing.iter().zip(&direction).for_each(|(i, d)| full[*i] = *d);
        let image = apply(&full);
        let curvature: f64 = direction.iter().zip(&image).map(|(d, a)| d * a).sum();
        if curvature <= 0.0 {
            break;
        }
        let step = square / curvature;
        missing.iter().zip(&direction).for_each(|(i, d)| values[*i] += step * d);
        residual.iter_mut().zip(&image).for_each(|(r, a)| *r -= step * a);
        let next: f64 = residual.iter().map(|r| r * r).sum();
        direction.iter_mut().zip(&residual).for_each(|(d, r)| *d = r + next / square * *d);
        square = next;
    }
}

/// The same by Cholesky, which steep spectra need; `None` where even that fails. With weights w the inverse covariance
/// of samples i and j is g(i − j) + g(i + j + 1), g(l) = Σ w_k cos(πkl/n)/n with half of w_0.
fn solved(values: &mut [f64], missing: &[usize], inverse: &[f64]) -> Option<()> {
    let n = values.len();
    let mut even: Vec<f64> = inverse.to_vec();
    even.push(0.0);
    even.extend(inverse.iter().skip(1).rev());
    let plan = real_forward(2 * n);
    let mut sums = plan.make_output_vec();
    plan.process(&mut even, &mut sums).ok()?;
    let g = |l: usize| sums.get(l.min(2 * n - l)).map_or(0.0, |s| s.re / (2 * n) as f64);
    let matrix = DMatrix::from_fn(missing.len(), missing.len(), |a, b| {
        let (i, j) = (missing[a], missing[b]);
        g(i.abs_diff(j)) + g(i + j + 1)
    });
    let factor = matrix.cholesky()?;
    missing.iter().for_each(|i| values[*i] = 0.0);
    let modes: Vec<f64> = dct2(values).iter().zip(inverse).map(|(x, w)| x * w).collect();
    let back = inverse_dct2(&modes);
    let right = DVector::from_iterator(missing.len(), missing.iter().map(|i| -back[*i]));
    let found = factor.solve(&right);
    missing.iter().zip(found.iter()).for_each(|(i, v)| values[*i] = *v);
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// AR(1)-like noise: the modes of a Markov process are those of its spectrum closely enough for n ≫ T.
    fn powers(n: usize) -> Vec<f64> {
        (0..n)
            .map(|k| {
                let x = (std::f64::consts::PI * k as f64 / n as f64).cos();
                1.0 / (1.0 + 0.81 - 1.8 * x)
            })
            .collect()
    }

    #[test]
    fn the_expectation_inside_a_markov_gap_is_the_hyperbolic_bridge() {
        let n = 400;
        let mut values = vec![0.0; n];
        let mut present = vec![true; n];
        // A gap of 9 between 1 and 1; elsewhere anything, for the process forgets.
        values[199] = 1.0;
        values[209] = 1.0;
        present[200..209].fill(false);
        expect(&mut values, &present, &powers(n));
        for (i, value) in values.iter().enumerate().take(209).skip(200) {
            let d = (i as f64 - 204.0) * 0.9f64.ln();
            let bridge = d.cosh() / (5.0 * 0.9f64.ln()).cosh();
            assert!((value - bridge).abs() < 1e-6, "{i} {value} {bridge}");
        }
    }

    #[test]
    fn draws_have_the_power_of_the_noise() {
        let n = 256;
        let powers = powers(n);
        let (mut sum, mut count) = (0.0, 0.0);
        let present: Vec<bool> = (0..n).map(|i| i < 64 || i % 64 >= 8).collect();
        for seed in 0..200 {
            // A fill of everything is a draw of the process.
            let mut values = vec![0.0; n];
            fill(&mut values, &vec![false; n], &powers, seed);
            fill(&mut values, &present, &powers, 100_000 + seed);
            sum += values[128..136].iter().map(|v| v * v).sum::<f64>();
            count += 8.0;
        }
        let variance = powers.iter().sum::<f64>() / n as f64;
        // Eight neighbours go together: their mean square scatters by no more than the square of one value, √2.
        let bound = 4.0 * (2.0f64 / 200.0).sqrt();
        assert!((sum / count / variance - 1.0).abs() < bound, "{} {variance}", sum / count);
    }

    #[test]
    fn a_steep_filter_leaks_into_no_mode_once_the_ends_are_drawn() {
        let (n, lead, records) = (4000usize, 400, 20u64);
        let filter = crate::effect::LowPass::butterworth(0.0845);
        let ends = filter.memory.div_ceil(2);
        let mut powers: Vec<f64> = (0..n).map(|k| filter.power(k as f64 / (2.0 * n as f64))).collect();
        powers[0] = f64::INFINITY;
        let mut sums = [0.0; 20];
        for seed in 0..records {
            let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
            let x: Vec<f64> = (0..n + lead).map(|_| StandardNormal.sample(&mut rng)).collect();
            let mut y = vec![0.0; n + lead];
            for i in 2..n + lead {
                let forward: f64 = filter.forward.iter().enumerate().map(|(k, b)| b * x[i - k]).sum();
                y[i] = forward - filter.back[0] * y[i - 1] - filter.back[1] * y[i - 2];
            }
            let mut y = y[lead..].to_vec();
            let present: Vec<bool> = (0..n).map(|i| i >= ends && i + ends < n).collect();
            fill(&mut y, &present, &powers, 77);
            // The highest twentieth lies at 1e-9 of the power and less, where rounding shows.
            for (k, c) in dct2(&y).iter().enumerate().take(n - n / 20).skip(1) {
                sums[k * 20 / n] += c * c / powers[k] * 20.0 / (n as f64 * records as f64);
            }
        }
        for ratio in &sums[..19] {
            assert!(
                (ratio - 1.0).abs() < 4.5 * (2.0 * 20.0 / (n as f64 * records as f64)).sqrt(),
                "{sums:?}"
            );
        }
    }
}
