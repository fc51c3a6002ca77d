//! Noise whose autocovariance is σ² e^(−|t|/T) cos(2πf₀t): a first-order Markov process at f₀ = 0, a quasi-periodic
//! disturbance elsewhere. Exact for averages over the sample interval and for instantaneous samples.
//!
//! With the complex rate c = 1/T − 2πi f₀ every formula of the Markov process holds with its real part taken.
//! Sources: IEEE Std 952 Annex C (Markov); N. F. Zhang, Metrologia 2008 (sampled forms).

use crate::noise::evidence::Turns;
use nalgebra::Complex;
use std::f64::consts::PI;

/// How samples are taken from the continuous rate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sampling {
    /// Each sample is the mean over its interval (counts of angle, averaged rate).
    #[default]
    Averaging,
    /// Each sample is the rate at an instant.
    Instantaneous,
}

/// A damped-cosine process.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Damped {
    /// Standard deviation σ of the continuous process, deg/h.
    pub rms_deg_h: f64,
    /// Centre frequency f₀, Hz; 0 for a Markov process.
    pub frequency_hz: f64,
    /// Decay time T of the autocovariance, s.
    pub decay_time_s: f64,
}

/// Densities of samples of a [`Damped`] process. What no frequency enters is computed once.
#[derive(Debug, Clone, Copy)]
pub struct Densities {
    gamma0: f64,
    first: Complex<f64>,
    rho: Complex<f64>,
    tau_s: f64,
    scale: f64,
}

impl Densities {
    /// Two-sided density at a frequency, aliases included, (deg/h)²/Hz.
    pub fn at(&self, frequency_hz: f64) -> f64 {
        let Densities { gamma0, first, rho, tau_s, scale } = *self;
        let cos = (2.0 * PI * frequency_hz * tau_s).cos();
        // γ_d = Re[first·ρ^(d−1)]; Σ_{d≥1} ρ^(d−1) cos(θd) = (cosθ − ρ)/(1 − 2ρcosθ + ρ²).
        let sum = first * (Complex::new(cos, 0.0) - rho) / (1.0 - 2.0 * cos * rho + rho * rho);
        (scale * (gamma0 + 2.0 * sum.re)).max(0.0)
    }
}

/// Expected powers of the cosine modes of a [`Damped`] process.
#[derive(Debug, Clone, Copy)]
pub struct Modes {
    gamma0: f64,
    first: Complex<f64>,
    rho: Complex<f64>,
    /// ρ^(M − 1).
    last: Complex<f64>,
    blocks: usize,
    scale: f64,
}

impl Modes {
    /// E\[c_k²\]·τ of mode k, (deg/h)²/Hz.
    pub fn power(&self, mode: usize) -> f64 {
        let (sin, cos) = (PI * mode as f64 / self.blocks as f64).sin_cos();
        let half_turns = if mode.is_multiple_of(2) { 1.0 } else { -1.0 };
        if self.is_real() { self.real_power(cos, sin, half_turns) } else { self.at(cos, sin, half_turns) }
    }

    /// The powers of modes by their turns.
    pub(crate) fn powers(&self, turns: Turns<'_>, out: &mut [f64]) {
        let turns = turns.cos.iter().zip(turns.sin).zip(turns.cos_round);
        if self.is_real() {
            out.iter_mut()
                .zip(turns)
                .for_each(|(o, ((cos, sin), half))| *o = self.real_power(*cos, *sin, *half));
        } else {
            out.iter_mut().zip(turns).for_each(|(o, ((cos, sin), half))| *o = self.at(*cos, *sin, *half));
        }
    }

    /// Of a Markov process all but the turn is real.
    fn is_real(&self) -> bool {
        self.rho.im == 0.0 && self.last.im == 0.0 && self.first.im == 0.0
    }

