//! Whittle's likelihood of the band powers of an evidence.
//!
//! −2 ln L = Σ dof·(ln s + P/s) up to a constant, where s is the expected power of a band and P its mean power with the
//! ramp taken out. A ramp that is fitted takes a degree of freedom from the noise; the restricted likelihood gives it
//! back by the logarithm of the ramp's information.
//! Source: Whittle, Ark. Mat. 2, 1953; Harville, JASA 72, 1977 (restricted likelihood).

use crate::noise::evidence::{Band, Evidence};

/// Fewest bands that a likelihood is made of.
const MIN_BANDS: usize = 8;

/// What the likelihood needs of one band.
#[derive(Debug, Clone, Copy)]
pub(super) struct BandPower {
    /// Degrees of freedom.
    pub dof: f64,
    /// Mean power, (deg/h)²/Hz.
    pub power: f64,
    /// Cross term with a ramp of 1 deg/h/h.
    pub cross: f64,
    /// Power of a ramp of 1 deg/h/h.
    pub ramp: f64,
}

impl BandPower {
    /// The power left when a ramp of `ramp` deg/h/h is taken out.
    pub fn without_ramp(&self, ramp: f64) -> f64 {
        (self.power - 2.0 * ramp * self.cross + ramp * ramp * self.ramp).max(0.0)
    }
}

/// The bands of an evidence that have a finite power, with their positions; `None` where there is no power or too few
/// bands to say anything.
pub(super) fn usable_bands(evidence: &Evidence) -> Option<(Vec<usize>, Vec<BandPower>)> {
    let usable = |b: &Band| b.power.is_finite() && b.power >= 0.0 && b.dof > 0.0;
    let (used, powers): (Vec<usize>, Vec<BandPower>) = evidence
        .bands
        .iter()
        .enumerate()
        .filter(|(_, b)| usable(b))
        .map(|(i, b)| (i, BandPower { dof: b.dof, power: b.power, cross: b.cross, ramp: b.ramp }))
        .unzip();
    let total: f64 = powers.iter().map(|b| b.dof * b.power).sum();
    (powers.len() >= MIN_BANDS && total > 0.0 && total.is_finite()).then_some((used, powers))
}

/// −2 ln L of bands, each with its expected power, with a ramp of `ramp` deg/h/h; infinite where an expected power is not
/// positive. `restricted`: the ramp is fitted.
pub(super) fn deviance<'a>(
    bands: impl Iterator<Item = (&'a BandPower, f64)> + Clone,
    ramp: f64,
    restricted: bool,
) -> f64 {
    let mut sum = if restricted { ramp_information(bands.clone()).max(f64::MIN_POSITIVE).ln() } else { 0.0 };
    for (band, s) in bands {
        if s <= 0.0 || !s.is_finite() {
            return f64::INFINITY;
        }
        sum += band.dof * (s.ln() + band.without_ramp(ramp) / s);
    }
    sum
}

/// Fisher information of the ramp, (deg/h/h)⁻².
pub(super) fn ramp_information<'a>(bands: impl Iterator<Item = (&'a BandPower, f64)>) -> f64 {
    bands.map(|(band, s)| band.dof * band.ramp / s).sum()
}

/// The ramp of the greatest likelihood at given expected powers, deg/h/h.
pub(super) fn best_ramp<'a>(bands: impl Iterator<Item = (&'a BandPower, f64)>) -> f64 {
    let (mut cross, mut square) = (0.0, 0.0);
    for (band, s) in bands {
        let weight = band.dof / s;
        cross += weight * band.cross;
        square += weight * band.ramp;
    }
    if square > 0.0 { cross / square } else { 0.0 }
}

/// The scale of a term whose expected power for a coefficient of 1 is `column`: the variance with which it alone would
/// make all the power, by a harmonic average that the smallest bands rule. 0 for a term without power.
pub(super) fn starting_variance<'a>(
    bands: impl Iterator<Item = &'a BandPower> + Clone,
    column: impl Iterator<Item = f64>,
) -> f64 {
    let dof: f64 = bands.clone().map(|b| b.dof).sum();
    let mean = bands.clone().map(|b| b.dof * b.power).sum::<f64>() / dof;
    let sum: f64 = bands.zip(column).map(|(b, c)| b.dof * c / (b.power + 1e-9 * mean)).sum();
    if sum > 0.0 { dof / sum } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bands() -> Vec<BandPower> {
        vec![
            BandPower { dof: 1.0, power: 2.0, cross: 1.0, ramp: 4.0 },
            BandPower { dof: 3.0, power: 0.5, cross: -0.5, ramp: 1.0 },
        ]
    }

    #[test]
    fn the_deviance_is_that_of_chi_square_powers() {
        let (bands, s) = (bands(), [2.0, 1.0]);
        let at = |ramp, restricted| deviance(bands.iter().zip(s), ramp, restricted);
        // By hand: 1·(ln 2 + 2/2) + 3·(ln 1 + 0.5/1).
        assert!((at(0.0, false) - (2f64.ln() + 2.5)).abs() < 1e-14);
        // A ramp of 1 takes 2·1 − 4 from the first power, 2·(−0.5) − 1 from the second: 4 and 2.5 are left.
        assert!((at(1.0, false) - (2f64.ln() + 2.0 + 7.5)).abs() < 1e-14);
        // Its information is 4/2 + 3·1/1 = 5.
        assert!((at(0.0, true) - at(0.0, false) - 5f64.ln()).abs() < 1e-14);
        assert_eq!(deviance(bands.iter().zip([1.0, 0.0]), 0.0, false), f64::INFINITY);
    }

    #[test]
    fn the_best_ramp_is_the_minimum_of_the_deviance() {
        let (bands, s) = (bands(), [2.0, 1.0]);
        let best = best_ramp(bands.iter().zip(s));
        // Σ dof·cross/s over Σ dof·ramp/s: (0.5 − 1.5)/5.
        assert!((best + 0.2).abs() < 1e-15);
        let at = |ramp| deviance(bands.iter().zip(s), ramp, false);
        assert!(at(best) < at(best + 1e-3) && at(best) < at(best - 1e-3));
    }

    #[test]
    fn a_start_that_alone_explains_equal_ratios_is_their_ratio() {
        let bands: Vec<BandPower> =
            [1.0, 2.0, 5.0].map(|p| BandPower { dof: 2.0, power: 3.0 * p, cross: 0.0, ramp: 0.0 }).to_vec();
        let start = starting_variance(bands.iter(), [1.0, 2.0, 5.0].into_iter());
        assert!((start - 3.0).abs() < 1e-7, "{start}");
        assert_eq!(starting_variance(bands.iter(), [0.0; 3].into_iter()), 0.0);
    }

    #[test]
    fn a_band_without_power_counts_as_a_billionth_of_the_mean() {
        let bands =
            [(1.0, 0.0), (3.0, 2.0)].map(|(dof, power)| BandPower { dof, power, cross: 0.0, ramp: 0.0 });
        // The mean is (0 + 3·2)/4; 4 degrees of freedom over 1/1.5e-9 and 3/2.
        let start = starting_variance(bands.iter(), [1.0, 1.0].into_iter());
        let expected = 4.0 / (1.0 / 1.5e-9 + 1.5);
        assert!((start / expected - 1.0).abs() < 1e-8, "{start:e} {expected:e}");
    }
}
