//! Whether the slow part of a record was taken out before it was delivered: by a polynomial, by a filter, by a unit that
//! removes its own bias.
//!
//! A polynomial that was fitted and subtracted leaves a record square to every power of time up to its degree, which noise is
//! by chance only. A filter leaves less power at the lowest frequencies than any noise of a gyro has. Either
//! way random walk and flicker look smaller than they are.

use super::affected::{NOISE_MEASURANDS, SLOW_NOISE};
use crate::estimate::{Finding, Holds, normal_probability};
use crate::evidence::{Course, GyroEvidence};
use crate::message::{Arg, note};
use crate::noise::identification::misfit::normal_score;

/// Highest degree of a polynomial that is looked for.
const MAX_DEGREE: usize = 6;
/// Fewest values that tell.
const MIN_VALUES: usize = 64;
/// Probability, over all degrees, below which chance is no explanation of a record square to polynomials.
const POLYNOMIAL_CHANCE: f64 = 1e-3;
/// The same of empty frequencies.
const EMPTY_CHANCE: f64 = 1e-4;
/// Values of which group means are taken, at least.
const MIN_GROUPS: usize = 32;
/// Doublings of the averaging time over which the level of white noise may not fall.
const DOUBLINGS_TO_FALL: usize = 3;
/// Ratio of levels over these doublings below which the level falls: differences of white noise give 0.35, white noise 1.
const MAX_FALL: f64 = 0.6;
/// Power over that of the model below which the lowest frequencies are empty.
const MAX_RATIO: f64 = 0.5;
/// Share of the frequencies that an empty part reaches up to at most without a doubt about the white noise.
const MAX_SHARE_BELOW_WHITE: f64 = 0.01;

/// Everything that rests on the course of the bias over temperature.
const OVER_TEMPERATURE: [&str; 11] = [
    "bias_temperature_sensitivity",
    "bias_temperature_sensitivity_max",
    "bias_temperature_rate_sensitivity",
    "thermal_lag",
    "thermal_hysteresis",
    "bias_over_temperature_peak_to_peak",
    "bias_over_temperature_rms",
    "bias_over_temperature_3sigma",
    "bias_loop_width",
    "bias_residual_rms",
    "static_bias",
];

/// Finds what was taken out.
pub(super) fn examine(gyro: &GyroEvidence) -> Vec<Finding> {
    if gyro.over_temperature.is_some() {
        return over_temperature(gyro).into_iter().collect();
    }
    if gyro.warm_up.is_some() || gyro.motion.is_motion() {
        return vec![];
    }
    polynomial(gyro).into_iter().chain(hole(gyro)).collect()
}

/// Temperature and its rate without their means about each instant, which describe the record better than the unit's model.
fn over_temperature(gyro: &GyroEvidence) -> Option<Finding> {
    let found = gyro.over_temperature.as_ref()?.analysis.as_ref()?.removed?;
    Some(Finding {
        measurands: OVER_TEMPERATURE.to_vec(),
        holds: Holds::Nothing,
        found: note!(
            "criticism_found.removed_over_temperature",
            width_min = Arg::figures(found.width_s / 60.0, 2),
            percent = Arg::figures(100.0 * found.left, 2)
        ),
        advice: note!("criticism_advice.slow_part_removed"),
    })
}

/// The degree of a polynomial that the record is square to.
fn polynomial(gyro: &GyroEvidence) -> Option<Finding> {
    let blocks = || gyro.blocks().about_first();
    let of_course = |c: &Course| c.rate.bins.iter().map(|b| b.mean).collect();
    let values: Vec<f64> = gyro.course.as_ref().map_or_else(blocks, of_course);
    let degree = removed_degree(&values)?;
    Some(Finding {
        measurands: SLOW_NOISE.to_vec(),
        holds: Holds::Nothing,
        found: note!("criticism_found.polynomial", degree),
        advice: note!("criticism_advice.slow_part_removed"),
    })
}

/// The highest degree such that the projections on the polynomials up to it are far smaller than white noise of the same
/// scatter makes them; at least 1.
fn removed_degree(values: &[f64]) -> Option<usize> {
    let n = values.len();
    if n < MIN_VALUES || values.iter().any(|v| !v.is_finite()) {
        return None;
    }
    let scatter = white_scatter(values)?;
    let position = |i: usize| (2.0 * i as f64 + 1.0) / n as f64 - 1.0;
    let mut square: Vec<Vec<f64>> = vec![];
    let (mut largest, mut found) = (0.0f64, None);
    for degree in 0..=MAX_DEGREE {
        let mut power: Vec<f64> = (0..n).map(|i| position(i).powi(degree as i32)).collect();
        for known in &square {
            let along: f64 = known.iter().zip(&power).map(|(a, b)| a * b).sum();
            power.iter_mut().zip(known).for_each(|(p, k)| *p -= along * k);
        }
        let length = power.iter().map(|p| p * p).sum::<f64>().sqrt();
        power.iter_mut().for_each(|p| *p /= length);
        if degree > 0 {
            let along: f64 = power.iter().zip(values).map(|(p, v)| p * v).sum();
            largest = largest.max((along / scatter).abs());
            // √(2/π) z is the probability of a normal deviate within ± z, for a small z.
            let chance = MAX_DEGREE as f64 * (0.8 * largest).powi(degree as i32);
            if chance < POLYNOMIAL_CHANCE {
                found = Some(degree);
            }
        }
        square.push(power);
    }
    found.filter(|_| scatter > 0.0)
}