    /// The power at a turn e^(ia) from one mean to the next; `half_turns` is e^(iaM) = (−1)^k. Within the loop over modes several
    /// of them are worked out at a time.
    #[inline(always)]
    fn at(&self, cos: f64, sin: f64, half_turns: f64) -> f64 {
        let m = self.blocks as f64;
        let one = Complex::new(1.0, 0.0);
        // Sums over d = 1 … M − 1 of z^(d−1)·e^(±iad) with weights 1 and d.
        let sums = |turn: Complex<f64>| {
            let z = self.rho * turn;
            // e^(ia(M − 1)) = (−1)^k e^(−ia).
            let last = self.last * turn.conj() * half_turns;
            let inverse = inverted(one - z);
            let plain = turn * (one - last) * inverse;
            let weighted = turn * (one - last * m + last * z * (m - 1.0)) * inverse * inverse;
            (plain, weighted)
        };
        let turn = Complex::new(cos, sin);
        let ((up, up_d), (down, down_d)) = (sums(turn), sums(turn.conj()));
        let cosine = 0.5 * (up + down);
        let cosine_d = 0.5 * (up_d + down_d);
        // (up − down)/2i.
        let difference = 0.5 * (up - down);
        let sine = Complex::new(difference.im, -difference.re);
        let tail = cosine - cosine_d / m - sine / (m * sin);
        (self.scale * (self.gamma0 + 2.0 * (self.first * tail).re)).max(0.0)
    }

    /// The same where [`Modes::is_real`]: the sums of the other direction are the conjugates. Written out in real numbers, so that
    /// several modes are worked out at a time; in the order of [`Modes::at`], so that both give the same to the last bit.
    fn real_power(&self, cos: f64, sin: f64, half_turns: f64) -> f64 {
        let m = self.blocks as f64;
        let (z_re, z_im) = (self.rho.re * cos, self.rho.re * sin);
        let (last_re, last_im) = (self.last.re * cos * half_turns, -(self.last.re * sin * half_turns));
        let left = 1.0 - z_re;
        let square = 1.0 / (left * left + z_im * z_im);
        let (inverse_re, inverse_im) = (left * square, z_im * square);
        let (left_re, left_im) = (1.0 - last_re, -last_im);
        let (turned_re, turned_im) = (cos * left_re - sin * left_im, cos * left_im + sin * left_re);
        let plain_re = turned_re * inverse_re - turned_im * inverse_im;
        let plain_im = turned_re * inverse_im + turned_im * inverse_re;
        let (far_re, far_im) = (last_re * z_re - last_im * z_im, last_re * z_im + last_im * z_re);
        let sum_re = 1.0 - last_re * m + far_re * (m - 1.0);
        let sum_im = -(last_im * m) + far_im * (m - 1.0);
        let (sum_re, sum_im) = (cos * sum_re - sin * sum_im, cos * sum_im + sin * sum_re);
        let (once_re, once_im) =
            (sum_re * inverse_re - sum_im * inverse_im, sum_re * inverse_im + sum_im * inverse_re);
        let weighted_re = once_re * inverse_re - once_im * inverse_im;
        let tail = plain_re - weighted_re / m - plain_im / (m * sin);
        (self.scale * (self.gamma0 + 2.0 * (self.first.re * tail))).max(0.0)
    }
}

/// 1/z, with one division.
#[inline(always)]
fn inverted(z: Complex<f64>) -> Complex<f64> {
    z.conj() * (1.0 / z.norm_sqr())
}

fn expm1_c(z: Complex<f64>) -> Complex<f64> {
    // e^z − 1 without cancellation near 0.
    let (a, b) = (z.re, z.im);
    let half = (0.5 * b).sin();
    Complex::new(a.exp_m1() * b.cos() - 2.0 * half * half, a.exp() * b.sin())
}

/// (z − 1 + e^(−z))/z².
fn ramped(z: Complex<f64>) -> Complex<f64> {
    if z.norm() > 0.5 {
        return (z + expm1_c(-z)) / (z * z);
    }
    // Σ (−z)^k/(k+2)!
    let mut term = Complex::new(0.5, 0.0);
    let mut sum = term;
    for k in 1..20 {
        term = term * -z / f64::from(k + 2);
        sum += term;
    }
    sum
}

impl Damped {
    /// Complex rate c, 1/s.
    pub fn rate(&self) -> Complex<f64> {
        Complex::new(1.0 / self.decay_time_s, -2.0 * PI * self.frequency_hz)
    }

