//! White noise in zones of temperature, from second differences of short means, which no steady ramp moves.
//!
//! Flicker and a random walk move them as well, and by more the longer the means are. What they add is taken from the fit
//! over the whole recording, with what is not known of it, and taken out.

use super::read::{self, Reading};
use super::sampler::Draw;
use super::test::TemperatureTest;
use super::track::Means;
use crate::estimate::{chi_square_tail, normal_quantile};
use crate::numeric::order::SortByNumber;

/// Second differences that a zone needs.
const MIN_DIFFERENCES: usize = 30;
/// Samples in a mean at least where the sample rate allows: filters act on fewer.
const MIN_SAMPLES: u64 = 8;
/// Shortest and longest mean aimed at, s.
const LENGTH_S: (f64, f64) = (1.0, 10.0);
/// States of the slow noise that its spread is counted with.
const SPREAD_STATES: usize = 32;
/// Share of the distribution without white noise from which none is claimed.
const MAX_ABSENT_SHARE: f64 = 0.05;
/// Deviation of the logarithm of B up to which it is seen; beyond, draws alone say what it may be.
const MAX_LOG_DEVIATION: f64 = 0.5;
/// Lags of second differences that are counted as correlated.
const CORRELATED_LAGS: usize = 12;
/// Correlation of neighbouring second differences beyond that of the noise from which the output was smoothed: so much, and so many
/// of its deviations.
const SMOOTHED_CORRELATION: f64 = 0.08;
const SMOOTHED_DEVIATIONS: f64 = 5.0;
/// Deviation of that correlation times the root of the number of second differences: less than this for white noise.
const DEVIATION_OF_CORRELATION: f64 = 0.6;

/// White noise in one zone of temperature.
#[derive(Debug, Clone, PartialEq)]
pub struct Zone {
    /// Middle of the zone, degC.
    pub deg_c: f64,
    /// N, deg/sqrt(h); `None` where the record holds too little there.
    pub n: Option<Reading>,
    /// True when slow noise explains the zone as well: `n` is only a distribution to be bounded from.
    pub by_slow_noise: bool,
    /// Share of slow noise in the square that was observed.
    pub slow_share: f64,
    /// Length of the means, s.
    pub average_s: f64,
    /// Second differences.
    pub count: usize,
    /// True where the output was smoothed over more than one mean, as all zones together show: their level is not that of the white
    /// noise.
    pub smoothed: bool,
}

/// Covariance over a lag of second differences of neighbouring means, from that of the means over lags.
fn of_seconds(means: impl Fn(i32) -> f64, lag: i32) -> f64 {
    [1.0, -4.0, 6.0, -4.0, 1.0].iter().zip(-2..).map(|(w, k)| w * means(lag + k)).sum()
}

/// Covariances of second differences of neighbouring means, by lag: for white noise of variance 1 of a mean,
/// flicker of B = 1, and a random walk of K²τ = 1.
fn covariances() -> Vec<[f64; 3]> {
    let white = |k: i32| if k == 0 { 1.0 } else { 0.0 };
    // −ln|t|/π and −|t|/2 averaged over both means: second differences of their second integrals.
    let twice =
        |h: fn(f64) -> f64| move |k: i32| h(f64::from(k + 1)) - 2.0 * h(f64::from(k)) + h(f64::from(k - 1));
    let flicker = twice(|t| if t == 0.0 { 0.0 } else { -t * t * t.abs().ln() / std::f64::consts::TAU });
    let walk = twice(|t| -t.abs().powi(3) / 12.0);
    (0..=CORRELATED_LAGS as i32)
        .map(|j| [of_seconds(white, j), of_seconds(flicker, j), of_seconds(walk, j)])
        .collect()
}

/// N with its spread: the variance of a mean that `count` second differences show (`seen`), less what slow noise adds to it
/// by each of its states. Gives the share without white noise as well.
fn white(seen: f64, count: usize, states: &[[f64; 2]], average_h: f64) -> (Reading, f64) {
    let shapes = covariances();
    // Degrees of freedom of the mean of the squares, with the noise as it was seen.
    let parts: Vec<(f64, f64)> = states
        .iter()
        .map(|[b, k]| {
            let terms = [b * b, k * k * average_h];
            let slow = (terms[0] * shapes[0][1] + terms[1] * shapes[0][2]) / shapes[0][0];
            let level = (seen - slow).max(0.0);
            let at = |c: &[f64; 3]| level * c[0] + terms[0] * c[1] + terms[1] * c[2];
            let correlated: f64 = shapes.iter().skip(1).map(|c| (at(c) / at(&shapes[0])).powi(2)).sum();
            (slow, count as f64 / (1.0 + 2.0 * correlated))
        })
        .collect();
    // The variance of a mean is less than v where χ² is more than ν·seen/v.
    let below = |n: f64| {
        let one = |(slow, dof): &(f64, f64)| {
            let v = n * n / average_h + slow;
            if v > 0.0 { chi_square_tail(dof * seen / v, *dof) } else { 0.0 }
        };
        parts.iter().map(one).sum::<f64>() / parts.len().max(1) as f64
    };
    (read::of_distribution(below, (0.0, 3.0 * (seen * average_h).sqrt())), below(0.0))
}

