//! Whether the output was smoothed over longer than the means that the noise in zones of temperature is read from.

use crate::estimate::{Finding, Holds};
use crate::evidence::GyroEvidence;
use crate::message::{Arg, note};

/// Finds a smoothed output over temperature.
pub(super) fn examine(gyro: &GyroEvidence) -> Vec<Finding> {
    let zones = gyro.over_temperature.iter().flat_map(|found| &found.zones);
    let Some(zone) = zones.into_iter().find(|zone| zone.smoothed) else { return vec![] };
    vec![Finding {
        measurands: vec!["angle_random_walk_at_temperature"],
        holds: Holds::Nothing,
        found: note!("criticism_found.smoothed_output", average_s = Arg::figures(zone.average_s, 2)),
        advice: note!("criticism_advice.slow_part_removed"),
    }]
}

#[cfg(test)]
mod tests {
    use crate::evidence::test_evidence::asked;
    use crate::temperature::TemperatureTest;
    use crate::temperature::sampler::Draw;
    use crate::temperature::track::Means;
    use crate::temperature::zones::zones;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn a_smoothed_output_is_told_from_white_noise_with_and_without_slow_noise() {
        let smoothed = |walk: f64, keep: f64, seed: u64| {
            let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(seed);
            let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
            let (mut slow, mut followed) = (0.0, 0.0);
            let next = |_| {
                slow += walk * normal();
                followed = keep * followed + (1.0 - keep) * (normal() + slow);
                followed
            };
            let rate: Vec<f64> = (0..1500).map(next).collect();
            let values = vec![rate, vec![20.0; 1500]];
            let means = Means { block_s: 60.0, samples: 1, first_s: 0.0, values };
            let test = TemperatureTest { zones_deg_c: vec![20.0], ..asked() };
            let draw = Draw {
                shape: vec![],
                noise: [0.0, 0.0, walk / (1.0f64 / 60.0).sqrt()],
                coefficients: nalgebra::DVector::zeros(0),
                covariance: nalgebra::DMatrix::zeros(0, 0),
            };
            zones(&means, (0, 1), (&[draw], 0.0), &test)[0].smoothed
        };
        assert!((0..100).all(|seed| !smoothed(0.0, 0.0, seed)));
        assert!((0..100).all(|seed| !smoothed(0.5, 0.0, seed)), "a random walk is no filter");
        assert!((0..20).all(|seed| smoothed(0.0, 0.5, seed)));
    }
}