    /// The factors of the autocovariance of samples, for σ = 1: γ₀ and γ_d = Re\[h ρ^d\] for d ≥ 1.
    pub(super) fn covariance(&self, tau_s: f64, sampling: Sampling) -> (f64, Complex<f64>, Complex<f64>) {
        let z = self.rate() * tau_s;
        let rho = (-z).exp();
        match sampling {
            Sampling::Averaging => {
                let lost = -expm1_c(-z);
                // ρ h = (1 − e^(−z))(e^z − 1) ρ/z² = (1 − e^(−z))²/z²: h carries 1/ρ, kept apart to stay finite.
                (2.0 * ramped(z).re, lost * lost / (z * z), rho)
            }
            Sampling::Instantaneous => (1.0, rho, rho),
        }
    }

    /// Two-sided density of samples over `tau_s` at `frequency_hz`, aliases included, (deg/h)²/Hz.
    pub fn density(&self, frequency_hz: f64, tau_s: f64, sampling: Sampling) -> f64 {
        self.densities(tau_s, sampling).at(frequency_hz)
    }

    /// The density at any frequency.
    pub fn densities(&self, tau_s: f64, sampling: Sampling) -> Densities {
        let (gamma0, first, rho) = self.covariance(tau_s, sampling);
        Densities { gamma0, first, rho, tau_s, scale: self.rms_deg_h.powi(2) * tau_s }
    }

    /// E\[c_k²\]·τ of the orthonormal cosine mode k of `blocks` samples over `tau_s`: what the density becomes in a
    /// record that is not long against T.
    pub fn mode_power(&self, mode: usize, blocks: usize, tau_s: f64, sampling: Sampling) -> f64 {
        self.modes(blocks, tau_s, sampling).power(mode)
    }

    /// The powers of all cosine modes of `blocks` samples over `tau_s`.
    pub fn modes(&self, blocks: usize, tau_s: f64, sampling: Sampling) -> Modes {
        let (gamma0, first, rho) = self.covariance(tau_s, sampling);
        let last = rho.powf(blocks as f64 - 1.0);
        let scale = self.rms_deg_h.powi(2) * tau_s;
        Modes { gamma0, first, rho, last, blocks, scale }
    }

    /// V(t), (deg/h)²: the variance of the mean over `t_s` of the continuous process.
    pub fn mean_variance(&self, t_s: f64) -> f64 {
        2.0 * self.rms_deg_h.powi(2) * ramped(self.rate() * t_s).re
    }

    /// Allan variance at `tau_s`, (deg/h)².
    pub fn allan_variance(&self, tau_s: f64) -> f64 {
        2.0 * (self.mean_variance(tau_s) - self.mean_variance(2.0 * tau_s)).max(0.0)
    }

    /// Density at zero frequency of a Markov process as an angle random walk: q_c·T_c, deg/√h.
    pub fn white_equivalent_deg_rt_h(&self) -> f64 {
        self.rms_deg_h * (2.0 * self.decay_time_s / 3600.0).sqrt()
    }
}

/// What bins of one segment length under a Hann window show of a process on average: what a resonance narrower than the
/// window becomes. All that no frequency enters is computed once; records have a thousand bins and a fit
/// asks for them hundreds of times.
#[derive(Debug, Clone, Copy)]
pub struct Windowed {
    gamma0: f64,
    first: Complex<f64>,
    rho: Complex<f64>,
    /// ρ^(L − 1).
    last: Complex<f64>,
    /// e^(2πi/L).
    bin: Complex<f64>,
    segment: f64,
    tau_s: f64,
    scale: f64,
}

fn turn(phase: f64) -> Complex<f64> {
    let (sin, cos) = phase.sin_cos();
    Complex::new(cos, sin)
}

impl Windowed {
    /// Two-sided density at `frequency_hz`, (deg/h)²/Hz.
    pub fn density(&self, frequency_hz: f64) -> f64 {
        let theta = 2.0 * PI * frequency_hz * self.tau_s;
        self.at(turn(theta), turn(theta * self.segment))
    }

    /// The densities of bins by their turns.
    pub(crate) fn densities(&self, turns: Turns<'_>, out: &mut [f64]) {
        let here = turns.cos.iter().zip(turns.sin).map(|(cos, sin)| Complex::new(*cos, *sin));
        let round = turns.cos_round.iter().zip(turns.sin_round).map(|(cos, sin)| Complex::new(*cos, *sin));
        out.iter_mut().zip(here.zip(round)).for_each(|(o, (here, round))| *o = self.at(here, round));
    }

