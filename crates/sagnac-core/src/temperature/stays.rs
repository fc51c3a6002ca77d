//! Whether a bias stays in its band once the transient after switching on has ended, by running means alone.
//!
//! The time of the transient rests on decays. A bias that leaves the band again later, because a door was opened or a heater
//! switched, is no decay: slow noise takes it, and the time says nothing of it. The running mean shares no assumption with the
//! decays: it leaves the band or it does not. A departure counts where it is far outside the white noise that neighbouring
//! means show.
//!
//! A record smoothed before delivery has no such noise left, and its transient is that of the filter. It shows by deviations
//! that grow with the averaging time from the shortest one on.

use crate::estimate::normal_quantile;

/// Probability that white noise alone leaves the band somewhere in a record, all lengths of means together.
const BY_CHANCE: f64 = 2e-3;
/// Lengths of means, and independent places of one length in the length of the record over that of the mean, that are counted.
const INDEPENDENT_LOOKS: f64 = 60.0;
/// Longest running mean, as a share of the record.
const MAX_SHARE: f64 = 0.125;
/// Longest averaging time in blocks at which smoothing is looked for.
const MAX_SMOOTHED: usize = 64;
/// Ratio of variances of means over longer and the shortest time from which the output was smoothed. Without smoothing
/// white noise makes it less than 1.
const SMOOTHED_RATIO: f64 = 2.0;

/// A bias that left its band after the transient.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Departure {
    /// Start of the running mean that is clearest outside, s from switching on.
    pub from_s: f64,
    /// Its end, s.
    pub to_s: f64,
    /// Its distance from the final value, deg/h.
    pub deg_h: f64,
}

/// Block means of a record with what is known of them.
pub struct Course<'a> {
    /// Means, deg/h.
    pub values: &'a [f64],
    /// The transient with the mean of the record, deg/h.
    pub modelled: &'a [f64],
    /// Length of a block, s.
    pub block_s: f64,
    /// Middle of the first block, s.
    pub first_s: f64,
}

/// Mean square of second differences of means over `m` blocks, as a variance of such a mean; white noise gives its variance.
fn variance_of_means(values: &[f64], m: usize) -> Option<f64> {
    let means: Vec<f64> = values.chunks_exact(m).map(|c| c.iter().sum::<f64>() / m as f64).collect();
    let triples = means.iter().zip(means.iter().skip(1)).zip(means.iter().skip(2));
    let squares: Vec<f64> = triples.map(|((a, b), c)| (a - 2.0 * b + c).powi(2) / 6.0).collect();
    (squares.len() >= 8).then(|| squares.iter().sum::<f64>() / squares.len() as f64)
}

