//! What each explanation does to a gyro, written for this study; the library has models of its own.

use crate::bench::EARTH;
use crate::bench::noise_source::NoiseSource;
use serde::Deserialize;

/// What chamber and table do, sample by sample.
pub struct Bench {
    /// Sample interval, s.
    pub dt_s: f64,
    /// Samples.
    pub samples: usize,
    /// °C.
    pub temperature: Option<Vec<f64>>,
    /// deg/s.
    pub table_rate: Option<Vec<f64>>,
    /// deg.
    pub table_angle: Option<Vec<f64>>,
}

/// deg/h in 1 deg/s.
const PER_DEG_S: f64 = 3600.0;
/// Steps of an integration within a sample.
const WITHIN: usize = 20;

/// What is true.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Truth {
    /// It happened once and is part of the bias.
    Settled,
    /// The temperature coefficient is larger than claimed, deg/h/°C.
    Linear {
        /// By so much.
        extra: f64,
    },
    /// The bias drifts, deg/h an hour.
    Drift {
        /// Slope.
        slope: f64,
    },
    /// Proportional to the rate of change of the temperature, deg/h/(°C/min).
    Rate {
        /// Coefficient.
        per_degc_min: f64,
    },
    /// The bias follows the temperature with play.
    Hysteresis {
        /// Difference of the branches, deg/h.
        width: f64,
        /// Half the temperature that a reversal takes, °C.
        play: f64,
    },
    /// The claimed coefficient, deg/h/°C, acts through a delay.
    Lag {
        /// Coefficient.
        coefficient: f64,
        /// Time constant, s.
        time_s: f64,
    },
    /// The gyro was turned so that the rate at angle 0 changed by a step, deg/h.
    Turned {
        /// Latitude, deg.
        latitude_deg: f64,
        /// Heading at angle 0 before, deg.
        azimuth_deg: f64,
        /// Step.
        step: f64,
    },
    /// The scale factor is off, ppm.
    Scale {
        /// Error.
        ppm: f64,
    },
    /// The scale factor grows with the square of the rate, ppm at a rate in deg/s.
    Cubic {
        /// Error there.
        ppm: f64,
        /// Rate.
        at: f64,
    },
    /// A random walk of K, deg/h/√h, in place of the claimed one.
    Walk {
        /// K.
        k: f64,
    },
    /// A first-order process beside the claimed noise.
    Markov {
        /// Deviation, deg/h.
        sigma: f64,
        /// Correlation time, s.
        time_s: f64,
    },
    /// Something smooth that was not recorded.
    Driver {
        /// Deviation, deg/h.
        sigma: f64,
        /// Time constant of each of two relaxations one behind the other, s.
        time_s: f64,
    },
}

impl Truth {
    /// What it adds to each sample, deg/h.
    pub fn adds(self, bench: &Bench, noise: &mut NoiseSource) -> Vec<f64> {
        let n = bench.samples;
        let t = bench.temperature.clone().unwrap_or_else(|| vec![20.0; n]);
        let rate = bench.table_rate.clone().unwrap_or_else(|| vec![0.0; n]);
        let angle = bench.table_angle.clone().unwrap_or_else(|| vec![0.0; n]);
        match self {
            Truth::Settled => vec![0.0; n],
            Truth::Linear { extra } => t.iter().map(|t| extra * (t - 20.0)).collect(),
            Truth::Drift { slope } => (0..n).map(|i| slope * i as f64 * bench.dt_s / 3600.0).collect(),
            Truth::Rate { per_degc_min } => {
                let per_min = 60.0 / bench.dt_s;
                let ahead = |i: usize| t[(i + 1).min(n - 1)] - t[i.min(n - 2)];
                (0..n).map(|i| per_degc_min * per_min * ahead(i)).collect()
            }
            Truth::Hysteresis { width, play } => backlash(&t, width, play),
            Truth::Lag { coefficient, time_s } => {
                delayed(&t, time_s, bench.dt_s).iter().zip(&t).map(|(d, t)| coefficient * (d - t)).collect()
            }
            Truth::Turned { latitude_deg, azimuth_deg, step } => {
                let horizontal = EARTH * latitude_deg.to_radians().cos();
                let by = turn_for(step, horizontal, azimuth_deg.to_radians());
                let at =
                    |a: f64, by: f64| horizontal * (a.to_radians() + azimuth_deg.to_radians() + by).cos();
                angle.iter().map(|a| at(*a, by) - at(*a, 0.0)).collect()
            }
            Truth::Scale { ppm } => rate.iter().map(|w| 1e-6 * ppm * PER_DEG_S * w).collect(),
            Truth::Cubic { ppm, at } => {
                rate.iter().map(|w| 1e-6 * ppm * PER_DEG_S * w.powi(3) / (at * at)).collect()
            }
            Truth::Walk { k } => noise.walk(k, bench.dt_s, n),
            Truth::Driver { sigma, time_s } => smooth(sigma, time_s, bench, noise),
            Truth::Markov { sigma, time_s } => noise.markov(sigma, time_s, bench.dt_s, n),
        }
    }
}

