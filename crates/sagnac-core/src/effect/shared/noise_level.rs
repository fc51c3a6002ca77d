//! Deviations of a simulated rate from the mean that the claim expects, made larger or smaller.

use crate::effect::Drivers;

/// Multiplies the deviations from the claimed mean, bias included, by `factor` of each sample.
pub(in crate::effect) fn scale(drivers: &Drivers, rate: &mut [f64], factor: impl Fn(usize) -> f64) {
    let bias = drivers.claim.bias_deg_h;
    for (i, (y, m)) in rate.iter_mut().zip(drivers.claimed_mean()).enumerate() {
        *y = m + bias + (*y - m - bias) * factor(i);
    }
}
