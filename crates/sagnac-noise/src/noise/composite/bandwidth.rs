//! The bandwidth of a measurement: what a filter between the physics and the samples does to noise.

use super::damped::{Damped, Sampling};
use super::sampled_density;
use crate::noise::data::NoiseType;
use std::f64::consts::PI;

/// A low-pass filter of the output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bandwidth {
    /// First order, before sampling.
    FirstOrder {
        /// Time constant, s; the −3 dB cut-off lies at 1/(2π·time constant).
        time_constant_s: f64,
    },
    /// Mean of the last so many samples, at every sample.
    MovingAverage {
        /// Samples in the mean, at least 2.
        samples: u32,
    },
}

/// Neighbouring aliases summed on each side; what is left out falls as the fifth power of the distance.
const ALIASES_PER_SIDE: i32 = 3;

/// E\[c_k²\] of the orthonormal cosine mode k of `blocks` means over the last `samples` of white samples of variance 1.
///
/// The ends of a record leave power at the zeros of the mean, where the density has none: taken for something else, it is
/// quantisation.
pub fn averaged_white_mode(samples: u32, mode: f64, blocks: usize) -> f64 {
    let (n, m) = (f64::from(samples.max(1)), blocks as f64);
    let (sin, cos) = (PI * mode / m).sin_cos();
    // cos(ad) and sin(ad) by the angle-addition recurrence; the autocovariance is a triangle of `samples` lags.
    let (mut c, mut s) = (1.0, 0.0);
    let mut sum = 0.5 * n;
    for lag in 1..samples.max(1) {
        (c, s) = (c * cos - s * sin, s * cos + c * sin);
        let d = f64::from(lag);
        sum += (n - d) * ((1.0 - d / m) * c - s / (m * sin));
    }
    (2.0 * sum / (n * n)).max(0.0)
}

impl Bandwidth {
    /// −3 dB cut-off, Hz.
    pub fn cutoff_hz(&self, tau0_s: f64) -> f64 {
        match *self {
            Bandwidth::FirstOrder { time_constant_s } => 1.0 / (2.0 * PI * time_constant_s),
            Bandwidth::MovingAverage { samples } => 0.443 / (f64::from(samples) * tau0_s),
        }
    }

    /// Density of samples of a term for a coefficient of 1, (deg/h)²/Hz.
    pub fn unit_density(&self, term: NoiseType, frequency_hz: f64, tau0_s: f64, sampling: Sampling) -> f64 {
        if term == NoiseType::Quantization {
            // Rounding comes after the filter.
            return sampled_density(term, frequency_hz, tau0_s, sampling);
        }
        match *self {
            Bandwidth::MovingAverage { samples } => {
                let n = f64::from(samples.max(1));
                let x = PI * frequency_hz * tau0_s;
                let gain = if x.sin().abs() < 1e-12 { 1.0 } else { (n * x).sin() / (n * x.sin()) };
                gain * gain * sampled_density(term, frequency_hz, tau0_s, sampling)
            }
            Bandwidth::FirstOrder { time_constant_s } => match term {
                NoiseType::AngleRandomWalk => {
                    filtered_white(time_constant_s).density(frequency_hz, tau0_s, sampling)
                }
                NoiseType::Flicker => {
                    FlickerAliases::new(frequency_hz, tau0_s, sampling).behind(time_constant_s)
                }
                // Aliases of a random walk fall as f⁻⁶ here: the filter acts on the sampled density.
                _ => {
                    sampled_density(term, frequency_hz, tau0_s, sampling)
                        / (1.0 + (2.0 * PI * frequency_hz * time_constant_s).powi(2))
                }
            },
        }
    }

    /// V(t) of filtered white noise of N = 1 deg/√h, (deg/h)².
    pub fn unit_white_mean_variance(&self, t_s: f64, tau0_s: f64) -> f64 {
        match *self {
            Bandwidth::FirstOrder { time_constant_s } => filtered_white(time_constant_s).mean_variance(t_s),
            Bandwidth::MovingAverage { samples } => {
                let n = f64::from(samples.max(1));
                let m = (t_s / tau0_s).round().max(1.0);
                // Variance of the mean of m samples: a trapezoid of n + m − 1 weights.
                let (short, long) = (n.min(m), n.max(m));
                let inner = (long - short + 1.0) * short * short;
                let ends = (short - 1.0) * short * (2.0 * short - 1.0) / 3.0;
                3600.0 / tau0_s * (inner + ends) / (n * m).powi(2)
            }
        }
    }
}

