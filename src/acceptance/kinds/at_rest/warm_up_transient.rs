//! Remainder of a warm-up transient at the start of the evaluated window.
//!
//! A decaying exponential is fitted to some fifty means over the record, for a range of time constants. Its
//! uncertainty is taken under the noise that was identified, correlations included, so that a random walk is not taken
//! for a transient.

use crate::acceptance::condition::WarmUpFact;
use crate::measurand::GyroEvidence;
use nalgebra::{DMatrix, DVector};

/// Means that the record is cut into.
const RECORD_MEANS: usize = 48;
/// Time constants tried, evenly spaced in the logarithm.
const TRIED_TIME_CONSTANTS: usize = 12;

/// The most significant transient of a channel; `None` when the record is too short to say.
pub fn fact(gyro: &GyroEvidence, bias_uncertainty_deg_h: f64) -> Option<WarmUpFact> {
    let blocks = gyro.blocks();
    let merge = blocks.mean.len() / RECORD_MEANS;
    if merge == 0 {
        return None;
    }
    let means: Vec<f64> = blocks
        .mean
        .chunks_exact(merge)
        .take(RECORD_MEANS)
        .map(|c| {
            let present = c.iter().filter(|v| v.is_finite());
            present.clone().sum::<f64>() / present.count() as f64
        })
        .collect();
    if means.iter().any(|m| !m.is_finite()) {
        return None;
    }
    let step_s = merge as f64 * blocks.block_len as f64 * gyro.tau0_s;
    let covariance = covariance(gyro, step_s);
    let factor = covariance.cholesky()?;
    let y = DVector::from_vec(means);
    let mut best: Option<WarmUpFact> = None;
    for trial in 0..TRIED_TIME_CONSTANTS {
        let time_constant_s =
            step_s * 2.0 * (RECORD_MEANS as f64 / 6.0).powf(trial as f64 / (TRIED_TIME_CONSTANTS - 1) as f64);
        let decay = |i: usize| (-(i as f64 + 0.5) * step_s / time_constant_s).exp();
        let design = DMatrix::from_fn(RECORD_MEANS, 2, |i, j| if j == 0 { 1.0 } else { decay(i) });
        let weighted = factor.solve(&design);
        let normal = (design.transpose() * &weighted).try_inverse()?;
        let solution = &normal * (weighted.transpose() * &y);
        let (amplitude, deviation) = (solution[1], normal[(1, 1)].max(0.0).sqrt());
        let significance = if deviation > 0.0 { amplitude.abs() / deviation } else { 0.0 };
        if best.as_ref().is_none_or(|b| significance > b.significance) {
            best = Some(WarmUpFact {
                channel: gyro.channel.clone(),
                residual_deg_h: amplitude,
                time_constant_s,
                significance,
                bias_uncertainty_deg_h,
            });
        }
    }
    best
}

/// Covariance of adjacent means under the identified noise, up to a constant that the fitted mean takes up.
fn covariance(gyro: &GyroEvidence, step_s: f64) -> DMatrix<f64> {
    let model = gyro.identification.allowed.without_ramp();
    let angle = |k: usize| {
        if k == 0 { 0.0 } else { (k as f64).powi(2) * model.mean_variance(k as f64 * step_s, gyro.tau0_s) }
    };
    let lag: Vec<f64> =
        (0..RECORD_MEANS).map(|k| 0.5 * (angle(k + 1) - 2.0 * angle(k) + angle(k.abs_diff(1)))).collect();
    // Flicker and random walk have a variance only up to a constant; one large enough makes the matrix definite and
    // changes nothing once a mean is fitted.
    let lift = lag.iter().fold(0.0f64, |m, v| m.max(v.abs())) * RECORD_MEANS as f64;
    DMatrix::from_fn(RECORD_MEANS, RECORD_MEANS, |i, j| {
        lag[i.abs_diff(j)] + lift + if i == j { 1e-9 * lag[0].abs() } else { 0.0 }
    })
}
