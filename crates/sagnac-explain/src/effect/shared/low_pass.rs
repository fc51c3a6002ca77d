//! Low-pass filters that act on samples, by recursion.

use std::f64::consts::{PI, SQRT_2, TAU};

/// Highest cutoff, cycles a sample: beyond it a filter of samples passes everything.
const MAX_CUTOFF: f64 = 0.49;

/// Longest memory for which what leaks from the ends of a record is counted, samples.
const MAX_MEMORY_SAMPLES: usize = 1024;

/// A filter y_i = Σ b_k x_{i−k} − Σ a_k y_{i−k}, which passes a constant unchanged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LowPass {
    /// b₀, b₁, b₂.
    pub forward: [f64; 3],
    /// a₁, a₂.
    pub back: [f64; 2],
    /// For a wanted response 1/(1 + (f/f_c)^2p) that the recursion only approximates: f_c in cycles a sample, and p.
    ideal: Option<(f64, i32)>,
    /// Samples within which it forgets what was before.
    pub memory: usize,
}

/// Samples after which a recursion with these a₁, a₂ keeps exp(−12) of what was, by its largest pole.
fn memory([a, b]: [f64; 2]) -> usize {
    let discriminant = 0.25 * a * a - b;
    let pole = if discriminant < 0.0 { b.sqrt() } else { 0.5 * a.abs() + discriminant.sqrt() };
    (12.0 / -pole.clamp(1e-3, 1.0 - 1e-9).ln()).min(1e9).ceil() as usize
}

/// |b₀ + b₁ z⁻¹ + b₂ z⁻²|² at a frequency in cycles a sample.
fn square(c: [f64; 3], x: f64) -> f64 {
    let w = TAU * x;
    let re = c[0] + c[1] * w.cos() + c[2] * (2.0 * w).cos();
    let im = c[1] * w.sin() + c[2] * (2.0 * w).sin();
    re * re + im * im
}

impl LowPass {
    fn of(forward: [f64; 3], back: [f64; 2], ideal: Option<(f64, i32)>) -> LowPass {
        LowPass { forward, back, ideal, memory: memory(back) }
    }

    /// Exponential smoothing with half the power at a cutoff, cycles a sample.
    pub fn smoothing(cutoff: f64) -> LowPass {
        let x = cutoff.min(MAX_CUTOFF);
        let c = 2.0 - (TAU * x).cos();
        let a = c - (c * c - 1.0).sqrt();
        LowPass::of([1.0 - a, 0.0, 0.0], [-a, 0.0], None)
    }

    /// First-order filter by the bilinear transform, cutoff in cycles a sample.
    pub fn bilinear(cutoff: f64) -> LowPass {
        let x = cutoff.min(MAX_CUTOFF);
        let c = (PI * x).tan();
        let b = c / (1.0 + c);
        LowPass::of([b, b, 0.0], [(c - 1.0) / (c + 1.0), 0.0], None)
    }

    /// Second-order Butterworth filter by the bilinear transform, cutoff in cycles a sample.
    pub fn butterworth(cutoff: f64) -> LowPass {
        let x = cutoff.min(MAX_CUTOFF);
        let c = (PI * x).tan();
        let norm = 1.0 + SQRT_2 * c + c * c;
        let b = c * c / norm;
        let back = [2.0 * (c * c - 1.0) / norm, (1.0 - SQRT_2 * c + c * c) / norm];
        LowPass::of([b, 2.0 * b, b], back, None)
    }

    /// Half the power at a cutoff (cycles a sample) and 1/(1 + (f/f_c)^2p) at every frequency, p of 1 or 2.
    pub fn ideal(cutoff: f64, order: i32) -> LowPass {
        // Poles where those of the continuous filter lie.
        let w = TAU * cutoff;
        let (back, gain) = if order < 2 {
            let r = (-w).exp();
            ([-r, 0.0], 1.0 - r)
        } else {
            let (r, turn) = ((-w / SQRT_2).exp(), w / SQRT_2);
            let a = [-2.0 * r * turn.cos(), r * r];
            (a, 1.0 + a[0] + a[1])
        };
        LowPass::of([gain, 0.0, 0.0], back, Some((cutoff, order.clamp(1, 2))))
    }

