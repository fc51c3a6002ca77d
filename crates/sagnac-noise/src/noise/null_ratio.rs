//! What ratio of the deviation of window means to the least Allan deviation a short record gives for angle random walk
//! alone.
//!
//! Both come from the same record. In a long one the minimum lies at averaging times of which the windows tell nearly
//! nothing, and their scatters add; in a short one the two share the slowest fluctuations, and their quotient scatters
//! less. It is simulated there: N cancels, so that record length, window and averaging times are all it depends on.

use super::difference_sums::ending_from;
use crate::numeric::order::SortNumbers;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Steps in a window.
const STEPS_PER_WINDOW: usize = 10;
/// Longest record that is simulated, steps.
const MAX_STEPS: usize = 1100;
/// Records.
const SIMULATED_RECORDS: usize = 2000;
const RECORDS_SEED: u64 = 952;

/// Quantiles of 5, 50 and 95 % of the ratio of the standard deviation of means over `window_s` to the least overlapping
/// Allan deviation at `taus_s`, for a record of `length_s` of angle random walk alone. Averaging times are rounded to
/// tenths of a window; shorter ones hold no minimum of white noise. `None` for a record longer than 110 windows, of less
/// than two, or where no averaging time is left.
pub fn null_ratio(length_s: f64, window_s: f64, taus_s: &[f64]) -> Option<[f64; 3]> {
    let step_s = window_s / STEPS_PER_WINDOW as f64;
    let count = (length_s / step_s).floor();
    if !(2.0 * STEPS_PER_WINDOW as f64..=MAX_STEPS as f64).contains(&count) {
        return None;
    }
    let count = count as usize;
    let mut factors: Vec<usize> = taus_s
        .iter()
        .map(|t| (t / step_s).round())
        .filter(|m| *m >= 1.0 && 2.0 * m <= count as f64)
        .map(|m| m as usize)
        .collect();
    factors.dedup();
    if factors.is_empty() {
        return None;
    }
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(RECORDS_SEED);
    let mut sums = vec![0.0; count + 1];
    let mut ratios: Vec<f64> = (0..SIMULATED_RECORDS)
        .map(|_| {
            let mut sum = 0.0;
            for s in sums.iter_mut().skip(1) {
                let step: f64 = StandardNormal.sample(&mut rng);
                sum += step;
                *s = sum;
            }
            let least = factors.iter().map(|m| allan_variance(&sums, *m)).fold(f64::INFINITY, f64::min);
            (window_variance(&sums) / least).sqrt()
        })
        .collect();
    ratios.sort_ascending();
    let at = |p: f64| ratios.get((p * SIMULATED_RECORDS as f64) as usize).copied();
    Some([at(0.05)?, at(0.5)?, at(0.95)?])
}

/// Overlapping Allan variance of steps from their running sums.
fn allan_variance(sums: &[f64], m: usize) -> f64 {
    let (squares, count) = ending_from(sums, m, 2, 0);
    squares / (2.0 * (m * m) as f64 * count.max(1) as f64)
}

/// Variance of the means of consecutive windows.
fn window_variance(sums: &[f64]) -> f64 {
    let ends: Vec<f64> = sums.iter().step_by(STEPS_PER_WINDOW).copied().collect();
    let means: Vec<f64> = ends.windows(2).map(|w| (w[1] - w[0]) / STEPS_PER_WINDOW as f64).collect();
    let n = means.len() as f64;
    let mean = means.iter().sum::<f64>() / n;
    means.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Octaves of 1 s up to a fifth of a record.
    fn octaves(length_s: f64) -> Vec<f64> {
        (0..).map(|k| f64::from(1u32 << k)).take_while(|t| *t <= 0.2 * length_s).collect()
    }

    /// The ratio of a record of white noise at 1 Hz, by means of means.
    fn ratio(rng: &mut Xoshiro256PlusPlus, seconds: usize) -> f64 {
        let y: Vec<f64> = (0..seconds).map(|_| StandardNormal.sample(rng)).collect();
        let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
        let windows: Vec<f64> = y.chunks_exact(100).map(mean).collect();
        let centre = mean(&windows);
        let n = windows.len() as f64;
        let sigma = (windows.iter().map(|w| (w - centre).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
        let allan = |m: usize| {
            let pairs: Vec<f64> = y.windows(2 * m).map(|w| (mean(&w[m..]) - mean(&w[..m])).powi(2)).collect();
            (0.5 * mean(&pairs)).sqrt()
        };
        let least = octaves(seconds as f64).iter().map(|t| allan(*t as usize)).fold(f64::INFINITY, f64::min);
        sigma / least
    }

    #[test]
    fn nine_of_ten_records_of_white_noise_lie_inside() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(77);
        for seconds in [1000usize, 1800] {
            let [low, median, high] = null_ratio(seconds as f64, 100.0, &octaves(seconds as f64)).unwrap();
            let ratios: Vec<f64> = (0..60).map(|_| ratio(&mut rng, seconds)).collect();
            // 54 ± 2.3, and half of them below the median, ± 3.9. The study is `comparison`.
            let inside = ratios.iter().filter(|r| (low..=high).contains(*r)).count();
            let below = ratios.iter().filter(|r| **r < median).count();
            assert!((46..=60).contains(&inside), "{seconds}: {inside} in {low} to {high}");
            assert!((15..=45).contains(&below), "{seconds}: {below} below {median}");
        }
    }

    #[test]
    fn what_cannot_be_simulated_is_left_to_the_table() {
        assert!(null_ratio(36_000.0, 100.0, &octaves(36_000.0)).is_none());
        assert!(null_ratio(150.0, 100.0, &octaves(150.0)).is_none());
        assert!(null_ratio(1800.0, 100.0, &[]).is_none());
        assert!(null_ratio(f64::NAN, 100.0, &[100.0]).is_none());
    }
}