    /// The density at the turns from one sample to the next and over the segment.
    fn at(&self, here: Complex<f64>, round: Complex<f64>) -> f64 {
        let l = self.segment;
        let one = Complex::new(1.0, 0.0);
        // Autocorrelation of the window: (1 − x)(2 + cos 2πx)/3 + sin(2πx)/(2π), x = d/L.
        let odd = 1.0 / (4.0 * PI);
        let weights = [(self.bin.conj(), 1.0 / 6.0, odd), (one, 2.0 / 3.0, 0.0), (self.bin, 1.0 / 6.0, -odd)];
        let part = |side: Complex<f64>, round: Complex<f64>, (shift, even, odd): (Complex<f64>, f64, f64)| {
            let u = side * shift;
            let z = self.rho * u;
            // A turn by a whole bin is none after L samples.
            let last = self.last * round * u.conj();
            let inverse = inverted(one - z);
            let plain = u * (one - last) * inverse;
            let weighted = u * (one - last * l + last * z * (l - 1.0)) * inverse * inverse;
            (plain - weighted / l) * even + plain * Complex::new(0.0, odd)
        };
        let parts = weights.map(|weight| part(here, round, weight));
        // Of a Markov process all but the turns is real: the other direction gives the conjugates, in the other order.
        let is_real = self.rho.im == 0.0 && self.last.im == 0.0;
        let others = if is_real {
            let [a, b, c] = parts;
            [c, b, a].map(|part| part.conj())
        } else {
            weights.map(|weight| part(here.conj(), round.conj(), weight))
        };
        let sum: Complex<f64> = parts.into_iter().chain(others).sum();
        (self.scale * (self.gamma0 + (self.first * sum).re)).max(0.0)
    }
}

