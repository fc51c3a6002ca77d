//! A second source of records, written from the formulas and sharing nothing with the simulator under test: one
//! circulant embedding of the covariance of all stationary parts (Davies and Harte 1987), the generalised covariance
//! of flicker and random walk included; slow noise behind a filter by oversampling; quantisation by rounding the angle.

use super::mixes::Mix;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use sagnac::noise::composite::{Bandwidth, Composite, Damped};
use sagnac_fft::{Complex, real_forward, real_inverse};
use std::f64::consts::PI;

/// Steps a sample is cut into where a filter acts before sampling.
const OVERSAMPLING: usize = 8;

/// A Gaussian series of given covariance.
struct Embedding {
    /// Roots of the eigenvalues over the length.
    roots: Vec<f64>,
    length: usize,
}

/// The noise of one mix, ready to be drawn from.
pub struct Generator {
    noise: Embedding,
    /// Parts with a covariance of their own where a filter acts.
    beside: Option<Embedding>,
    truth: Composite,
    samples: usize,
    tau0_s: f64,
}

/// (d+1)² ln(d+1) − 2 d² ln d + (d−1)² ln(d−1).
fn second_difference_of_square_log(d: usize) -> f64 {
    let x = d as f64;
    if d > 40 {
        // Taylor: g'' + g⁗/12 + g⁽⁶⁾/360, without the cancellation.
        return 2.0 * x.ln() + 3.0 - 1.0 / (6.0 * x * x) - 12.0 / (360.0 * x.powi(4));
    }
    let g = |x: f64| if x > 0.0 { x * x * x.ln() } else { 0.0 };
    g(x + 1.0) - 2.0 * g(x) + g((x - 1.0).abs())
}

/// Covariance at lag `d` of averages over `tau` of a process of variance 1 and autocovariance e^(−|t|/T) cos 2πft, by
/// Simpson's rule over the triangle that averaging makes.
fn averaged_covariance(d: usize, tau: f64, time: f64, frequency: f64) -> f64 {
    let r = |t: f64| (-t.abs() / time).exp() * (2.0 * PI * frequency * t).cos();
    let steps = 24;
    let half = |from: f64| {
        let h = 1.0 / f64::from(steps);
        (0..=steps)
            .map(|i| {
                let w = from + f64::from(i) * h;
                let weight = match i {
                    0 => 1.0,
                    _ if i == steps => 1.0,
                    _ if i % 2 == 1 => 4.0,
                    _ => 2.0,
                };
                weight * (1.0 - w.abs()) * r((d as f64 + w) * tau) * h / 3.0
            })
            .sum::<f64>()
    };
    half(-1.0) + half(0.0)
}

impl Embedding {
    fn new(model: &Composite, length: usize, tau_s: f64) -> Embedding {
        let terms = &model.terms;
        let tau_h = tau_s / 3600.0;
        let mut covariance: Vec<f64> = (0..=length)
            .map(|d| {
                let white = if d == 0 { terms.n.powi(2) / tau_h } else { 0.0 };
                let flicker = if terms.b == 0.0 {
                    0.0
                } else {
                    -terms.b.powi(2) / (2.0 * PI) * second_difference_of_square_log(d)
                };
                let cubes = if d == 0 { 2.0 } else { 6.0 * d as f64 };
                white + flicker - terms.k.powi(2) * tau_h / 12.0 * cubes
            })
            .collect();
        for process in model.markov.iter().chain(&model.quasi_periodic) {
            for (d, c) in covariance.iter_mut().enumerate() {
                if d as f64 * tau_s > 42.0 * process.decay_time_s {
                    break;
                }
                let unit = averaged_covariance(d, tau_s, process.decay_time_s, process.frequency_hz);
                *c += process.rms_deg_h.powi(2) * unit;
            }
        }
        let mut circle: Vec<f64> =
            covariance.iter().chain(covariance[1..length].iter().rev()).copied().collect();
        let plan = real_forward(2 * length);
        let mut spectrum = plan.make_output_vec();
        plan.process(&mut circle, &mut spectrum).expect("lengths of the plan");
        let largest = spectrum.iter().skip(1).map(|v| v.re).fold(0.0, f64::max);
        let scale = 1.0 / (2 * length) as f64;
        let roots = spectrum
            .iter()
            .enumerate()
            .map(|(k, v)| {
                // A constant is no noise, and that of flicker and random walk is not defined.
                if k == 0 {
                    return 0.0;
                }
                assert!(v.re > -1e-6 * largest, "covariance cannot be embedded: {} of {largest}", v.re);
                (v.re.max(0.0) * scale).sqrt()
            })
            .collect();
        Embedding { roots, length }
    }

