//! Deviations of a simulated rate from the mean that the claim expects, made larger or smaller.

use crate::effect::Drivers;

/// Multiplies the deviations from the claimed mean, bias included, by `factor` of each sample.
pub(in crate::effect) fn scale(drivers: &Drivers, rate: &mut [f64], factor: impl Fn(usize) -> f64) {
    let bias = drivers.claim.bias_deg_h;
    for (i, (y, m)) in rate.iter_mut().zip(drivers.claimed_mean()).enumerate() {
        *y = m + bias + (*y - m - bias) * factor(i);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deviations_from_the_claimed_mean_are_scaled_and_the_mean_stays() {
        let claim = crate::effect::ClaimedMean { bias_deg_h: 2.0, ..Default::default() };
        let drivers =
            Drivers { samples: 3, table_rate: Some(vec![0.0, 0.001, 0.001]), claim, ..Drivers::default() };
        let mut rate = vec![3.0, 5.6, 4.6];
        scale(&drivers, &mut rate, |i| [2.0, 2.0, 0.5][i]);
        for (got, expected) in rate.iter().zip([4.0, 5.6, 5.1]) {
            assert!((got - expected).abs() < 1e-12, "{rate:?}");
        }
    }
}