    /// Power that the recursion lets through at a frequency, cycles a sample.
    fn recursion(&self, x: f64) -> f64 {
        square(self.forward, x) / square([1.0, self.back[0], self.back[1]], x).max(1e-300)
    }

    /// Power that the filter lets through at a frequency, cycles a sample.
    pub fn power(&self, x: f64) -> f64 {
        match self.ideal {
            Some((cutoff, order)) => 1.0 / (1.0 + (x / cutoff).powi(2 * order)),
            None => self.recursion(x),
        }
    }

    /// Autocovariance of unit white noise behind the recursion at lags of 0, 1, 2, ... samples; nothing where its memory is
    /// longer than [`MAX_MEMORY_SAMPLES`] or another response is wanted.
    fn autocovariance(&self) -> Vec<f64> {
        if self.counted_memory() == 0 {
            return vec![];
        }
        let (mut y, mut response) = ([0.0; 2], Vec::with_capacity(self.memory + 3));
        for i in 0..self.memory + 3 {
            let out = self.forward.get(i).copied().unwrap_or(0.0) - self.back[0] * y[0] - self.back[1] * y[1];
            y = [out, y[0]];
            response.push(out);
        }
        (0..response.len())
            .map(|lag| response.iter().zip(&response[lag..]).map(|(a, b)| a * b).sum())
            .collect()
    }

    /// Samples within which it forgets, 0 where what leaks from ends is not counted.
    pub fn counted_memory(&self) -> usize {
        if self.ideal.is_some() || self.memory > MAX_MEMORY_SAMPLES { 0 } else { self.memory }
    }

    /// Mean power of cosine modes (DCT-II) of `samples` of filtered white noise at frequencies in cycles a sample. The ends
    /// of a record leak into the modes that a steep filter leaves next to nothing:
    /// E X_k² = Σ r(h) [(1 − |h|/n) cos ωh − sin ω|h|/(n sin ω)].
    pub fn mode_powers(&self, frequencies: impl Iterator<Item = f64>, samples: usize) -> Vec<f64> {
        let covariance = self.autocovariance();
        let leaked = |x: f64| {
            let w = TAU * x;
            let (step_cos, step_sin) = (w.cos(), w.sin());
            let (mut cos, mut sin, mut sum) = (1.0, 0.0, 0.0);
            for (h, r) in covariance.iter().enumerate().skip(1) {
                (cos, sin) = (cos * step_cos - sin * step_sin, sin * step_cos + cos * step_sin);
                sum += r * (h as f64 * cos + sin / step_sin.max(1e-12));
            }
            -2.0 * sum / samples.max(1) as f64
        };
        frequencies.map(|x| self.power(x) + if covariance.is_empty() { 0.0 } else { leaked(x) }).collect()
    }

