//! How well a model fits: whitened band powers against their χ² law.

use crate::estimate::normal_probability;
use crate::noise::evidence::Evidence;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Degrees of freedom that a test band holds at least.
const BAND_DOF: f64 = 12.0;
/// Test bands per octave at most.
const PER_OCTAVE: f64 = 6.0;

/// A band set against a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WhitenedBand {
    /// Power over the expected one.
    pub ratio: f64,
    /// Degrees of freedom.
    pub dof: f64,
}

/// Result of the test of fit of a model to band powers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Misfit {
    /// Mean square of the normal scores of the test bands, corrected for fitted coefficients: 1 when the model fits.
    pub per_dof: f64,
    /// Probability of a larger one if the model is right.
    pub probability: f64,
    /// The band that stands out most, Hz.
    pub worst_band_hz: Option<[f64; 2]>,
    /// Power over model in that band.
    pub worst_excess: f64,
    /// Probability that any band stands out as much, number of bands counted, if the model is right.
    pub worst_probability: f64,
}

impl Misfit {
    /// The result where there is nothing to test: no misfit, probability 1.
    pub fn none() -> Misfit {
        Misfit {
            per_dof: 0.0,
            probability: 1.0,
            worst_band_hz: None,
            worst_excess: 1.0,
            worst_probability: 1.0,
        }
    }

    /// Tests the whitened bands of an evidence, of a model with `fitted` parameters.
    pub fn of(evidence: &Evidence, whitened: &[WhitenedBand], fitted: usize) -> Misfit {
        struct Test {
            low: f64,
            high: f64,
            dof: f64,
            sum: f64,
        }
        let mut tests: Vec<Test> = vec![];
        let width = 2f64.powf(1.0 / PER_OCTAVE);
        for (band, WhitenedBand { ratio, dof }) in evidence.bands.iter().zip(whitened) {
            match tests.last_mut() {
                Some(t) if t.dof < BAND_DOF || band.high_hz < t.low * width => {
                    t.high = t.high.max(band.high_hz);
                    t.dof += dof;
                    t.sum += dof * ratio;
                }
                _ => tests.push(Test { low: band.low_hz, high: band.high_hz, dof: *dof, sum: dof * ratio }),
            }
        }
        if tests.len() <= fitted {
            return Misfit::none();
        }
        let scores: Vec<f64> = tests.iter().map(|t| normal_score(t.sum, t.dof)).collect();
        let square: f64 = scores.iter().map(|z| z * z).sum();
        let free = (tests.len() - fitted) as f64;
        let mut worst = 0;
        for (i, z) in scores.iter().enumerate() {
            if z.abs() > scores[worst].abs() {
                worst = i;
            }
        }
        let single = 2.0 * normal_probability(-scores[worst].abs());
        // Far out the tail is nothing at all, and its series takes long to say so.
        let hopeless = square > 1000.0 + 20.0 * free;
        let survives = if hopeless { 0.0 } else { ChiSquared::new(free).map_or(f64::NAN, |d| d.sf(square)) };
        Misfit {
            per_dof: square / free,
            probability: survives,
            worst_band_hz: Some([tests[worst].low, tests[worst].high]),
            worst_excess: tests[worst].sum / tests[worst].dof,
            worst_probability: -(tests.len() as f64 * (-single).ln_1p()).exp_m1(),
        }
    }
}

/// Normal score of a χ² sum by the cube root (Wilson and Hilferty 1931).
pub fn normal_score(sum: f64, dof: f64) -> f64 {
    let spread = 2.0 / (9.0 * dof);
    ((sum / dof).cbrt() - (1.0 - spread)) / spread.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::model::NoiseModel;

    #[test]
    fn a_raised_band_is_found_and_a_fitting_model_is_left_alone() {
        let evidence = Evidence::expected(&NoiseModel { n: 0.002, ..Default::default() }, 36_000, 1.0);
        let mut whitened: Vec<WhitenedBand> =
            evidence.bands.iter().map(|b| WhitenedBand { ratio: 1.0, dof: b.dof }).collect();
        let clean = Misfit::of(&evidence, &whitened, 1);
        assert!(clean.probability > 0.99 && clean.worst_probability > 0.5, "{clean:?}");
        let raised = evidence.bands.iter().position(|b| b.low_hz > 0.1).unwrap();
        whitened[raised].ratio = 2.0;
        let found = Misfit::of(&evidence, &whitened, 1);
        let [low, high] = found.worst_band_hz.unwrap();
        assert!(low <= evidence.bands[raised].low_hz && evidence.bands[raised].high_hz <= high);
        assert!(found.worst_probability < 1e-3 && found.worst_excess > 1.1, "{found:?}");
    }

    #[test]
    fn normal_scores_follow_the_quantiles_of_chi_square() {
        // 95 % points of χ²: 21.026 at 12, 124.342 at 100 degrees of freedom.
        for (sum, dof) in [(21.026, 12.0), (124.342, 100.0)] {
            assert!((normal_score(sum, dof) - 1.6449).abs() < 0.01);
        }
    }
}
