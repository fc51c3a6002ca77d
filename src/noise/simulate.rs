//! Reproducible simulation of the noise of a rate-integrating gyro: box averages over each sample interval.
//!
//! White rate noise, flicker, rate random walk in its interval-mean form, ramp, and rounding of the angle. A seed
//! fixes every bit of the output, however it is cut into blocks.

use super::model::NoiseModel;
use rand::{Rng, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::{SplitMix64, Xoshiro256PlusPlus};
use std::f64::consts::PI;

/// What a simulation needs beside the noise model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setup {
    /// Seed: equal seeds give equal records.
    pub seed: u64,
    /// Sample interval, s.
    pub tau0_s: f64,
    /// Constant rate, deg/h.
    pub bias_deg_h: f64,
    /// Lowest frequency down to which flicker follows 1/f within 2 %, Hz. A record of length T shows it from
    /// 1/(2T) on.
    pub flicker_lowest_hz: f64,
}

impl Setup {
    /// A record of `samples` samples: flicker is right from a twentieth of the lowest frequency 1/(2T) it shows.
    pub fn for_record(seed: u64, tau0_s: f64, samples: u64) -> Setup {
        Setup { seed, tau0_s, bias_deg_h: 0.0, flicker_lowest_hz: 0.025 / (samples.max(2) as f64 * tau0_s) }
    }
}

/// A running simulation.
#[derive(Debug, Clone)]
pub struct Simulator {
    white: Xoshiro256PlusPlus,
    white_sigma: f64,
    flicker: Option<Flicker>,
    walk: Walk,
    bias: f64,
    ramp_per_sample: f64,
    index: u64,
    angle_step: f64,
    angle_rest: f64,
    tau0_s: f64,
}

impl Simulator {
    /// Starts a simulation.
    pub fn new(model: &NoiseModel, setup: &Setup) -> Simulator {
        let mut seeds = SplitMix64::seed_from_u64(setup.seed);
        let mut stream = || Xoshiro256PlusPlus::from_rng(&mut seeds);
        let (white, flicker, walk) = (stream(), stream(), stream());
        let tau_h = setup.tau0_s / 3600.0;
        let step = model.k.abs() * tau_h.sqrt();
        Simulator {
            white,
            white_sigma: model.n.abs() / tau_h.sqrt(),
            flicker: (model.b != 0.0)
                .then(|| Flicker::new(model.b, setup.tau0_s, setup.flicker_lowest_hz, flicker)),
            walk: Walk { level: 0.0, step, rng: walk },
            bias: setup.bias_deg_h,
            ramp_per_sample: model.r * tau_h,
            index: 0,
            angle_step: model.q.abs() * 12f64.sqrt(),
            angle_rest: 0.0,
            tau0_s: setup.tau0_s,
        }
    }

    /// Fills `out` with the next samples, deg/h.
    pub fn fill(&mut self, out: &mut [f64]) {
        for y in out.iter_mut() {
            let mut rate = self.bias + self.ramp_per_sample * (self.index as f64 + 0.5);
            self.index += 1;
            if self.white_sigma > 0.0 {
                rate += self.white_sigma * normal(&mut self.white);
            }
            if let Some(flicker) = &mut self.flicker {
                rate += flicker.next();
            }
            if self.walk.step > 0.0 {
                rate += self.walk.next();
            }
            *y = rate;
        }
        if self.angle_step > 0.0 {
            // The counter shows whole steps; what is left over stays in it for the next sample.
            for y in out.iter_mut() {
                let angle = self.angle_rest + *y * self.tau0_s;
                let counted = (angle / self.angle_step).round() * self.angle_step;
                self.angle_rest = angle - counted;
                *y = counted / self.tau0_s;
            }
        }
    }

    /// The next `samples` samples as a vector, deg/h.
    pub fn take(&mut self, samples: usize) -> Vec<f64> {
        let mut out = vec![0.0; samples];
        self.fill(&mut out);
        out
    }
}

fn normal(rng: &mut Xoshiro256PlusPlus) -> f64 {
    StandardNormal.sample(rng)
}

/// Interval means of a Wiener process.
#[derive(Debug, Clone)]
struct Walk {
    level: f64,
    step: f64,
    rng: Xoshiro256PlusPlus,
}

impl Walk {
    fn next(&mut self) -> f64 {
        // Given the increment d, the mean over the interval is d/2 with variance step²/12.
        let increment = self.step * normal(&mut self.rng);
        let mean = self.level + 0.5 * increment + self.step / 12f64.sqrt() * normal(&mut self.rng);
        self.level += increment;
        mean
    }
}

/// Spacing of the correlation times, as a ratio. The ripple of the sum is 2 sech(π²/ln ratio) = 0.3 %.
const RATIO: f64 = 4.0;
/// Processes slower than this many samples are driven by uniform numbers: their values are sums of so many of them
/// that no test could tell them from normal ones.
const SLOW: f64 = 1.0 / 64.0;

/// 1/f noise as a sum of averaged Gauss-Markov processes with geometrically spaced correlation times, each exact as
/// an ARMA(1,1) series of box averages.
#[derive(Debug, Clone)]
struct Flicker {
    fast: Vec<Markov>,
    slow: Vec<Markov>,
    rest_sigma: f64,
    rng: Xoshiro256PlusPlus,
}

#[derive(Debug, Clone, Copy)]
struct Markov {
    phi: f64,
    innovation: f64,
    carried: f64,
    value: f64,
}