    fn draw(&self, rng: &mut Xoshiro256PlusPlus) -> Vec<f64> {
        let plan = real_inverse(2 * self.length);
        let mut normal = || -> f64 { StandardNormal.sample(rng) };
        let mut spectrum: Vec<Complex<f64>> = self
            .roots
            .iter()
            .map(|r| Complex::new(normal(), normal()) * (r * std::f64::consts::FRAC_1_SQRT_2))
            .collect();
        for end in [0, self.length] {
            spectrum[end] = Complex::new(spectrum[end].re * std::f64::consts::SQRT_2, 0.0);
        }
        let mut series = plan.make_output_vec();
        plan.process(&mut spectrum, &mut series).expect("lengths of the plan");
        series.truncate(self.length);
        series
    }
}

impl Generator {
    /// Ready for records of so many samples at an interval in s.
    pub fn new(mix: &Mix, samples: usize, tau0_s: f64) -> Generator {
        let truth = mix.truth.clone();
        let slow = Composite { markov: vec![], quasi_periodic: vec![], ..truth.clone() };
        let damped = Composite {
            markov: truth.markov.clone(),
            quasi_periodic: truth.quasi_periodic.clone(),
            ..Default::default()
        };
        let embedded = |model: &Composite| {
            let any = !model.markov.is_empty() || !model.quasi_periodic.is_empty();
            any.then(|| Embedding::new(model, samples, tau0_s))
        };
        let (noise, beside) = match truth.bandwidth {
            None => (Embedding::new(&truth, samples, tau0_s), None),
            Some(Bandwidth::FirstOrder { time_constant_s }) => {
                // White noise behind the filter has the covariance N²/(2τ_f)·e^(−|t|/τ_f); steps, however fine, would
                // be seen near the Nyquist frequency, where little power is left.
                let mut beside = damped;
                beside.markov.push(Damped {
                    rms_deg_h: truth.terms.n * (3600.0 / (2.0 * time_constant_s)).sqrt(),
                    frequency_hz: 0.0,
                    decay_time_s: time_constant_s,
                });
                let mut slow = slow;
                slow.terms.n = 0.0;
                let fine = tau0_s / OVERSAMPLING as f64;
                (Embedding::new(&slow, samples * OVERSAMPLING, fine), embedded(&beside))
            }
            Some(Bandwidth::MovingAverage { samples: n }) => {
                (Embedding::new(&slow, samples + n as usize - 1, tau0_s), embedded(&damped))
            }
        };
        Generator { noise, beside, truth, samples, tau0_s }
    }

    /// A record of the mix, deg/h, with a bias.
    pub fn record(&self, seed: u64, bias_deg_h: f64) -> Vec<f64> {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        let drawn = self.noise.draw(&mut rng);
        let mut y = match self.truth.bandwidth {
            None => drawn,
            Some(Bandwidth::FirstOrder { time_constant_s }) => filtered(&drawn, time_constant_s, self.tau0_s),
            Some(Bandwidth::MovingAverage { samples: n }) => {
                drawn.windows(n as usize).map(|w| w.iter().sum::<f64>() / f64::from(n)).collect()
            }
        };
        if let Some(beside) = &self.beside {
            y.iter_mut().zip(beside.draw(&mut rng)).for_each(|(y, x)| *y += x);
        }
        let ramp = self.truth.terms.r * self.tau0_s / 3600.0;
        for (i, y) in y.iter_mut().enumerate() {
            *y += bias_deg_h + ramp * (i as f64 + 0.5);
        }
        if self.truth.terms.q != 0.0 {
            let step = self.truth.terms.q * 12f64.sqrt();
            let (mut angle, mut before) = (0.0, 0.0);
            for y in &mut y {
                angle += *y * self.tau0_s;
                let shown = (angle / step).floor() * step;
                (*y, before) = ((shown - before) / self.tau0_s, shown);
            }
        }
        debug_assert_eq!(y.len(), self.samples);
        y
    }
}

/// A first-order filter run at the fine step, then averaged over each sample.
fn filtered(fine: &[f64], time_constant_s: f64, tau0_s: f64) -> Vec<f64> {
    let a = tau0_s / OVERSAMPLING as f64 / time_constant_s;
    let (kept, averaged) = ((-a).exp(), -(-a).exp_m1() / a);
    let mut level: f64 = fine[..fine.len().min(64)].iter().sum::<f64>() / fine.len().min(64) as f64;
    fine.chunks(OVERSAMPLING)
        .map(|chunk| {
            let mut sum = 0.0;
            for x in chunk {
                // The input is constant over the fine step.
                sum += x + (level - x) * averaged;
                level = x + (level - x) * kept;
            }
            sum / chunk.len() as f64
        })
        .collect()
}