impl Damped {
    /// The bins of segments of `segment` samples over `tau_s`.
    pub fn windowed(&self, segment: usize, tau_s: f64, sampling: Sampling) -> Windowed {
        let (gamma0, first, rho) = self.covariance(tau_s, sampling);
        let l = segment as f64;
        Windowed {
            gamma0,
            first,
            rho,
            last: rho.powf(l - 1.0),
            bin: turn(2.0 * PI / l),
            segment: l,
            tau_s,
            scale: self.rms_deg_h.powi(2) * tau_s,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn covariance_sum(d: &Damped, k: usize, blocks: usize, tau: f64) -> f64 {
        // The same by quadrature of the continuous covariance and a plain double sum over pairs.
        let r = |t: f64| {
            d.rms_deg_h.powi(2) * (-t.abs() / d.decay_time_s).exp() * (2.0 * PI * d.frequency_hz * t).cos()
        };
        let steps = 400;
        let gamma = |lag: usize| {
            // ∫∫ R(lag τ + u − v) = ∫ (1 − |w|) R((lag + w) τ) dw over −1..1.
            (0..2 * steps)
                .map(|i| {
                    let w = (i as f64 + 0.5) / steps as f64 - 1.0;
                    (1.0 - w.abs()) * r((lag as f64 + w) * tau) / steps as f64
                })
                .sum::<f64>()
        };
        let g: Vec<f64> = (0..blocks).map(gamma).collect();
        let phase = |j: usize| (PI * k as f64 * (j as f64 + 0.5) / blocks as f64).cos();
        let mut sum = 0.0;
        for i in 0..blocks {
            for j in 0..blocks {
                sum += 2.0 / blocks as f64 * g[i.abs_diff(j)] * phase(i) * phase(j);
            }
        }
        sum * tau
    }

    #[test]
    fn modes_agree_with_the_covariance_summed_over_all_pairs() {
        for (f, t) in [(0.0, 1.5), (0.0, 40.0), (0.07, 30.0), (0.21, 400.0)] {
            let d = Damped { rms_deg_h: 1.3, frequency_hz: f, decay_time_s: t };
            for k in [1, 2, 9, 31, 63] {
                let expected = covariance_sum(&d, k, 64, 2.0);
                let got = d.mode_power(k, 64, 2.0, Sampling::Averaging);
                assert!((got / expected - 1.0).abs() < 2e-4, "{f} {t} {k}: {got} {expected}");
            }
        }
    }

    #[test]
    fn a_window_shows_the_covariance_weighted_with_its_own() {
        let l = 64usize;
        let window: Vec<f64> =
            (0..l).map(|i| 0.5 - 0.5 * (2.0 * PI * (i as f64 + 0.5) / l as f64).cos()).collect();
        let square: f64 = window.iter().map(|w| w * w).sum();
        for (f, t) in [(0.0, 3.0), (0.0, 900.0), (0.2, 5000.0), (0.13, 20.0)] {
            let d = Damped { rms_deg_h: 1.0, frequency_hz: f, decay_time_s: t };
            let (gamma0, first, rho) = d.covariance(1.0, Sampling::Averaging);
            let gamma = |lag: usize| match lag {
                0 => gamma0,
                _ => (first * rho.powf(lag as f64 - 1.0)).re,
            };
            for k in [0, 5, 8, 13, 20] {
                let f = k as f64 / l as f64;
                let mut expected = 0.0;
                for i in 0..l {
                    for j in 0..l {
                        let phase = 2.0 * PI * f * (i as f64 - j as f64);
                        expected += window[i] * window[j] * gamma(i.abs_diff(j)) * phase.cos() / square;
                    }
                }
                let got = d.windowed(l, 1.0, Sampling::Averaging).density(f);
                // The window is summed at middles of samples here and integrated there.
                assert!((got - expected).abs() < 5e-3 * expected + 2e-4, "{f} {t} {k}: {got} {expected}");
            }
        }
    }

    #[test]
    fn densities_integrate_to_the_variance_of_the_samples() {
        for (f, t) in [(0.0, 0.8), (0.0, 25.0), (0.11, 20.0), (0.7, 60.0)] {
            let d = Damped { rms_deg_h: 2.0, frequency_hz: f, decay_time_s: t };
            for (sampling, expected) in
                [(Sampling::Averaging, d.mean_variance(1.0)), (Sampling::Instantaneous, 4.0)]
            {
                let steps = 100_000;
                let total: f64 = (0..steps)
                    .map(|i| d.density((f64::from(i) + 0.5) * 0.5 / f64::from(steps), 1.0, sampling))
                    .sum::<f64>()
                    / f64::from(steps);
                assert!((total / expected - 1.0).abs() < 1e-4, "{f} {t} {sampling:?}: {total} {expected}");
            }
        }
    }

    #[test]
    fn published_allan_deviations_of_the_markov_process() {
        // u = τ/T: deviation over σ.
        let d = Damped { rms_deg_h: 1.0, frequency_hz: 0.0, decay_time_s: 50.0 };
        for (u, expected) in [
            (0.1, 0.248_780_84),
            (0.5, 0.482_672_55),
            (1.892_617_78, 0.617_364_28),
            (10.0, 0.412_312_76),
            (100.0, 0.140_356_69),
        ] {
            assert!((d.allan_variance(50.0 * u).sqrt() - expected).abs() < 1e-8);
        }
    }

    #[test]
    fn a_coherent_disturbance_reaches_the_published_maximum() {
        let d = Damped { rms_deg_h: 0.5f64.sqrt(), frequency_hz: 0.1, decay_time_s: 1e9 };
        let tau = 0.371_009_65 / 0.1;
        assert!((d.allan_variance(tau).sqrt() - 0.724_611_35).abs() < 1e-6);
    }

    #[test]
    fn slow_processes_keep_their_digits() {
        let d = Damped { rms_deg_h: 1.0, frequency_hz: 0.0, decay_time_s: 1e7 };
        // τ ≪ T: a random walk of q_c²τ/3 with q_c² = 2σ²/T.
        assert!((d.allan_variance(1.0) / (2.0 / 1e7 / 3.0) - 1.0).abs() < 1e-6);
        let fast = Damped { rms_deg_h: 1.0, frequency_hz: 0.0, decay_time_s: 1e-3 };
        let n2 = fast.white_equivalent_deg_rt_h().powi(2) * 3600.0;
        assert!((fast.density(0.1, 1.0, Sampling::Averaging) / n2 - 1.0).abs() < 1e-2);
    }
}