/// Flicker of B = 1 deg/h at one frequency and its aliases, for any filter of first order.
#[derive(Debug, Clone, Copy)]
pub struct FlickerAliases([Alias; 2 * ALIASES_PER_SIDE as usize + 1]);

/// One alias.
#[derive(Debug, Clone, Copy)]
struct Alias {
    frequency_hz: f64,
    /// Without a filter, (deg/h)²/Hz.
    density: f64,
}

impl FlickerAliases {
    /// Those of samples over `tau0_s`.
    pub fn new(frequency_hz: f64, tau0_s: f64, sampling: Sampling) -> FlickerAliases {
        // The same for all aliases.
        let sin = (PI * frequency_hz * tau0_s).sin();
        FlickerAliases(std::array::from_fn(|i| {
            let f = frequency_hz + f64::from(i as i32 - ALIASES_PER_SIDE) / tau0_s;
            let x = PI * f * tau0_s;
            let averaged = match sampling {
                Sampling::Averaging if x != 0.0 => (sin / x).powi(2),
                _ => 1.0,
            };
            Alias { frequency_hz: f, density: averaged / (2.0 * PI * f.abs()) }
        }))
    }

    /// Density of the samples behind a filter, (deg/h)²/Hz.
    pub fn behind(&self, time_constant_s: f64) -> f64 {
        self.0.iter().map(|a| a.density / (1.0 + (2.0 * PI * a.frequency_hz * time_constant_s).powi(2))).sum()
    }
}

/// White noise of N = 1 deg/√h behind a filter of first order: a Markov process.
pub fn filtered_white(time_constant_s: f64) -> Damped {
    Damped {
        rms_deg_h: (3600.0 / (2.0 * time_constant_s)).sqrt(),
        frequency_hz: 0.0,
        decay_time_s: time_constant_s,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn filtered_white_noise_keeps_its_density_at_low_frequencies() {
        for filter in
            [Bandwidth::FirstOrder { time_constant_s: 2.0 }, Bandwidth::MovingAverage { samples: 7 }]
        {
            let low = filter.unit_density(NoiseType::AngleRandomWalk, 1e-5, 1.0, Sampling::Averaging);
            assert!((low / 3600.0 - 1.0).abs() < 1e-6, "{filter:?}: {low}");
            for term in [NoiseType::Flicker, NoiseType::RateRandomWalk] {
                let plain = sampled_density(term, 1e-4, 1.0, Sampling::Averaging);
                let got = filter.unit_density(term, 1e-4, 1.0, Sampling::Averaging);
                assert!((got / plain - 1.0).abs() < 1e-4, "{filter:?} {term:?}");
            }
        }
    }

    #[test]
    fn a_filter_takes_away_half_at_its_cut_off() {
        for filter in
            [Bandwidth::FirstOrder { time_constant_s: 50.0 }, Bandwidth::MovingAverage { samples: 100 }]
        {
            let f = filter.cutoff_hz(1.0);
            let half = filter.unit_density(NoiseType::AngleRandomWalk, f, 1.0, Sampling::Averaging) / 3600.0;
            assert!((half - 0.5).abs() < 0.002, "{filter:?}: {half}");
        }
    }

    #[test]
    fn modes_of_averaged_white_noise_are_those_of_its_covariance() {
        let blocks = 60;
        for (samples, mode) in [(2, 59), (4, 1), (4, 29), (4, 30), (5, 24), (8, 45), (1, 30)] {
            let n = f64::from(samples);
            let wave = |j: usize| {
                (2.0 / blocks as f64).sqrt() * (PI * mode as f64 * (j as f64 + 0.5) / blocks as f64).cos()
            };
            let mut expected = 0.0;
            for i in 0..blocks {
                for j in 0..blocks {
                    expected += wave(i) * wave(j) * (n - i.abs_diff(j) as f64).max(0.0) / (n * n);
                }
            }
            let got = averaged_white_mode(samples, mode as f64, blocks);
            assert!((got - expected).abs() < 1e-12, "{samples} {mode}: {got} {expected}");
        }
    }

    #[test]
    fn a_moving_average_of_white_noise_has_the_variance_of_a_trapezoid() {
        let filter = Bandwidth::MovingAverage { samples: 3 };
        // Mean of 2 of the means of 3: weights 1 2 2 1 over 6 → 10/36.
        assert!((filter.unit_white_mean_variance(2.0, 1.0) / 3600.0 - 10.0 / 36.0).abs() < 1e-12);
        assert!((filter.unit_white_mean_variance(1.0, 1.0) / 3600.0 - 1.0 / 3.0).abs() < 1e-12);
    }
}
