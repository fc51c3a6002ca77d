//! Orthonormal discrete cosine transform of type II.
//!
//! Not by `rustdct`: it differs in the last digit of about half of the coefficients (by 6·10⁻¹⁵ at most, of values of
//! order 1), from which every result follows, and its gain of time is below what a run shows.

use sagnac_fft::{Complex, ComplexToReal, RealToComplex, real_forward, real_inverse};
use std::cell::RefCell;
use std::sync::{Arc, Mutex, PoisonError};

/// Lengths whose plans are kept. All threads share them: the tables of a long record are large.
const MAX_PLANS: usize = 16;
static CACHED_PLANS: Mutex<Vec<Plan>> = Mutex::new(vec![]);

/// What transforms of one length share.
#[derive(Clone)]
struct Plan {
    n: usize,
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
    /// sin and cos of πk/2n for k up to n/2.
    turns: Arc<Vec<(f64, f64)>>,
}

/// Longest series whose working memory each thread keeps, samples: fresh memory costs as much as a tenth of a transform.
const MAX_KEPT_SAMPLES: usize = 1 << 20;

/// Working memory of transforms.
#[derive(Default)]
struct Work {
    spectrum: Vec<Complex<f64>>,
    scratch: Vec<Complex<f64>>,
}

thread_local! {
    static THREAD_WORK: RefCell<Work> = RefCell::default();
}

