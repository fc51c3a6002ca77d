//! A level that changes once: its column, and a search for the instant.

use crate::effect::sizing::numbers;
use crate::effect::{Domain, Drivers, Param, Place, SearchContext, Sizing, Starts};
use crate::numeric::range::Bounds;

/// A step at `at_s` seconds after the first sample, the sample that it falls into averaged.
pub(in crate::effect) fn step(drivers: &Drivers, at_s: f64) -> Vec<f64> {
    let dt = drivers.dt_s;
    drivers.of_time(|t| ((t - at_s) / dt + 0.5).clamp(0.0, 1.0))
}

/// Instants at which a step gains most, s after the first sample; the best first.
pub(in crate::effect) fn instants(drivers: &Drivers, context: &SearchContext<'_>) -> Starts {
    let n = drivers.samples;
    if n < 8 {
        return Starts::none();
    }
    // The gain is (Σ_{i ≥ j} w_i)²/2 over z'C⁻¹z.
    let information = informations(context.powers);
    let mut sum: f64 = 0.0;
    let mut gains = vec![0.0; n];
    for j in (1..n).rev() {
        sum += context.score[j];
        let w = information.get(j.min(n - j)).copied().unwrap_or(0.0);
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

/// Bounds of the instant, s after the first sample: at least one whole sample lies on either side.
pub(in crate::effect) fn instant_bounds(drivers: &Drivers) -> Bounds {
    Bounds::new(0.5 * drivers.dt_s, drivers.length_s() - 1.5 * drivers.dt_s)
}

/// The time around an instant, given in s after the first sample.
pub(in crate::effect) fn around(at_s: f64, drivers: &Drivers) -> Place {
    let at = drivers.start_s + at_s;
    let half = (0.01 * drivers.length_s()).max(2.0 * drivers.dt_s);
    Place { domain: Domain::Time, from: at - half, to: at + half }
}

/// Σ c²/p over the modes c of a unit step from sample j on, for j up to half the record; that of n − j is the same.
///
/// c_k = −√(2/n) sin(πkj/n)/(2 sin(πk/2n)), so that one Fourier transform of 1/(4n sin²(πk/2n) p_k) gives it for every j.
fn informations(powers: &[f64]) -> Vec<f64> {
    let n = powers.len();
    let half_turn = std::f64::consts::PI / (2.0 * n as f64);
    let each = |(k, p): (usize, &f64)| 1.0 / (4.0 * n as f64 * (half_turn * k as f64).sin().powi(2) * p);
    let mut of_modes = vec![0.0];
    of_modes.extend(powers.iter().enumerate().skip(1).map(each));
    let forward = sagnac_fft::real_forward(n);
    let mut sums = forward.make_output_vec();
    if forward.process(&mut of_modes, &mut sums).is_err() {
        return vec![];
    }
    let all = sums.first().map_or(0.0, |s| s.re);
    sums.iter().map(|s| all - s.re).collect()
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
    fn the_information_of_a_step_is_that_of_its_modes() {
        for n in [8usize, 33, 500] {
            let powers: Vec<f64> =
                (0..n).map(|k| if k == 0 { f64::INFINITY } else { 0.1 + 30.0 / k as f64 }).collect();
            let fast = informations(&powers);
            for j in 1..n {
                let column: Vec<f64> = (0..n).map(|i| if i >= j { 1.0 } else { 0.0 }).collect();
                let direct: f64 = dct2(&column).iter().zip(&powers).map(|(c, p)| c * c / p).sum();
                assert!((fast[j.min(n - j)] / direct - 1.0).abs() < 1e-9, "{j} of {n}");
            }
        }
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
