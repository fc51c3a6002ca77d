//! Reproducible simulation of the noise of a rate-integrating gyro: box averages over each sample interval.
//!
//! White rate noise, flicker, rate random walk in its interval-mean form, Markov processes, quasi-periodic disturbances,
//! lines, ramp, a filter of the output and rounding of the angle. A seed fixes every bit of the output, however it is
//! cut into blocks.

mod output;
mod process;

use self::output::Output;
use self::process::{Flicker, Markov, Rotating, normal};
use super::composite::{Composite, Line};
use super::model::NoiseModel;
use rand::RngExt as _;
use rand::SeedableRng;
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
    markov: Vec<(Markov, Xoshiro256PlusPlus)>,
    rotating: Vec<Rotating>,
    lines: Vec<(Line, f64)>,
    output: Option<Output>,
    bias: f64,
    ramp_per_sample: f64,
    index: u64,
    angle_step: f64,
    angle_rest: f64,
    tau0_s: f64,
}

impl Simulator {
    /// Starts a simulation of N, B, K, R and Q.
    pub fn new(model: &NoiseModel, setup: &Setup) -> Simulator {
        Simulator::of(&Composite::from(*model), setup)
    }

    /// Starts a simulation of every term. Samples are averages over their interval.
    pub fn of(model: &Composite, setup: &Setup) -> Simulator {
        let mut seeds = SplitMix64::seed_from_u64(setup.seed);
        let mut stream = || Xoshiro256PlusPlus::from_rng(&mut seeds);
        let (white, flicker, walk) = (stream(), stream(), stream());
        let terms = &model.terms;
        let tau_h = setup.tau0_s / 3600.0;
        let step = terms.k.abs() * tau_h.sqrt();
        let markov = model.markov.iter().map(|m| {
            let mut rng = stream();
            (Markov::new(setup.tau0_s / m.decay_time_s, m.rms_deg_h, &mut rng), rng)
        });
        let markov = markov.collect();
        let rotating =
            model.quasi_periodic.iter().map(|p| Rotating::new(p, setup.tau0_s, stream())).collect();
        let lines = model.lines.iter().map(|l| {
            let phase: f64 = stream().random();
            (*l, 2.0 * PI * phase)
        });
        let lines = lines.collect();
        let white_sigma = terms.n.abs() / tau_h.sqrt();
        let output = model.bandwidth.as_ref().map(|b| Output::new(b, white_sigma, setup.tau0_s, stream()));
        Simulator {
            white,
            white_sigma: if output.is_some() { 0.0 } else { white_sigma },
            flicker: (terms.b != 0.0)
                .then(|| Flicker::new(terms.b, setup.tau0_s, setup.flicker_lowest_hz, flicker)),
            walk: Walk { level: 0.0, step, rng: walk },
            markov,
            rotating,
            lines,
            output,
            bias: setup.bias_deg_h,
            ramp_per_sample: terms.r * tau_h,
            index: 0,
            angle_step: terms.q.abs() * 12f64.sqrt(),
            angle_rest: 0.0,
            tau0_s: setup.tau0_s,
        }
    }

    /// Fills `out` with the next samples, deg/h.
    pub fn fill(&mut self, out: &mut [f64]) {
        for y in out.iter_mut() {
            let middle = self.index as f64 + 0.5;
            let mut rate = self.bias + self.ramp_per_sample * middle;
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
            if let Some(output) = &mut self.output {
                rate = output.next(rate);
            }
            for (process, rng) in &mut self.markov {
                rate += process.next(normal(rng));
            }
            for process in &mut self.rotating {
                rate += process.next();
            }
            for (line, phase) in &self.lines {
                let half = PI * line.frequency_hz * self.tau0_s;
                let averaged = if half.abs() < 1e-9 { 1.0 } else { half.sin() / half };
                rate += line.amplitude_deg_h * averaged * (2.0 * half * middle + phase).cos();
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
            let runs = 100;
            let mut power = vec![0.0; n];
            for run in 0..runs {
                for (p, c) in power.iter_mut().zip(dct2(&record(&model, seed * 10_000 + run, n))) {
                    *p += c * c / runs as f64;
                }
            }
            let expected = |k: usize| {
                let f = k as f64 / (2.0 * n as f64);
                term.density(&Bin {
                    frequency_hz: f,
                    tau_s: 1.0,
                    filling: 1.0,
                    mode: k,
                    blocks: n,
                    segment: 0,
                })
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

    #[test]
    fn damped_processes_and_filters_have_their_closed_densities() {
        use crate::noise::composite::{Bandwidth, Damped};
        let n = 2048;
        let damped = |f, t| Damped { rms_deg_h: 1.0, frequency_hz: f, decay_time_s: t };
        let white = NoiseModel { n: 0.01, ..Default::default() };
        let cases = [
            Composite { markov: vec![damped(0.0, 1.5)], ..Default::default() },
            Composite { markov: vec![damped(0.0, 300.0)], ..Default::default() },
            Composite { quasi_periodic: vec![damped(0.12, 200.0)], ..Default::default() },
            Composite { quasi_periodic: vec![damped(0.003, 2000.0)], ..Default::default() },
            Composite {
                bandwidth: Some(Bandwidth::FirstOrder { time_constant_s: 2.5 }),
                ..Composite::from(white)
            },
            Composite { bandwidth: Some(Bandwidth::MovingAverage { samples: 4 }), ..Composite::from(white) },
        ];
        for (case, model) in cases.into_iter().enumerate() {
            let runs = 60;
            let mut power = vec![0.0; n];
            for run in 0..runs {
                let setup = Setup::for_record(case as u64 * 10_000 + run, 1.0, n as u64);
                for (p, c) in power.iter_mut().zip(dct2(&Simulator::of(&model, &setup).take(n))) {
                    *p += c * c / runs as f64;
                }
            }
            let expected = |k: usize| {
                let sampling = crate::noise::composite::Sampling::Averaging;
                let damped = model.markov.iter().chain(&model.quasi_periodic);
                let sum: f64 = damped.map(|d| d.mode_power(k, n, 1.0, sampling)).sum();
                sum + model.part_density(
                    crate::noise::composite::Part::Term(NoiseType::AngleRandomWalk),
                    k as f64 / (2.0 * n as f64),
                    1.0,
                )
            };
            let mut low = 1;
            while low < n {
                let high = (low + low / 8 + 1).min(n);
                let (mut got, mut want) = (0.0, 0.0);
                let mut square = 0.0;
                for (k, p) in power.iter().enumerate().take(high).skip(low) {
                    let e = expected(k);
                    got += p;
                    want += e;
                    square += e * e;
                }
                let sigma = (2.0 * square / runs as f64).sqrt() / want;
                assert!(
                    (got / want - 1.0).abs() < 4.5 * sigma + 0.01,
                    "case {case} modes {low}..{high}: {}",
                    got / want
                );
                low = high;
            }
        }
    }
}
