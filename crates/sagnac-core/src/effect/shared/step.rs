//! A level that changes once: its column, and a search for the instant.

use crate::effect::sizing::numbers;
use crate::effect::{Drivers, Param, SearchContext, Sizing, Starts};

/// A step at `at_s` seconds after the first sample, the sample that it falls into averaged.
pub(in crate::effect) fn step(drivers: &Drivers, at_s: f64) -> Vec<f64> {
    let dt = drivers.dt_s;
    drivers.of_time(|t| ((t - at_s) / dt + 0.5).clamp(0.0, 1.0))
}

/// Instants at which a step gains most, s after the first sample; the best first.
pub(in crate::effect) fn instants(drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
    let n = drivers.samples;
    if n < 8 {
        return Starts { points: vec![], trials: 1.0 };
    }
    // The gain is (Σ_{i ≥ j} w_i)²/2 over z'C⁻¹z, and the latter varies slowly with the instant: it is computed at some
    // and interpolated.
    let points = 48.min(n / 4);
    let at = |p: usize| 1.0 + (n as f64 - 2.0) * p as f64 / points as f64;
    let weight = |j: f64| {
        let modes = crate::numeric::cosine::dct2(&step(drivers, (j - 0.5) * drivers.dt_s));
        modes.iter().zip(context.powers).skip(1).map(|(z, p)| z * z / p).sum::<f64>()
    };
    let weights: Vec<f64> = (0..=points).map(|p| weight(at(p))).collect();
    let mut sum: f64 = 0.0;
    let mut gains = vec![0.0; n];
    for j in (1..n).rev() {
        sum += context.score[j];
        let x = (j as f64 - at(0)) / (at(1) - at(0));
        let p = (x.max(0.0) as usize).min(points - 1);
        let w = weights[p] + (weights[p + 1] - weights[p]) * (x - p as f64).clamp(0.0, 1.0);
        gains[j] = if w > 0.0 { 0.5 * sum * sum / w } else { 0.0 };
    }
    let mut points = vec![];
    let apart = (n / 50).max(1);
    for _ in 0..3 {
        let best = (1..n).max_by(|a, b| gains[*a].total_cmp(&gains[*b])).unwrap_or(1);
        if gains[best] <= 0.0 {
            break;
        }
        points.push(vec![(best as f64 - 0.5) * drivers.dt_s]);
        gains[best.saturating_sub(apart)..(best + apart).min(n)].fill(0.0);
    }
    Starts { points, trials: trials(n) }
}

/// Instants closer than the time in which the noise lets a step be placed are one; in white noise each counts.
fn trials(samples: usize) -> f64 {
    (samples as f64).powf(0.75)
}

/// Sizes of a step at instants from a twentieth of the record to as much before its end.
pub(in crate::effect) fn sizing(size: &'static Param, instant: &Param, drivers: &Drivers) -> Sizing {
    let at = |share: f64| numbers([(instant.name, drivers.start_s + share * drivers.length_s())]);
    let places = [0.05, 0.1, 0.25, 0.5, 0.75, 0.9, 0.95].map(at);
    Sizing::searched(size, places.into(), 2, trials(drivers.samples))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::cosine::{dct2, inverse_dct2};

    #[test]
    fn the_sample_that_a_step_falls_into_holds_the_share_behind_it() {
        let drivers = Drivers { dt_s: 2.0, samples: 5, ..Drivers::default() };
        // Samples are means over 2 s about 0, 2, 4, ... s: of the one about 4 s a quarter lies behind 4.5 s.
        assert_eq!(step(&drivers, 4.5), [0.0, 0.0, 0.25, 1.0, 1.0]);
        assert_eq!(step(&drivers, -9.0), [1.0; 5]);
        assert_eq!(step(&drivers, 99.0), [0.0; 5]);
    }

    #[test]
    fn the_first_instant_is_that_of_the_only_step() {
        let drivers = Drivers { dt_s: 0.5, samples: 400, averaged: 1, ..Drivers::default() };
        let residual: Vec<f64> = (0..400).map(|i| if i >= 130 { 3.0 } else { 0.0 }).collect();
        let modes = dct2(&residual);
        let powers = vec![0.5; 400];
        let mut weighted: Vec<f64> = modes.iter().zip(&powers).map(|(x, p)| x / p).collect();
        weighted[0] = 0.0;
        let score = inverse_dct2(&weighted);
        let starts = instants(&drivers, &SearchContext { score: &score, modes: &modes, powers: &powers });
        // Between the samples 129 and 130.
        assert!((starts.points[0][0] - 129.5 * 0.5).abs() < 1e-9, "{starts:?}");
        assert!((starts.trials - 400f64.powf(0.75)).abs() < 1e-9);
        let none = SearchContext { score: &[0.0; 400], modes: &[0.0; 400], powers: &powers };
        assert!(instants(&drivers, &none).points.is_empty());
    }
}