/// States of B and K that stand for all drawn ones: every so many of those in the order of what they add. Draws hold N where
/// the fit has it; what B takes from not knowing N is `log_deviation`, that of its logarithm with N free, beyond that of the
/// draws.
fn states_of(draws: &[Draw], log_deviation: f64, average_h: f64) -> Vec<[f64; 2]> {
    let shape = covariances()[0];
    let added = |s: &[f64; 2]| s[0] * s[0] * shape[1] + s[1] * s[1] * average_h * shape[2];
    let mut all: Vec<[f64; 2]> = draws.iter().map(|d| [d.noise[1], d.noise[2]]).collect();
    all.sort_ascending_by(|a| added(a));
    if all.is_empty() {
        return vec![[0.0; 2]];
    }
    let mean = all.iter().map(|s| s[0]).sum::<f64>() / all.len() as f64;
    let drawn = all.iter().map(|s| (s[0] - mean).powi(2)).sum::<f64>() / all.len() as f64 / (mean * mean);
    let seen = log_deviation < MAX_LOG_DEVIATION && drawn < MAX_LOG_DEVIATION * MAX_LOG_DEVIATION;
    let further = if seen { (log_deviation.powi(2) - drawn).max(0.0).sqrt() } else { 0.0 };
    let count = SPREAD_STATES.min(all.len());
    (0..count)
        .map(|i| {
            let [b, k] = all[(2 * i + 1) * all.len() / (2 * count)];
            // Every place once, in an order that has nothing to do with that of the states.
            let place = (11 * i + 5) % count;
            let z = normal_quantile((place as f64 + 0.5) / count as f64);
            [b * (further * z).exp(), k]
        })
        .collect()
}

/// Correlation of neighbouring second differences that white noise of a level has beside slow noise.
fn correlation(level: f64, [b, k]: [f64; 2], average_h: f64) -> f64 {
    let shapes = covariances();
    let at = |c: &[f64; 3]| level * c[0] + b * b * c[1] + k * k * average_h * c[2];
    at(&shapes[1]) / at(&shapes[0])
}

