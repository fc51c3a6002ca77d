//! The filter between the physics and the samples.

use super::process::{Markov, normal};
use crate::noise::composite::Bandwidth;
use rand_xoshiro::Xoshiro256PlusPlus;
use std::collections::VecDeque;

/// A running filter of the output.
#[derive(Debug, Clone)]
pub(super) enum Output {
    /// White noise behind it is a Markov process; slower rates are filtered as if constant over a sample.
    FirstOrder { white: Markov, rng: Xoshiro256PlusPlus, kept: f64, averaged: f64, level: Option<f64> },
    /// Mean of the last samples.
    MovingAverage { last: VecDeque<f64>, samples: usize, rng: Xoshiro256PlusPlus, sigma: f64 },
}

impl Output {
    /// `white_sigma` is the standard deviation that unfiltered samples of white noise would have.
    pub(super) fn new(
        filter: &Bandwidth,
        white_sigma: f64,
        tau0_s: f64,
        mut rng: Xoshiro256PlusPlus,
    ) -> Output {
        match *filter {
            Bandwidth::FirstOrder { time_constant_s } => {
                let a = tau0_s / time_constant_s;
                // σ² of the filtered rate: N²/(2 τ_f), that of unfiltered samples being N²/τ0.
                let white = Markov::new(a, white_sigma * (0.5 * a).sqrt(), &mut rng);
                let kept = (-a).exp();
                Output::FirstOrder { white, rng, kept, averaged: -(-a).exp_m1() / a, level: None }
            }
            Bandwidth::MovingAverage { samples } => Output::MovingAverage {
                last: VecDeque::new(),
                samples: samples.max(1) as usize,
                rng,
                sigma: white_sigma,
            },
        }
    }

    /// The next output for the slow part of the rate.
    pub(super) fn next(&mut self, slow: f64) -> f64 {
        match self {
            Output::FirstOrder { white, rng, kept, averaged, level } => {
                let before = level.unwrap_or(slow);
                *level = Some(slow + (before - slow) * *kept);
                slow + (before - slow) * *averaged + white.next(normal(rng))
            }
            Output::MovingAverage { last, samples, rng, sigma } => {
                // At the start the window fills with the first rate and white noise of its own.
                while last.len() < *samples {
                    last.push_back(slow + *sigma * normal(rng));
                }
                last.pop_front();
                last.push_back(slow + *sigma * normal(rng));
                last.iter().sum::<f64>() / *samples as f64
            }
        }
    }
}
