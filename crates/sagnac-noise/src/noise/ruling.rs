//! Which noise rules at an averaging time, from the slope of the Allan deviation there.
//!
//! Serves where degrees of freedom are wanted and no model was fitted. The slope is taken over two octaves, and held where
//! fewer than [`LEAST_MEANS`] means remain: beyond, it says little. Source: NIST SP 1065, section 5.3.2 and table 4.

use super::data::{DeviationPoint, NoiseType};

/// Independent means below which a slope is not read.
pub const LEAST_MEANS: u64 = 32;

/// The noise at each averaging factor, from the overlapping Allan deviation at octaves.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RulingNoise(Vec<(u64, NoiseType)>);

impl RulingNoise {
    /// Reads the noise from points at octaves, ascending, of a record with a number of samples.
    pub fn of_octaves(points: &[DeviationPoint], samples: u64) -> RulingNoise {
        let readable = |p: &&DeviationPoint| p.deviation > 0.0 && p.m.saturating_mul(LEAST_MEANS) <= samples;
        let points: Vec<&DeviationPoint> = points.iter().filter(readable).collect();
        let read = |i: usize| {
            let (from, to) = (points.get(i.saturating_sub(1))?, points.get((i + 1).min(points.len() - 1))?);
            let octaves = (to.m as f64 / from.m as f64).log2();
            (octaves > 0.0).then(|| (points[i].m, of_slope((to.deviation / from.deviation).log2() / octaves)))
        };
        RulingNoise((0..points.len()).filter_map(read).collect())
    }

    /// The noise at an averaging factor; white rate noise where nothing was read.
    pub fn at(&self, m: u64) -> NoiseType {
        let last_before = self.0.iter().rev().find(|(at, _)| *at <= m).or(self.0.first());
        last_before.map_or(NoiseType::AngleRandomWalk, |(_, noise)| *noise)
    }
}

/// The noise whose Allan deviation has the nearest slope.
fn of_slope(slope: f64) -> NoiseType {
    match slope {
        s if s < -0.75 => NoiseType::Quantization,
        s if s < -0.25 => NoiseType::AngleRandomWalk,
        s if s < 0.25 => NoiseType::Flicker,
        s if s < 0.75 => NoiseType::RateRandomWalk,
        _ => NoiseType::RateRamp,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn octaves(deviation: impl Fn(f64) -> f64) -> Vec<DeviationPoint> {
        let point = |i| {
            let m = 1_u64 << i;
            DeviationPoint { m, terms: 1, stride: 1, deviation: deviation(m as f64) }
        };
        (0..16).map(point).collect()
    }

    #[test]
    fn each_slope_has_its_noise() {
        for (slope, noise) in [
            (-1.0, NoiseType::Quantization),
            (-0.5, NoiseType::AngleRandomWalk),
            (0.0, NoiseType::Flicker),
            (0.5, NoiseType::RateRandomWalk),
            (1.0, NoiseType::RateRamp),
        ] {
            let ruling = RulingNoise::of_octaves(&octaves(|m| m.powf(slope)), 1 << 20);
            assert!([1, 7, 1 << 15, 1 << 19].iter().all(|m| ruling.at(*m) == noise), "{slope} {ruling:?}");
        }
    }

    #[test]
    fn a_short_record_keeps_the_last_noise_that_it_shows() {
        let curve = octaves(|m| if m < 1024.0 { m.powf(-0.5) } else { m });
        assert_eq!(RulingNoise::of_octaves(&curve, 1 << 13).at(1 << 12), NoiseType::AngleRandomWalk);
        assert_eq!(RulingNoise::of_octaves(&curve, 1 << 20).at(1 << 12), NoiseType::RateRamp);
        assert_eq!(RulingNoise::of_octaves(&[], 0).at(5), NoiseType::AngleRandomWalk);
    }
}