/// A point dragged between two walls `play` on either side of the temperature; its branch between −1/2 and 1/2.
fn backlash(t: &[f64], width: f64, play: f64) -> Vec<f64> {
    let mut dragged = t.first().copied().unwrap_or(0.0);
    let follow = |t: &f64| {
        if t - dragged > play {
            dragged = t - play;
        } else if dragged - t > play {
            dragged = t + play;
        }
        width * (t - dragged) / (2.0 * play)
    };
    t.iter().map(follow).collect()
}

/// Heat through one resistance, in small steps.
fn delayed(t: &[f64], time_s: f64, dt_s: f64) -> Vec<f64> {
    let mut inside = t.first().copied().unwrap_or(0.0);
    let mut before = inside;
    let follow = |t: &f64| {
        for step in 1..=WITHIN {
            let outside = before + (t - before) * step as f64 / WITHIN as f64;
            inside += (outside - inside) * dt_s / WITHIN as f64 / time_s;
        }
        before = *t;
        inside
    };
    t.iter().map(follow).collect()
}

/// The smallest turn, rad, that changes the projection at angle 0 by a step, found by halving.
fn turn_for(step: f64, horizontal: f64, heading: f64) -> f64 {
    let change = |by: f64| horizontal * ((heading + by).cos() - heading.cos());
    let towards = if change(1e-4) * step > 0.0 { 1.0 } else { -1.0 };
    let (mut low, mut high) = (0.0, 0.5);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if change(towards * middle).abs() < step.abs() { low = middle } else { high = middle }
    }
    towards * high
}

/// Noise behind two relaxations of one time constant, brought to a deviation. It has run for ten time constants when the
/// record begins.
fn smooth(sigma: f64, time_s: f64, bench: &Bench, noise: &mut NoiseSource) -> Vec<f64> {
    let lead = (10.0 * time_s / bench.dt_s).ceil() as usize;
    let kept = (-bench.dt_s / time_s).exp();
    // Deviation of the second relaxation for kicks of 1: √((1 + a²)/(1 − a²)³) of their size times 1 − a.
    let square = kept * kept;
    let size = (1.0 - kept) * ((1.0 + square) / (1.0 - square).powi(3)).sqrt();
    let (mut first, mut second) = (0.0, 0.0);
    let next = |_| {
        first = kept * first + noise.normal();
        second = kept * second + (1.0 - kept) * first;
        sigma * second / size
    };
    (0..lead + bench.samples).map(next).skip(lead).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smooth_process_has_the_deviation_asked_for() {
        let bench =
            Bench { dt_s: 20.0, samples: 400_000, temperature: None, table_rate: None, table_angle: None };
        let x = smooth(0.5, 400.0, &bench, &mut NoiseSource::new(3));
        let rms = (x.iter().map(|x| x * x).sum::<f64>() / x.len() as f64).sqrt();
        assert!((rms / 0.5 - 1.0).abs() < 0.04, "{rms}");
    }

    #[test]
    fn a_turn_makes_the_step_that_was_seen() {
        let turned = Truth::Turned { latitude_deg: 55.98, azimuth_deg: 80.0, step: 0.06 };
        let angle = Some(vec![0.0, 90.0]);
        let bench = Bench { dt_s: 5.0, samples: 2, temperature: None, table_rate: None, table_angle: angle };
        let seen = turned.adds(&bench, &mut NoiseSource::new(1));
        assert!((seen[0] - 0.06).abs() < 1e-9 && (seen[1] - seen[0]).abs() > 1e-3, "{seen:?}");
    }
}