impl Course<'_> {
    fn residual(&self) -> Vec<f64> {
        self.values.iter().zip(self.modelled).map(|(y, m)| y - m).collect()
    }

    /// Departures from the band about the final value that begin after a time.
    pub fn departure(&self, after_s: f64, final_deg_h: f64, band_deg_h: f64) -> Option<Departure> {
        let residual = self.residual();
        let white = variance_of_means(&residual, 1)?;
        let first = ((after_s - self.first_s) / self.block_s).ceil().max(0.0) as usize;
        let longest = (MAX_SHARE * residual.len() as f64) as usize;
        let sums = |values: &mut dyn Iterator<Item = f64>| -> Vec<f64> {
            let mut sums = vec![0.0];
            let mut sum = 0.0;
            values.for_each(|v| {
                sum += v;
                sums.push(sum);
            });
            sums
        };
        let off = sums(&mut self.values.iter().map(|v| v - final_deg_h));
        let left = sums(&mut residual.iter().copied());
        // The mean that is farthest from noise tells best from when to when the bias was outside.
        let mut clearest: Option<(f64, Departure)> = None;
        let mut window = 1;
        while window <= longest {
            let deviation = (white / window as f64).sqrt();
            let looks = INDEPENDENT_LOOKS * residual.len() as f64 / window as f64;
            let least = normal_quantile(1.0 - 0.5 * BY_CHANCE / looks);
            for i in first..=residual.len().saturating_sub(window) {
                let mean = |sums: &[f64]| (sums[i + window] - sums[i]) / window as f64;
                let (away, beyond) = (mean(&off), mean(&left).abs() / deviation);
                let is_clearer = clearest.as_ref().is_none_or(|(most, _)| beyond > *most);
                let outside = (away.abs() - band_deg_h) / deviation;
                if outside > least && beyond > least && is_clearer {
                    let from_s = self.first_s + (i as f64 - 0.5) * self.block_s;
                    let to_s = from_s + window as f64 * self.block_s;
                    clearest = Some((beyond, Departure { from_s, to_s, deg_h: away }));
                }
            }
            window = (window + 1).max(window * 5 / 4);
        }
        clearest.map(|(_, departure)| departure)
    }

    /// Time over which the output was smoothed, s; `None` where it was not.
    pub fn smoothed_s(&self) -> Option<f64> {
        let residual = self.residual();
        let shortest = variance_of_means(&residual, 1)?;
        let longer = (1..).map(|k| 1 << k).take_while(|m| *m <= MAX_SMOOTHED);
        let ratios: Vec<(usize, f64)> =
            longer.filter_map(|m| Some((m, variance_of_means(&residual, m)? / shortest))).collect();
        // A single jump raises the variance of long means, and hardly that of two blocks.
        ratios.first().filter(|r| r.1 > 1.0)?;
        let largest = ratios.into_iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
        (largest.1 > SMOOTHED_RATIO).then_some(largest.0 as f64 * self.block_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::temperature::sampler::normal;
    use rand::SeedableRng;
    use rand_xoshiro::Xoshiro256PlusPlus;

    const BLOCK_S: f64 = 7.0;

    /// A settled record of 2000 blocks with noise of 0.05 deg/h, moved by so much for 90 blocks in its middle.
    fn record(seed: u64, moved: f64) -> Vec<f64> {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        let at = |i: usize| if (900..990).contains(&i) { moved } else { 0.0 };
        (0..2000).map(|i| 12.0 + at(i) + 0.05 * normal(&mut rng)).collect()
    }

    fn departure(values: &[f64]) -> Option<Departure> {
        let modelled = vec![12.0; values.len()];
        let course = Course { values, modelled: &modelled, block_s: BLOCK_S, first_s: 0.5 * BLOCK_S };
        course.departure(500.0, 12.0, 0.02)
    }

    #[test]
    fn a_bias_that_leaves_the_band_again_is_seen_and_noise_is_not() {
        for seed in 0..20 {
            assert_eq!(departure(&record(seed, 0.0)), None, "{seed}");
            for moved in [0.06, -0.12] {
                let found = departure(&record(seed, moved)).unwrap();
                let (from_s, to_s) = (900.0 * BLOCK_S, 990.0 * BLOCK_S);
                let near = |at: f64, s: f64| (at - s).abs() < 0.7 * (to_s - from_s);
                assert!(near(found.from_s, from_s) && near(found.to_s, to_s), "{found:?}");
                assert!((0.5..2.5).contains(&(found.deg_h / moved)), "{found:?}");
            }
            // Within the band it may do what it likes.
            assert_eq!(departure(&record(seed, 0.012)), None, "{seed}");
        }
    }

    #[test]
    fn a_smoothed_output_is_seen() {
        let of = |values: &[f64]| {
            let modelled = vec![12.0; values.len()];
            Course { values, modelled: &modelled, block_s: BLOCK_S, first_s: 3.5 }.smoothed_s()
        };
        for seed in 0..20 {
            let plain = record(seed, 0.0);
            assert_eq!(of(&plain), None, "{seed}");
            let means: Vec<f64> = plain.windows(10).map(|w| w.iter().sum::<f64>() / 10.0).collect();
            let found = of(&means).unwrap();
            assert!((28.0..=120.0).contains(&found), "{found}");
        }
    }
}
