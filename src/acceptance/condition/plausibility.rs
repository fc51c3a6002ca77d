//! Plausibility of a unit of its family: the bias that it may have against the Earth rate, and the noise that it
//! may have against the typical one. Both tell a wrong unit or sign from a bad unit.

use super::facts::{Facts, GyroFact};
use crate::config::procedure::model::EarthRate as Removal;
use crate::measurand;

/// How many times the bound of the bias the Earth rate must be.
pub(super) const MIN_EARTH_TO_BIAS: f64 = 5.0;
/// Times the typical bias that a unit is still thought to have.
pub(super) const TYPICAL_BIAS_FACTOR: f64 = 3.0;
/// Ratio beyond which a unit is not merely bad.
pub(super) const NOISE_RATIO_LIMIT: f64 = 20.0;

/// Largest bias that a unit is thought to have, deg/h.
pub(super) fn largest_plausible_bias(gyro: &GyroFact, facts: &Facts<'_>) -> Option<f64> {
    if earth_rate_is_kept(facts) {
        return None;
    }
    let bound = facts
        .limits
        .limit(measurand::STATIC_BIAS.id, &gyro.channel)
        .and_then(|l| l.limit.largest_magnitude());
    let typical = || facts.limits.expected(measurand::STATIC_BIAS.id).map(|e| TYPICAL_BIAS_FACTOR * e.abs());
    bound.or_else(typical).filter(|b| *b > 0.0)
}

/// Whether the mean shows the Earth rate; `None` where that cannot be judged.
pub(super) fn mean_shows_earth_rate(gyro: &GyroFact, facts: &Facts<'_>) -> Option<bool> {
    let (earth, u_earth) = gyro.earth_deg_h?;
    let bound = largest_plausible_bias(gyro, facts).filter(|b| earth.abs() >= MIN_EARTH_TO_BIAS * b)?;
    let u = gyro.mean_uncertainty_deg_h.hypot(u_earth);
    Some((gyro.mean_deg_h - earth).abs() <= 2.0 * bound + 3.0 * u)
}

/// Whether the procedure states the bias with the Earth rate in it.
pub(super) fn earth_rate_is_kept(facts: &Facts<'_>) -> bool {
    let mut measurands = facts.procedure.measurands.iter();
    measurands.any(|m| m.measurand.id == measurand::STATIC_BIAS.id && m.earth_rate == Removal::Keep)
}

/// Least and greatest σ(τ)·√τ/60 over octaves, deg/sqrt(h).
pub(super) fn white_noise_range(gyro: &GyroFact) -> Option<(f64, f64)> {
    let longest_s = (gyro.longest_stretch_s / 20.0).max(gyro.tau0_s);
    let levels = gyro
        .deviations
        .iter()
        .filter(|(tau_s, deviation)| *tau_s <= longest_s * 1.000_001 && deviation.is_finite())
        .map(|(tau_s, deviation)| deviation * tau_s.sqrt() / 60.0);
    let range = levels.fold((f64::INFINITY, 0.0f64), |(low, high), n| (low.min(n), high.max(n)));
    range.0.is_finite().then_some(range)
}

/// Whether the noise would be far from that of the family if the values were multiplied by a factor.
pub(super) fn noise_is_implausible(gyro: &GyroFact, factor: f64, facts: &Facts<'_>) -> bool {
    let typical = facts.limits.expected(measurand::ANGLE_RANDOM_WALK.id).filter(|n| *n > 0.0);
    typical.zip(white_noise_range(gyro)).is_some_and(|(typical, (low, high))| {
        let factor = factor.abs();
        low * factor > NOISE_RATIO_LIMIT * typical || high * factor * NOISE_RATIO_LIMIT < typical
    })
}
