//! Random processes as exact series of box averages: Markov processes, 1/f noise made of them, and the damped cosine, a
//! complex Ornstein-Uhlenbeck process that turns.

use crate::noise::composite::Damped;
use nalgebra::Complex;
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::f64::consts::PI;

/// A standard normal number.
pub(super) fn normal(rng: &mut Xoshiro256PlusPlus) -> f64 {
    StandardNormal.sample(rng)
}

/// Spacing of the correlation times, as a ratio. The ripple of the sum is 2 sech(π²/ln ratio) = 0.3 %.
const CORRELATION_TIME_RATIO: f64 = 4.0;
/// Processes slower than this many samples are driven by uniform numbers: their values are sums of so many of them
/// that no test could tell them from normal ones.
const SLOW_RATE_PER_SAMPLE: f64 = 1.0 / 64.0;

/// 1/f noise as a sum of averaged Gauss-Markov processes with geometrically spaced correlation times, each exact as
/// an ARMA(1,1) series of box averages.
#[derive(Debug, Clone)]
pub(super) struct Flicker {
    fast: Vec<Markov>,
    slow: Vec<Markov>,
    rest_sigma: f64,
    rng: Xoshiro256PlusPlus,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Markov {
    phi: f64,
    innovation: f64,
    carried: f64,
    value: f64,
}

impl Flicker {
    pub(super) fn new(b: f64, tau0_s: f64, lowest_hz: f64, mut rng: Xoshiro256PlusPlus) -> Flicker {
        let spacing = CORRELATION_TIME_RATIO.ln();
        let variance = b * b / PI * spacing;
        // Rates times τ0. Below the slowest lies (2/π)·rate/ω of the density; above the fastest all is white.
        let slowest = (0.02 * 2.0 * PI * lowest_hz * tau0_s).clamp(1e-12, 1.0);
        let (mut fast, mut slow) = (vec![], vec![]);
        let mut rate = slowest;
        while rate < 64.0 {
            let process = Markov::new(rate, variance.sqrt(), &mut rng);
            if rate < SLOW_RATE_PER_SAMPLE {
                slow.push(process)
            } else {
                fast.push(process)
            }
            rate *= CORRELATION_TIME_RATIO;
        }
        // Each faster process adds 2σ²/rate·(1 − 1/rate) to the variance of a sample.
        let tail = 1.0 / (1.0 - 1.0 / CORRELATION_TIME_RATIO);
        let tail2 = 1.0 / (1.0 - 1.0 / (CORRELATION_TIME_RATIO * CORRELATION_TIME_RATIO));
        let rest = 2.0 * variance * (tail / rate - tail2 / (rate * rate));
        Flicker { fast, slow, rest_sigma: rest.sqrt(), rng }
    }

    pub(super) fn next(&mut self) -> f64 {
        let mut sum = self.rest_sigma * normal(&mut self.rng);
        for process in &mut self.fast {
            sum += process.next(normal(&mut self.rng));
        }
        for four in self.slow.chunks_mut(4) {
            let mut bits = self.rng.next_u64();
            for process in four {
                // Sixteen bits, centred and scaled to variance 1.
                let uniform = ((bits & 0xffff) as f64 - 32767.5) * (12f64.sqrt() / 65536.0);
                bits >>= 16;
                sum += process.next(uniform);
            }
        }
        sum
    }
}

impl Markov {
    /// A process of standard deviation `sigma` and rate·τ0 = `a`, in its stationary state.
    pub(super) fn new(a: f64, sigma: f64, rng: &mut Xoshiro256PlusPlus) -> Markov {
        let phi = (-a).exp();
        let lost = -(-a).exp_m1();
        let gamma0 = if a < 0.02 {
            1.0 - a / 3.0 + a * a / 12.0 - a.powi(3) / 60.0 + a.powi(4) / 360.0
        } else {
            2.0 * (a - lost) / (a * a)
        };
        let gamma1 = (lost / a).powi(2);
        // y_i − φ y_{i−1} is a moving average of order one with these two covariances.
        let r0 = gamma0 * (1.0 + phi * phi) - 2.0 * phi * gamma1;
        let r1 = gamma1 - phi * gamma0;
        let half = (0.5 * r0 / r1).max(1.0);
        let theta = half - (half * half - 1.0).sqrt();
        let innovation = sigma * (r0 / (1.0 + theta * theta)).sqrt();
        let e0 = innovation * normal(rng);
        let value = e0 + (sigma * sigma * gamma0 - innovation * innovation).max(0.0).sqrt() * normal(rng);
        Markov { phi, innovation, carried: theta, value: phi * value + theta * e0 }
    }

    /// The next value, given an innovation of variance 1.
    #[inline]
    pub(super) fn next(&mut self, unit: f64) -> f64 {
        let e = self.innovation * unit;
        let y = self.value + e;
        self.value = self.phi * y + self.carried * e;
        y
    }
}

/// A running quasi-periodic disturbance.
#[derive(Debug, Clone)]
pub(super) struct Rotating {
    state: Complex<f64>,
    turn: Complex<f64>,
    average: Complex<f64>,
    /// Standard deviation of each part of the innovation of the state.
    innovation: f64,
    /// The innovation of the average is `shared` times that of the state, and a rest.
    shared: Complex<f64>,
    rest: f64,
    rng: Xoshiro256PlusPlus,
}

impl Rotating {
    pub(super) fn new(process: &Damped, tau0_s: f64, mut rng: Xoshiro256PlusPlus) -> Rotating {
        let one = Complex::new(1.0, 0.0);
        let c = process.rate();
        let a = c.re;
        let turn = (-c * tau0_s).exp();
        // z' = −c z + w with E|w|² = q: the real part then has variance rms².
        let q = 4.0 * a * process.rms_deg_h.powi(2);
        let decayed = -(-2.0 * a * tau0_s).exp_m1() / (2.0 * a);
        let state_power = q * decayed;
        let average_power = if (c * tau0_s).norm() < 1e-3 {
            q * tau0_s / 3.0
        } else {
            q / (tau0_s * tau0_s * c.norm_sqr()) * (tau0_s - 2.0 * ((one - turn) / c).re + decayed)
        };
        let cross = q / tau0_s / c * ((one - turn.conj()) / c.conj() - decayed);
        let shared = cross / state_power;
        let rest = (average_power - cross.norm_sqr() / state_power).max(0.0);
        let mut pair = |sigma: f64| Complex::new(sigma * normal(&mut rng), sigma * normal(&mut rng));
        let state = pair(process.rms_deg_h);
        Rotating {
            state,
            turn,
            average: (one - turn) / (c * tau0_s),
            innovation: (0.5 * state_power).sqrt(),
            shared,
            rest: (0.5 * rest).sqrt(),
            rng,
        }
    }

    pub(super) fn next(&mut self) -> f64 {
        let e = Complex::new(normal(&mut self.rng), normal(&mut self.rng)) * self.innovation;
        let mean = self.average * self.state + self.shared * e;
        self.state = self.turn * self.state + e;
        mean.re + self.rest * normal(&mut self.rng)
    }
}
