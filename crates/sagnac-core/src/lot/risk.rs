//! Risks of judging a unit of a population by a measured value (JCGM 106:2012, clause 9): global consumer's and producer's risk
//! under the rule that a value at or below the limit is accepted.

use crate::estimate::normal_probability;

/// Points of the quadrature over the true value.
const QUADRATURE_POINTS: u32 = 800;
/// Deviations of the population that it reaches to.
const REACH_DEVIATIONS: f64 = 8.0;

/// A population and a test, on the scale on which both are normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Judged {
    /// Mean of the true values.
    pub mean: f64,
    /// Deviation of the true values.
    pub units: f64,
    /// Deviation of the measurement.
    pub measurement: f64,
}

/// Probabilities of the two wrong decisions, over the units of the population.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Risk {
    /// A unit is accepted whose true value lies above the limit.
    pub consumer: f64,
    /// A unit is rejected whose true value lies at or below the limit.
    pub producer: f64,
}

impl Judged {
    /// The risks under an upper limit; `None` where a deviation is not positive.
    pub fn upper(self, limit: f64) -> Option<Risk> {
        let Judged { mean, units, measurement } = self;
        if !(units > 0.0 && measurement > 0.0 && limit.is_finite() && mean.is_finite()) {
            return None;
        }
        let at = (limit - mean) / units;
        // Over true values beyond the limit, the probability that the value falls below it, and the other way round.
        let accepted = |z: f64| normal_probability((limit - mean - z * units) / measurement);
        let density = |z: f64| (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt();
        let consumer =
            integral(at.max(-REACH_DEVIATIONS), at.max(-REACH_DEVIATIONS).max(0.0) + REACH_DEVIATIONS, |z| {
                density(z) * accepted(z)
            });
        let producer =
            integral(at.min(REACH_DEVIATIONS).min(0.0) - REACH_DEVIATIONS, at.min(REACH_DEVIATIONS), |z| {
                density(z) * (1.0 - accepted(z))
            });
        Some(Risk { consumer, producer })
    }
}

/// Simpson's rule.
fn integral(from: f64, to: f64, of: impl Fn(f64) -> f64) -> f64 {
    let step = (to - from) / f64::from(QUADRATURE_POINTS);
    let weight = |i: u32| match i {
        0 | QUADRATURE_POINTS => 1.0,
        i if i % 2 == 1 => 4.0,
        _ => 2.0,
    };
    let sum: f64 = (0..=QUADRATURE_POINTS).map(|i| weight(i) * of(from + step * f64::from(i))).sum();
    (sum * step / 3.0).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn a_limit_in_the_middle_of_equal_spreads_errs_on_an_eighth_to_either_side() {
        // Two normal variables of correlation 1/√2 have unlike signs with the probability arccos(1/√2)/π = 1/4.
        let risk = Judged { mean: 2.0, units: 0.5, measurement: 0.5 }.upper(2.0).unwrap();
        assert!((risk.consumer - 0.125).abs() < 1e-6 && (risk.producer - 0.125).abs() < 1e-6, "{risk:?}");
    }

    #[test]
    fn risks_are_the_shares_of_drawn_units() {
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(5);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let judged = Judged { mean: 1.0, units: 0.4, measurement: 0.2 };
        let (limit, draws) = (1.5, 400_000);
        let mut wrong = [0u32; 2];
        for _ in 0..draws {
            let truth = 1.0 + 0.4 * normal();
            let measured = truth + 0.2 * normal();
            wrong[0] += u32::from(truth > limit && measured <= limit);
            wrong[1] += u32::from(truth <= limit && measured > limit);
        }
        let risk = judged.upper(limit).unwrap();
        for (count, expected) in wrong.into_iter().zip([risk.consumer, risk.producer]) {
            let share = f64::from(count) / f64::from(draws);
            let sigma = (expected / f64::from(draws)).sqrt();
            assert!((share - expected).abs() < 4.0 * sigma, "{share} {expected}");
        }
    }

    #[test]
    fn far_limits_risk_nothing_and_no_spread_is_no_risk() {
        let judged = Judged { mean: 0.0, units: 1.0, measurement: 0.1 };
        let far = judged.upper(20.0).unwrap();
        assert!(far.consumer < 1e-12 && far.producer < 1e-12, "{far:?}");
        let low = judged.upper(-20.0).unwrap();
        assert!(low.consumer < 1e-12 && low.producer < 1e-12, "{low:?}");
        assert!(Judged { measurement: 0.0, ..judged }.upper(1.0).is_none());
    }
}
