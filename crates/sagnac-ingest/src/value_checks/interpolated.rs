//! Samples on the straight line between their neighbours: an output that was interpolated to a higher rate.
//!
//! Linear interpolation by k leaves k − 1 of k samples exactly half-way between their neighbours. Noise does so by
//! chance only: a second difference below 2 % of the first ones has a probability of about 1 %. An output that is
//! sampled more than a hundred times faster than it can follow looks the same, and carries as little in each sample.

/// Second difference, in units of the neighbouring first ones, that counts as none.
const STRAIGHT: f64 = 0.02;
/// Share of straight samples from which the output is taken for interpolated; by a factor of 2 it is a half.
const SHARE: f64 = 0.4;
/// Fewest samples that can be judged.
const MIN_SAMPLES: u64 = 1000;

#[derive(Debug, Clone)]
pub(super) struct InterpolationCheck {
    /// The two latest samples; NaN before there were any, which judges nothing.
    last: (f64, f64),
    judged: u64,
    straight: u64,
}

impl Default for InterpolationCheck {
    fn default() -> Self {
        InterpolationCheck { last: (f64::NAN, f64::NAN), judged: 0, straight: 0 }
    }
}

impl InterpolationCheck {
    pub(super) fn take(&mut self, values: &[f64]) {
        let (mut a, mut b) = self.last;
        let (mut straight, mut judged) = (0u64, 0u64);
        for &c in values {
            let (before, after) = (b - a, c - b);
            let second = (after - before).abs();
            judged += u64::from(second.is_finite());
            // Equal values are for the test of stuck ones.
            straight += u64::from(second < STRAIGHT * before.abs().min(after.abs()));
            (a, b) = (b, c);
        }
        self.straight += straight;
        self.judged += judged;
        self.last = (a, b);
    }

    /// The share of straight samples, where it tells of interpolation.
    pub(super) fn finish(&self) -> Option<f64> {
        let share = self.straight as f64 / self.judged.max(1) as f64;
        (self.judged >= MIN_SAMPLES && share >= SHARE).then_some(share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    fn share(values: &[f64]) -> Option<f64> {
        let mut lines = InterpolationCheck::default();
        values.chunks(97).for_each(|part| lines.take(part));
        let mut one_by_one = InterpolationCheck::default();
        values.chunks(1).for_each(|part| one_by_one.take(part));
        assert_eq!(one_by_one.finish(), lines.finish());
        lines.finish()
    }

    #[test]
    fn interpolation_is_seen_and_noise_is_not() {
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(5);
        let noise: Vec<f64> = (0..20_000).map(|_| StandardNormal.sample(&mut rng)).collect();
        assert_eq!(share(&noise), None);
        for k in [2u32, 4, 10] {
            let fine: Vec<f64> = noise
                .iter()
                .zip(&noise[1..])
                .flat_map(|(a, b)| (0..k).map(move |i| a + (b - a) * f64::from(i) / f64::from(k)))
                .collect();
            let found = share(&fine).unwrap();
            assert!((found - (1.0 - 1.0 / f64::from(k))).abs() < 0.02, "{k}: {found}");
        }
        // A moving mean over ten samples is smooth, and no straight line.
        let smooth: Vec<f64> = noise.windows(10).map(|w| w.iter().sum::<f64>() / 10.0).collect();
        assert_eq!(share(&smooth), None);
        assert_eq!(share(&[1.0; 5000]), None);
    }
}