impl Flicker {
    fn new(b: f64, tau0_s: f64, lowest_hz: f64, mut rng: Xoshiro256PlusPlus) -> Flicker {
        let spacing = RATIO.ln();
        let variance = b * b / PI * spacing;
        // Rates times τ0. Below the slowest lies (2/π)·rate/ω of the density; above the fastest all is white.
        let slowest = (0.02 * 2.0 * PI * lowest_hz * tau0_s).clamp(1e-12, 1.0);
        let (mut fast, mut slow) = (vec![], vec![]);
        let mut rate = slowest;
        while rate < 64.0 {
            let process = Markov::new(rate, variance.sqrt(), &mut rng);
            if rate < SLOW {
                slow.push(process)
            } else {
                fast.push(process)
            }
            rate *= RATIO;
        }
        // Each faster process adds 2σ²/rate·(1 − 1/rate) to the variance of a sample.
        let tail = 1.0 / (1.0 - 1.0 / RATIO);
        let tail2 = 1.0 / (1.0 - 1.0 / (RATIO * RATIO));
        let rest = 2.0 * variance * (tail / rate - tail2 / (rate * rate));
        Flicker { fast, slow, rest_sigma: rest.sqrt(), rng }
    }

    fn next(&mut self) -> f64 {
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
    fn new(a: f64, sigma: f64, rng: &mut Xoshiro256PlusPlus) -> Markov {
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
    fn next(&mut self, unit: f64) -> f64 {
        let e = self.innovation * unit;
        let y = self.value + e;
        self.value = self.phi * y + self.carried * e;
        y
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::data::NoiseType;
    use crate::noise::model::unit_allan_variance;
    use crate::numeric::cosine::dct2;

    fn record(model: &NoiseModel, seed: u64, n: usize) -> Vec<f64> {
        Simulator::new(model, &Setup::for_record(seed, 1.0, n as u64)).take(n)
    }

    #[test]
    fn a_seed_fixes_the_record_whatever_the_blocks() {
        let model = NoiseModel { n: 0.002, b: 0.004, k: 0.001, r: 0.01, q: 0.05 };
        let setup = Setup::for_record(5, 0.1, 1000);
        let whole = Simulator::new(&model, &setup).take(1000);
        let mut cut = Simulator::new(&model, &setup);
        let pieces: Vec<f64> = [1, 7, 500, 492].into_iter().flat_map(|n| cut.take(n)).collect();
        assert_eq!(whole, pieces);
        assert_ne!(whole, record(&model, 6, 1000));
    }

    #[test]
    fn power_in_each_mode_agrees_with_the_closed_spectrum() {
        use crate::noise::model::{Bin, Spectral};
        let n = 2048;
        for (term, seed) in
            [(NoiseType::AngleRandomWalk, 1), (NoiseType::Flicker, 2), (NoiseType::RateRandomWalk, 3)]
        {
            let model = NoiseModel::default().with(term, 1.0);
            let runs = 600;
            let mut power = vec![0.0; n];
            for run in 0..runs {
                for (p, c) in power.iter_mut().zip(dct2(&record(&model, seed * 10_000 + run, n))) {
                    *p += c * c / runs as f64;
                }
            }
            let expected = |k: usize| {
                let f = k as f64 / (2.0 * n as f64);
                term.density(&Bin { frequency_hz: f, tau_s: 1.0, filling: 1.0, mode: k, blocks: n })
            };
            // Geometric bands; tolerance three standard deviations of the band's mean, at most 2 % where it is wide.
            let mut low = 1;
            while low < n {
                let high = (low * 2).min(n);
                let ratio: f64 =
                    (low..high).map(|k| power[k] / expected(k)).sum::<f64>() / (high - low) as f64;
                let sigma = (2.0 / (runs as f64 * (high - low) as f64)).sqrt();
                assert!((ratio - 1.0).abs() < 3.5 * sigma + 0.004, "{term:?} modes {low}..{high}: {ratio}");
                low = high;
            }
        }
    }

    #[test]
    fn allan_variances_agree_with_the_closed_forms() {
        let n = 1 << 18;
        for term in [NoiseType::AngleRandomWalk, NoiseType::Flicker, NoiseType::Quantization] {
            let mut model = NoiseModel::default().with(term, 1.0);
            if term == NoiseType::Quantization {
                // Some motion is needed for the rounding error to be spread evenly.
                model.n = 0.2;
            }
            let y = record(&model, 11, n);
            for m in [1usize, 4, 16, 64] {
                let means: Vec<f64> = y.chunks_exact(m).map(|c| c.iter().sum::<f64>() / m as f64).collect();
                let allan = means.windows(2).map(|w| (w[1] - w[0]).powi(2)).sum::<f64>()
                    / (2.0 * (means.len() - 1) as f64);
                let expected = if term == NoiseType::Quantization {
                    model.allan_variance(m as f64)
                } else {
                    unit_allan_variance(term, m as f64)
                };
                let tolerance = 5.0 / (n as f64 / m as f64).sqrt() + 0.005;
                assert!((allan / expected - 1.0).abs() < tolerance, "{term:?} {m}: {}", allan / expected);
            }
        }
    }

    #[test]
    fn ramp_and_bias_are_exact() {
        let model = NoiseModel { r: 3600.0, ..Default::default() };
        let setup = Setup { bias_deg_h: 2.0, ..Setup::for_record(0, 2.0, 4) };
        assert_eq!(Simulator::new(&model, &setup).take(3), vec![3.0, 5.0, 7.0]);
    }
}