fn plan(n: usize) -> Plan {
    let mut plans = CACHED_PLANS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(at) = plans.iter().position(|p| p.n == n) {
        let found = plans.remove(at);
        plans.push(found.clone());
        return found;
    }
    let angle = std::f64::consts::PI / (2.0 * n as f64);
    let made = Plan {
        n,
        forward: real_forward(n),
        inverse: real_inverse(n),
        turns: Arc::new((0..=n / 2).map(|k| (angle * k as f64).sin_cos()).collect()),
    };
    if plans.len() == MAX_PLANS {
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
    let mut ordered: Vec<f64> = Vec::with_capacity(n);
    ordered.extend(values.chunks(2).map(|pair| pair[0]));
    ordered.extend(values.chunks_exact(2).rev().map(|pair| pair[1]));
    let plan = plan(n);
    THREAD_WORK.with_borrow_mut(|work| {
        work.spectrum.resize(n / 2 + 1, Complex::ZERO);
        work.scratch.resize(plan.forward.get_scratch_len(), Complex::ZERO);
        let out = transformed(ordered, &plan, work);
        if n > MAX_KEPT_SAMPLES {
            *work = Work::default();
        }
        out
    })
}

/// The modes of a series in the order of the transform.
fn transformed(mut ordered: Vec<f64>, plan: &Plan, work: &mut Work) -> Vec<f64> {
    let n = plan.n;
    let Work { spectrum, scratch } = work;
    if plan.forward.process_with_scratch(&mut ordered, spectrum, scratch).is_err() {
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

/// Modes beside that of a sinusoid whose distance is worked out by itself: a difference of squares would lose it.
const NEAR_MODES: usize = 64;

/// [`dct2`] of cos(β + ω(j+½)) and sin(β + ω(j+½)), j = 0 … n−1, without a transform; 0 < ω < π. With θ_k = πk/n both are
/// sin(ω/2) cos(θ_k/2)/(sin²(ω/2) − sin²(θ_k/2)) times what the phase is at both ends, in the one sense for even k and in
/// the other for odd: the geometric series of Dirichlet's kernel.
pub fn sinusoid_modes(n: usize, omega: f64, phase: f64) -> [Vec<f64>; 2] {
    let mut modes = [vec![0.0; n], vec![0.0; n]];
    if n < 2 {
        return modes.map(|_| (0..n).map(|_| f64::NAN).collect());
    }
    let half = 0.5 * omega;
    let (sin_half, scale) = (half.sin(), (2.0 / n as f64).sqrt());
    let square = sin_half * sin_half;
    let (sin_from, cos_from) = phase.sin_cos();
    let (sin_to, cos_to) = (phase + omega * n as f64).sin_cos();
    let ends = |sign: f64| {
        [
            0.5 * scale * sin_half * (sign * sin_to - sin_from),
            0.5 * scale * sin_half * (cos_from - sign * cos_to),
        ]
    };
    let ends = [ends(1.0), ends(-1.0)];
    let plan = plan(n);
    let [cosines, sines] = &mut modes;
    let angle = std::f64::consts::PI / (2.0 * n as f64);
    let mut put = |k: usize, s: f64, c: f64| {
        let kernel = c / (square - s * s);
        cosines[k] = ends[k % 2][0] * kernel;
        sines[k] = ends[k % 2][1] * kernel;
    };
    for (k, (s, c)) in plan.turns.iter().enumerate() {
        put(k, *s, *c);
        if k > 0 && n - k > k {
            put(n - k, *c, *s);
        }
    }
    // Σ exp iα(j+½) = exp(iαn/2) sin(αn/2)/sin(α/2), α = ω ± θ.
    let nearest = (half / angle).round() as usize;
    for k in nearest.saturating_sub(NEAR_MODES)..(nearest + NEAR_MODES).min(n) {
        let mut sum = (0.0, 0.0);
        for at in [half + angle * k as f64, half - angle * k as f64] {
            let length = if at.abs() < 1e-14 { n as f64 } else { (at * n as f64).sin() / at.sin() };
            let (s, c) = (phase + at * n as f64).sin_cos();
            sum = (sum.0 + 0.5 * length * c, sum.1 + 0.5 * length * s);
        }
        (cosines[k], sines[k]) = (scale * sum.0, scale * sum.1);
    }
    for column in &mut modes {
        column[0] *= std::f64::consts::FRAC_1_SQRT_2;
    }
    modes
}

/// The largest length up to `n` without a prime factor above 11, at which transforms are several times faster, or else above
/// 31. It leaves out a few samples at the end, a five-hundredth at most; `n` itself where that is not enough.
pub fn fast_length(n: usize) -> usize {
    const SMALL_PRIMES: [usize; 11] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31];
    let with = |primes: &[usize]| {
        let fast = |length: &usize| {
            let mut rest: usize = *length;
            for p in primes {
                while rest > 1 && rest.is_multiple_of(*p) {
                    rest /= p;
                }
            }
            rest == 1
        };
        (n - n / 500..=n).rev().find(fast)
    };
    // Up to 11 there are vector instructions for each factor.
    with(&SMALL_PRIMES[..5]).or_else(|| with(&SMALL_PRIMES)).unwrap_or(n)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_lose_little_for_speed() {
        assert_eq!(fast_length(65_536), 65_536);
        // 2 · 3³ · 7 · 11 · 13 has a 13; 54 000 is 2⁴ · 3³ · 5³.
        assert_eq!(fast_length(54_103), 54_000);
        // 2² · 3 · 13 · 17: none up to 11 is near.
        assert_eq!(fast_length(2653), 2652);
        assert_eq!(fast_length(101), 101);
    }

    #[test]
    fn modes_of_a_sinusoid_are_those_of_its_transform() {
        for n in [2usize, 3, 64, 257, 10_000] {
            let resonant = std::f64::consts::PI * (n / 3) as f64 / n as f64;
            for omega in [1e-4, 0.3, resonant, resonant + 1e-9, 1.7, 3.1].into_iter().filter(|w| *w > 0.0) {
                let phase = 0.7;
                let at = |j: usize| phase + omega * (j as f64 + 0.5);
                let got = sinusoid_modes(n, omega, phase);
                let wanted = [
                    dct2(&(0..n).map(|j| at(j).cos()).collect::<Vec<_>>()),
                    dct2(&(0..n).map(|j| at(j).sin()).collect::<Vec<_>>()),
                ];
                for (got, wanted) in got.iter().zip(&wanted) {
                    // Not by the largest difference, which would pass over a NaN.
                    let off = got.iter().zip(wanted).find(|(a, b)| (*a - *b).abs() >= 1e-8 || a.is_nan());
                    assert_eq!(off, None, "{n}, {omega}");
                }
            }
        }
    }

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