/// Deviation of single values as white noise of the lowest level seen at any averaging time. Noise that is less at long times than
/// white, such as that of rounding, is square to polynomials by itself: `None` where the level still falls at the longest times.
fn white_scatter(values: &[f64]) -> Option<f64> {
    let of_groups = |size: usize| {
        let means: Vec<f64> =
            values.chunks_exact(size).map(|group| group.iter().sum::<f64>() / size as f64).collect();
        let changes = means.iter().zip(means.get(1..).unwrap_or_default()).map(|(a, b)| (b - a).powi(2));
        (0.5 * size as f64 * changes.sum::<f64>() / (means.len() - 1) as f64).sqrt()
    };
    let sizes = (0..).map(|k| 1usize << k).take_while(|size| values.len() / size >= MIN_GROUPS);
    let levels: Vec<f64> = sizes.map(of_groups).collect();
    let last = *levels.last()?;
    let earlier = levels.len().checked_sub(1 + DOUBLINGS_TO_FALL).and_then(|at| levels.get(at));
    let still_falls = earlier.is_some_and(|earlier| last < MAX_FALL * earlier);
    (!still_falls).then(|| levels.into_iter().fold(f64::INFINITY, f64::min))
}

/// The lowest frequencies where less power is than the model has.
fn hole(gyro: &GyroEvidence) -> Option<Finding> {
    let highest_hz = gyro.identification.highest_hz.unwrap_or(f64::INFINITY);
    let bands = &gyro.goodness.bands;
    let (mut sum, mut dof) = (0.0, 0.0);
    let mut found = None;
    for band in bands.iter().filter(|b| b.high_hz <= highest_hz) {
        (sum, dof) = (sum + band.ratio * band.dof, dof + band.dof);
        let chance = bands.len() as f64 * normal_probability(normal_score(sum, dof));
        if sum >= MAX_RATIO * dof {
            break;
        }
        if chance < EMPTY_CHANCE {
            found = Some((band.high_hz, sum / dof));
        }
    }
    let (to_hz, ratio) = found?;
    let nyquist_hz = 0.5 / gyro.tau0_s;
    let slow_alone = to_hz < MAX_SHARE_BELOW_WHITE * nyquist_hz;
    Some(Finding {
        measurands: if slow_alone {
            SLOW_NOISE.to_vec()
        } else {
            NOISE_MEASURANDS.into_iter().chain(["static_bias"]).collect()
        },
        holds: Holds::Nothing,
        found: note!("criticism_found.hole", to_hz = Arg::rounded(to_hz, 2), ratio = Arg::rounded(ratio, 2)),
        advice: note!("criticism_advice.slow_part_removed"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_xoshiro::Xoshiro256PlusPlus;

    fn white(seed: u64) -> Vec<f64> {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        (0..1500).map(|_| StandardNormal.sample(&mut rng)).collect()
    }

    #[test]
    fn a_polynomial_that_was_taken_out_is_found_and_noise_has_none() {
        let by_chance = (0..500).filter(|seed| removed_degree(&white(*seed)).is_some()).count();
        assert!(by_chance <= 3, "{by_chance} of 500 where half of one is expected");
        let of_rounding: Vec<f64> = white(9).windows(2).map(|w| w[1] - w[0]).collect();
        assert_eq!(removed_degree(&of_rounding), None);
        for degree in [1, 2, 3, 5] {
            let mut values = white(1000 + degree as u64);
            let n = values.len();
            let x = nalgebra::DMatrix::from_fn(n, degree + 1, |i, j| (i as f64 / n as f64).powi(j as i32));
            let y = nalgebra::DVector::from_vec(values.clone());
            let fitted = &x * ((x.transpose() * &x).try_inverse().unwrap() * (x.transpose() * &y));
            values.iter_mut().zip(fitted.iter()).for_each(|(v, f)| *v = ((*v - f) * 1e4).round() / 1e4);
            assert_eq!(removed_degree(&values), Some(degree), "{degree}");
        }
    }
}