/// The zones that are asked for; `draws` hold the slow noise of the whole recording, and B has the deviation of its logarithm
/// given.
pub fn zones(
    means: &Means,
    (rate, temperature): (usize, usize),
    (draws, log_deviation): (&[Draw], f64),
    test: &TemperatureTest,
) -> Vec<Zone> {
    let by_samples = MIN_SAMPLES.div_ceil(means.samples) as usize;
    let by_length = (LENGTH_S.0 / means.block_s).ceil() as usize;
    let longest = ((LENGTH_S.1 / means.block_s) as usize).max(1);
    let short = means.merged(by_samples.max(by_length).clamp(1, longest));
    let (Some(y), Some(t)) = (short.values.get(rate), short.values.get(temperature)) else { return vec![] };
    let centres = &test.zones_deg_c;
    let zone_of = |deg_c: f64| {
        let nearest = centres.iter().enumerate().min_by(|a, b| {
            let off = |c: &f64| (c - deg_c).abs();
            off(a.1).total_cmp(&off(b.1))
        });
        nearest.map(|(i, _)| i)
    };
    let mut sums = vec![(0.0, 0usize); centres.len()];
    let (mut products, mut pairs, mut before) = (0.0, 0usize, None);
    for (w, t) in y.windows(3).zip(t.windows(3)) {
        let second = w[2] - 2.0 * w[1] + w[0];
        let mut kept = None;
        if let Some(zone) = zone_of(t[1]).filter(|_| second.is_finite() && t[1].is_finite()) {
            // A zone reaches half way to its neighbours, and as far beyond the outermost.
            let gap = centres
                .iter()
                .enumerate()
                .filter(|(i, _)| *i != zone)
                .map(|(_, c)| (c - centres[zone]).abs())
                .fold(f64::INFINITY, f64::min);
            if (t[1] - centres[zone]).abs() <= 0.5 * gap.min(50.0) {
                sums[zone].0 += second * second;
                sums[zone].1 += 1;
                kept = Some(second);
                if let Some(before) = before {
                    products += before * second;
                    pairs += 1;
                }
            }
        }
        before = kept;
    }
    let average_h = short.block_s / 3600.0;
    let states = states_of(draws, log_deviation, average_h);
    let (squares, counted) = sums.iter().fold((0.0, 0), |(s, n), zone| (s + zone.0, n + zone.1));
    let smoothed = pairs >= MIN_DIFFERENCES && squares > 0.0 && {
        let seen = squares / (6.0 * counted as f64);
        let expected = |state: &[f64; 2]| {
            let slow = correlation(0.0, *state, average_h).max(correlation(1.0, [0.0; 2], average_h));
            let level = seen - (state[0].powi(2) * covariances()[0][1] + state[1].powi(2) * average_h) / 6.0;
            if level > 0.0 { correlation(level, *state, average_h) } else { slow }
        };
        let most = states.iter().map(expected).fold(f64::NEG_INFINITY, f64::max);
        let found = products / pairs as f64 / (squares / counted as f64);
        let by_chance = SMOOTHED_DEVIATIONS * DEVIATION_OF_CORRELATION / (pairs as f64).sqrt();
        found - most > by_chance.max(SMOOTHED_CORRELATION)
    };
    centres
        .iter()
        .zip(sums)
        .map(|(&deg_c, (sum, count))| {
            // White means of variance σ² have second differences of 6 σ².
            let seen = sum / (6.0 * count.max(1) as f64);
            let found =
                (count >= MIN_DIFFERENCES && seen > 0.0).then(|| white(seen, count, &states, average_h));
            Zone {
                deg_c,
                by_slow_noise: found.as_ref().is_some_and(|f| f.1 > MAX_ABSENT_SHARE),
                slow_share: found
                    .as_ref()
                    .map_or(0.0, |f| (1.0 - f.0.value * f.0.value / average_h / seen).clamp(0.0, 1.0)),
                n: found.map(|f| f.0),
                average_s: short.block_s,
                count,
                smoothed,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_noise_adds_to_second_differences_what_closed_forms_say() {
        let shapes = covariances();
        // Var(y₂ − 2y₁ + y₀) = 6 for white noise; (24 ln 2 − 9 ln 3)/π for flicker; 1 for a random walk.
        let flicker = (24.0 * 2f64.ln() - 9.0 * 3f64.ln()) / std::f64::consts::PI;
        assert!((shapes[0][0] - 6.0).abs() < 1e-12 && (shapes[0][2] - 1.0).abs() < 1e-9, "{:?}", shapes[0]);
        assert!((shapes[0][1] - flicker).abs() < 1e-9, "{:?}", shapes[0]);
        // White ones are correlated by −4/6 and 1/6.
        assert!((shapes[1][0] + 4.0).abs() < 1e-12 && (shapes[2][0] - 1.0).abs() < 1e-12);
    }

    #[test]
    fn what_flicker_adds_is_taken_out_and_widens_the_interval() {
        let average_h = 8.0 / 3600.0;
        let width = |r: &Reading| {
            let i = r.spread.interval(r.value, 0.95).unwrap();
            (i.high - i.low) / r.value
        };
        // N = 0.15, B = 5 over 8 s: nearly half of the square is flicker.
        let flicker = 25.0 * covariances()[0][1] / 6.0;
        let seen = 0.15f64.powi(2) / average_h + flicker;
        let (found, none) = white(seen, 1000, &[[5.0, 0.0]], average_h);
        assert!((found.value / 0.15 - 1.0).abs() < 0.01 && none < 1e-6, "{found:?}");
        let (alone, _) = white(0.15f64.powi(2) / average_h, 1000, &[[0.0, 0.0]], average_h);
        assert!((alone.value / 0.15 - 1.0).abs() < 0.01);
        assert!(width(&found) > 1.5 * width(&alone), "{} {}", width(&found), width(&alone));
        // What B takes from not knowing N beyond its draws.
        let draw = Draw {
            shape: vec![],
            noise: [0.15, 5.0, 0.0],
            coefficients: nalgebra::DVector::zeros(0),
            covariance: nalgebra::DMatrix::zeros(0, 0),
        };
        let states = states_of(&vec![draw; 64], 0.1, average_h);
        let mean = states.iter().map(|s| s[0].ln()).sum::<f64>() / states.len() as f64;
        let square = states.iter().map(|s| (s[0].ln() - mean).powi(2)).sum::<f64>() / states.len() as f64;
        assert!((mean - 5f64.ln()).abs() < 1e-9 && (square.sqrt() / 0.1 - 1.0).abs() < 0.05, "{square}");
        let (unsure, _) = white(seen, 1000, &states, average_h);
        assert!(width(&unsure) > 1.5 * width(&found), "{} {}", width(&unsure), width(&found));
        // Where flicker explains all of it, nothing is left that could be claimed.
        let (_, none) = white(flicker, 1000, &[[5.0, 0.0]], average_h);
        assert!(none > 0.4, "{none}");
    }
}
