//! Whether the bias followed a temperature that moved during a test at rest.
//!
//! A model of noise takes what follows a temperature for slow noise. Means over a few dozen parts of the recording and a
//! parabola over temperature know nothing of that model.

use super::affected::NOISE_MEASURANDS;
use crate::estimate::{Finding, Holds};
use crate::evidence::{GyroEvidence, Pair};
use crate::message::{Arg, note};
use nalgebra::{DMatrix, DVector};

/// Id of this check.
pub const CHECK_ID: &str = "temperature";
/// Range of temperature of a test at rest from which its bias is looked at, degC.
pub const MIN_RANGE_DEG_C: f64 = 10.0;
/// Parts of the recording that means are taken over.
const PARTS_OF_RECORDING: usize = 48;
/// Fewest means that tell a course over temperature.
const MIN_PARTS: usize = 12;
/// Share of the variance of the means from which the bias counts as following.
const MIN_SHARE: f64 = 0.5;

/// A parabola over temperature through the means.
struct Followed {
    share: f64,
    slope: f64,
    low: f64,
    high: f64,
}

/// Finds the temperature that the bias follows most.
pub(super) fn examine(gyro: &GyroEvidence) -> Vec<Finding> {
    let Some(course) =
        gyro.course.as_ref().filter(|_| gyro.over_temperature.is_none() && gyro.warm_up.is_none())
    else {
        return vec![];
    };
    let found = course.temperatures.iter().filter_map(|(name, temperature)| {
        let followed = followed(&course.beside(temperature, PARTS_OF_RECORDING))?;
        (followed.high - followed.low >= MIN_RANGE_DEG_C && followed.share >= MIN_SHARE)
            .then_some((name, followed))
    });
    let Some((name, followed)) = found.max_by(|a, b| a.1.share.total_cmp(&b.1.share)) else { return vec![] };
    vec![Finding {
        measurands: NOISE_MEASURANDS.into_iter().chain(["static_bias"]).collect(),
        holds: Holds::Nothing,
        found: note!(
            "criticism_found.temperature",
            channel = name.as_str(),
            low = Arg::rounded(followed.low, 3),
            high = Arg::rounded(followed.high, 3),
            percent = Arg::rounded(100.0 * followed.share, 2),
            slope = Arg::rounded(followed.slope, 3)
        ),
        advice: note!("criticism_advice.temperature"),
    }]
}

/// Least squares of a parabola; `None` with too few means or without a range.
fn followed(pairs: &[Pair]) -> Option<Followed> {
    if pairs.len() < MIN_PARTS {
        return None;
    }
    let (low, high) = pairs
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| (l.min(p.temperature), h.max(p.temperature)));
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let x = |p: &Pair| (p.temperature - middle) / half;
    let design = DMatrix::from_fn(pairs.len(), 3, |i, j| pairs.get(i).map_or(0.0, |p| x(p).powi(j as i32)));
    let y = DVector::from_iterator(pairs.len(), pairs.iter().map(|p| p.rate));
    let solution = (design.transpose() * &design).try_inverse()? * (design.transpose() * &y);
    let left = (&y - &design * &solution).norm_squared();
    let whole = y.add_scalar(-y.mean()).norm_squared();
    let share = 1.0 - left / whole;
    let slope = solution.get(1)? / half;
    share.is_finite().then_some(Followed { share, slope, low, high })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bias_that_follows_is_told_from_one_that_does_not() {
        let course = |of: fn(f64, usize) -> f64| -> Vec<Pair> {
            (0..PARTS_OF_RECORDING)
                .map(|i| {
                    let temperature = 30.0 + 20.0 * (i as f64 / 6.0).sin();
                    Pair { temperature, rate: of(temperature, i) }
                })
                .collect()
        };
        let follows = followed(&course(|t, i| 5.0 + 2.0 * t + if i % 2 == 0 { 3.0 } else { -3.0 })).unwrap();
        assert!(follows.share > 0.95 && (follows.slope - 2.0).abs() < 0.2, "{}", follows.share);
        let stays = followed(&course(|_, i| if i % 2 == 0 { 3.0 } else { -3.0 })).unwrap();
        assert!(stays.share < 0.1, "{}", stays.share);
        assert!(followed(&course(|t, _| t)[..5]).is_none());
    }
}