    /// Wanted power over that of the recursion, where they differ.
    pub fn correction(&self, x: f64) -> Option<f64> {
        self.ideal.map(|_| self.power(x) / self.recursion(x).max(1e-300))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn filters_pass_constants_and_half_the_power_at_their_cutoffs() {
        for x in [0.001, 0.05, 0.2, 0.4] {
            for filter in [
                LowPass::smoothing(x),
                LowPass::bilinear(x),
                LowPass::butterworth(x),
                LowPass::ideal(x, 1),
                LowPass::ideal(x, 2),
            ] {
                assert!((filter.power(0.0) - 1.0).abs() < 1e-9, "{filter:?}");
                assert!((filter.recursion(0.0) - 1.0).abs() < 1e-9, "{filter:?}");
                assert!((filter.power(x) - 0.5).abs() < 1e-9, "{filter:?}: {}", filter.power(x));
            }
        }
    }

    #[test]
    fn modes_of_a_short_record_have_the_power_of_the_exact_covariance() {
        let (n, filter) = (96usize, LowPass::butterworth(0.08));
        let covariance = filter.autocovariance();
        let r = |lag: usize| covariance.get(lag).copied().unwrap_or(0.0);
        for k in [1usize, 20, 60, 94] {
            let mode =
                |i: usize| (2.0 / n as f64).sqrt() * (PI * k as f64 * (i as f64 + 0.5) / n as f64).cos();
            let mut exact = 0.0;
            for i in 0..n {
                for j in 0..n {
                    exact += mode(i) * mode(j) * r(i.abs_diff(j));
                }
            }
            let got = filter.mode_powers(std::iter::once(k as f64 / (2.0 * n as f64)), n)[0];
            assert!((got / exact - 1.0).abs() < 1e-3, "mode {k}: {got} {exact}");
            assert!(
                k < 90 || exact > 3.0 * filter.power(k as f64 / (2.0 * n as f64)),
                "nothing leaks at {k}"
            );
        }
    }

    #[test]
    fn recursions_have_their_response() {
        // The response to a sinusoid, once what was before is forgotten.
        let filter = LowPass::butterworth(0.08);
        for x in [0.03, 0.11, 0.3] {
            let (mut y, mut u) = ([0.0; 2], [0.0; 2]);
            let (mut sum, mut count) = (0.0, 0.0);
            for i in 0..6000 {
                let input = (TAU * x * f64::from(i)).sin();
                let output = filter.forward[0] * input + filter.forward[1] * u[0] + filter.forward[2] * u[1]
                    - filter.back[0] * y[0]
                    - filter.back[1] * y[1];
                (u, y) = ([input, u[0]], [output, y[0]]);
                if i >= 1000 {
                    (sum, count) = (sum + output * output, count + 1.0);
                }
            }
            assert!((2.0 * sum / count / filter.power(x) - 1.0).abs() < 2e-3, "{x}");
        }
    }

    #[test]
    fn the_memory_is_that_of_the_largest_pole() {
        // exp(−0.7): 12/0.7 = 17.1 samples; alone, beside a smaller one, and as the size of a pair.
        let (p, q) = ((-0.7f64).exp(), 0.2);
        assert_eq!(memory([-p, 0.0]), 18);
        assert_eq!(memory([-(p + q), p * q]), 18);
        assert_eq!(memory([-2.0 * p * 0.5f64.cos(), p * p]), 18);
        assert_eq!(memory([0.0, 0.0]), 2);
        // A pole at 1 never forgets.
        assert_eq!(memory([-1.0, 0.0]), 1_000_000_000);
    }

    #[test]
    fn ideal_filters_have_the_poles_of_the_continuous_ones_and_what_corrects_them() {
        let cutoff = 0.05;
        let w = TAU * cutoff;
        let first = LowPass::ideal(cutoff, 1);
        assert!((first.back[0] + (-w).exp()).abs() < 1e-15 && first.back[1] == 0.0);
        let second = LowPass::ideal(cutoff, 2);
        let (r, turn) = ((-w / SQRT_2).exp(), w / SQRT_2);
        assert!(
            (second.back[0] + 2.0 * r * turn.cos()).abs() < 1e-15 && (second.back[1] - r * r).abs() < 1e-15
        );
        assert!((second.forward[0] - (1.0 - 2.0 * r * turn.cos() + r * r)).abs() < 1e-15);
        // At half of the cutoff 1/(1 + 1/16) is wanted of the second order, 1/(1 + 1/4) of the first.
        for (filter, wanted) in [(first, 0.8), (second, 16.0 / 17.0)] {
            assert!((filter.power(0.5 * cutoff) - wanted).abs() < 1e-12);
            let correction = filter.correction(0.5 * cutoff).unwrap();
            assert!((filter.recursion(0.5 * cutoff) * correction - wanted).abs() < 1e-12);
            assert_eq!(filter.counted_memory(), 0);
        }
        assert!((second.correction(0.0).unwrap() - 1.0).abs() < 1e-9);
        assert!(LowPass::bilinear(cutoff).correction(0.1).is_none());
    }

    #[test]
    fn the_covariance_of_smoothed_noise_falls_by_its_pole() {
        let filter = LowPass::smoothing(0.1);
        let pole = -filter.back[0];
        let covariance = filter.autocovariance();
        // (1 − a)/(1 + a) aʰ.
        for (h, r) in covariance.iter().enumerate().take(8) {
            assert!((r - (1.0 - pole) / (1.0 + pole) * pole.powi(h as i32)).abs() < 1e-9, "{h}: {r}");
        }
        assert!(LowPass::smoothing(1e-4).autocovariance().is_empty());
        assert_eq!(LowPass::smoothing(0.1).counted_memory(), filter.memory);
    }
}
