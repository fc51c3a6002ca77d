//! Intervals of σ(τ): the variance is a scaled χ² with the equivalent degrees of freedom of the point.
//!
//! Source: NIST SP 1065 section 5.3.2; IEEE Std 952 annex C gives the simple error 1/√(2(T/τ − 1)) only, which covers
//! up to 11 % too much or too little and knows no noise type.

use super::data::{DeviationPoint, NoiseType};
use super::edf::{PhaseModel, edf, total_bias};
use super::family::Estimator;
use super::stretches::StretchLengths;
use crate::estimate::{Interval, Spread};

/// Probability of the interval mean ± one standard deviation of a Gaussian quantity.
pub const ONE_SIGMA: f64 = 0.682_689_492_137_085_9;

/// A point of σ(τ) with its degrees of freedom and intervals, deg/h.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundedPoint {
    /// The point. A total deviation has its bias for this noise taken out.
    pub point: DeviationPoint,
    /// Noise taken to rule at this averaging time.
    pub noise: NoiseType,
    /// Equivalent degrees of freedom.
    pub edf: f64,
    /// 95 % interval; `None` where the deviation is 0 or no number.
    pub interval95: Option<Interval>,
    /// 68.3 % interval.
    pub interval68: Option<Interval>,
}

/// The two-sided interval of a deviation with equal tails: σ·√(edf/χ²). `None` unless both are positive numbers.
pub fn deviation_interval(deviation: f64, edf: f64, coverage: f64) -> Option<Interval> {
    if !(deviation > 0.0 && deviation.is_finite() && edf > 0.0 && edf.is_finite()) {
        return None;
    }
    Spread::ChiSquare { dof: edf }.interval(deviation, coverage)
}

/// Puts degrees of freedom and intervals on a point, given the noise that rules there.
pub fn bounded(
    estimator: Estimator,
    point: &DeviationPoint,
    stretches: &StretchLengths,
    noise: NoiseType,
) -> BoundedPoint {
    let edf = edf(estimator, point, stretches, noise, PhaseModel::IntegratedRate);
    let mut point = *point;
    if estimator == Estimator::Total {
        point.deviation /= total_bias(stretches.longest() as f64 / point.m as f64, noise).sqrt();
    }
    BoundedPoint {
        point,
        noise,
        edf,
        interval95: deviation_interval(point.deviation, edf, 0.95),
        interval68: deviation_interval(point.deviation, edf, ONE_SIGMA),
    }
}

#[cfg(test)]
mod tests {
    use super::super::allan::{AllanAccumulator, AllanPlan};
    use super::super::tau_grid::TauGrid;
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    /// Limits printed by Stable32 1.60 with its degrees of freedom.
    #[test]
    fn limits_of_stable32() {
        for (low, deviation, high, edf) in [
            (2.8515e-01, 2.922318781e-01, 2.9987e-01, 782.0303),
            (1.3931e-01, 1.447913072e-01, 1.5098e-01, 306.0916),
            (5.7696e-02, 6.191477842e-02, 6.7217e-02, 86.3701),
            (3.1755e-02, 3.623721299e-02, 4.3377e-02, 21.2395),
            (2.3045e-02, 2.767385582e-02, 3.7027e-02, 9.5510),
            (1.4874e-02, 1.866932874e-02, 2.8584e-02, 5.3215),
            (2.6481e-02, 3.385519512e-02, 5.5744e-02, 4.2353),
            (1.0734e-02, 1.336943867e-02, 1.9924e-02, 5.8652),
        ] {
            let i = deviation_interval(deviation, edf, ONE_SIGMA).unwrap();
            assert!((i.low / low - 1.0).abs() < 1e-3 && (i.high / high - 1.0).abs() < 1e-3, "{edf} {i:?}");
        }
        assert!(deviation_interval(0.0, 5.0, 0.95).is_none() && deviation_interval(1.0, 0.0, 0.95).is_none());
    }

    /// Coverage of both intervals over simulated records of 1000 samples, white and random walk.
    fn coverage(records: u64, walk: bool, factors: &[u64]) -> Vec<(u64, f64, f64)> {
        let mut hits = vec![(0u64, 0u64); factors.len()];
        for seed in 0..records {
            let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(seed);
            let mut level = 0.0;
            let y: Vec<f64> = (0..1000)
                .map(|_| {
                    let step: f64 = StandardNormal.sample(&mut rng);
                    level += step;
                    if walk { level } else { step }
                })
                .collect();
            let taus = factors.iter().map(|m| *m as f64).collect();
            let plan = AllanPlan {
                tau0_s: 1.0,
                grid: TauGrid::List(taus),
                exact: false,
                estimators: vec![Estimator::Allan],
            };
            let mut allan = AllanAccumulator::new(plan);
            allan.push(&y, 0, false);
            let set = allan.finish();
            let noise = if walk { NoiseType::RateRandomWalk } else { NoiseType::AngleRandomWalk };
            for (hit, p) in hits.iter_mut().zip(&set.curves[0].points) {
                let m = p.m as f64;
                let truth = if walk { (2.0 * m * m + 1.0) / (6.0 * m) } else { 1.0 / m }.sqrt();
                let b = bounded(Estimator::Allan, p, &set.stretches, noise);
                let inside = |i: Option<Interval>| i.is_some_and(|i| i.low <= truth && truth <= i.high);
                hit.0 += u64::from(inside(b.interval68));
                hit.1 += u64::from(inside(b.interval95));
            }
        }
        let share = |h: u64| h as f64 / records as f64;
        factors.iter().zip(hits).map(|(m, h)| (*m, share(h.0), share(h.1))).collect()
    }

    fn assert_coverage(records: u64, tolerance: f64) {
        for walk in [false, true] {
            for (m, one_sigma, c95) in coverage(records, walk, &[4, 8, 16, 32, 64, 128]) {
                eprintln!("walk {walk} m {m}: {one_sigma:.4} {c95:.4}");
                assert!((one_sigma - ONE_SIGMA).abs() < tolerance, "walk {walk} m {m}: {one_sigma}");
                assert!((c95 - 0.95).abs() < tolerance, "walk {walk} m {m}: {c95}");
            }
        }
    }

    #[test]
    fn intervals_cover_what_they_say() {
        // Four standard deviations of the share of 68 %. The study is `allan-deviation`.
        assert_coverage(400, 0.09);
    }
}
