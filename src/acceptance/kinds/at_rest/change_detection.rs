//! Detects steps of the mean and changes of the noise in the block means of a channel.

use crate::acceptance::condition::{BiasStep, NoiseChange};
use crate::noise::data::BlockSeries;

/// Blocks on each side that are compared.
const WINDOW_BLOCKS: [usize; 4] = [8, 32, 128, 512];
/// A step must exceed the scatter of such differences so many times.
const MIN_SIGNIFICANCE: f64 = 10.0;
/// Share of the step that a quarter of the reach must show: a slow change shows a quarter.
const MIN_SUDDEN_SHARE: f64 = 0.6;
/// Parts whose noise is compared.
const COMPARED_PARTS: usize = 16;
/// Ratio of the noise of two parts that is worth saying.
const MIN_NOISE_RATIO: f64 = 1.4;

/// The most significant step, timed from the start of the grid.
pub fn bias_step(blocks: &BlockSeries, tau0_s: f64) -> Option<BiasStep> {
    let block_s = blocks.block_len.max(1) as f64 * tau0_s;
    let present: Vec<(usize, f64)> =
        blocks.mean.iter().copied().enumerate().filter(|(_, m)| m.is_finite()).collect();
    let origin = present.first()?.1;
    let mut sums = vec![0.0];
    let mut sum = 0.0;
    for (_, m) in &present {
        sum += m - origin;
        sums.push(sum);
    }
    let difference = |at: usize, reach: usize| -> Option<f64> {
        let (before, here, after) =
            (*sums.get(at.checked_sub(reach)?)?, *sums.get(at)?, *sums.get(at.checked_add(reach)?)?);
        Some((after - 2.0 * here + before) / reach as f64)
    };
    let mut best: Option<BiasStep> = None;
    for reach in WINDOW_BLOCKS {
        if present.len() < 16 * reach {
            break;
        }
        let all: Vec<f64> = (reach..=present.len() - reach).filter_map(|at| difference(at, reach)).collect();
        let mut sizes: Vec<f64> = all.iter().map(|d| d.abs()).collect();
        let middle = sizes.len() / 2;
        let scatter = 1.4826 * *sizes.select_nth_unstable_by(middle, f64::total_cmp).1;
        let (at, size) = all.iter().copied().enumerate().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        let significance = size.abs() / scatter;
        let sudden = difference(at + reach, reach / 4).is_some_and(|d| d / size >= MIN_SUDDEN_SHARE);
        if scatter > 0.0
            && sudden
            && significance > MIN_SIGNIFICANCE.max(best.map_or(0.0, |b| b.significance))
        {
            let block = present.get(at + reach)?.0;
            best = Some(BiasStep { time_s: block as f64 * block_s, size_deg_h: size, significance });
        }
    }
    best
}

/// A change of the noise between sixteenths of the record, timed from the start of the grid.
pub fn noise_change(blocks: &BlockSeries, tau0_s: f64) -> Option<NoiseChange> {
    let block_s = blocks.block_len.max(1) as f64 * tau0_s;
    let length = blocks.mean.len() / COMPARED_PARTS;
    if length < 500 {
        return None;
    }
    let mut levels: Vec<(f64, f64, usize)> = Vec::new();
    for (part, means) in blocks.mean.chunks(length).take(COMPARED_PARTS).enumerate() {
        let steps = means.iter().zip(means.get(1..).unwrap_or_default());
        let (sum, n) = steps
            .map(|(a, b)| (b - a).abs())
            .filter(|d| d.is_finite())
            .fold((0.0, 0usize), |(sum, n), d| (sum + d, n + 1));
        if n >= length / 2 {
            levels.push((sum / n as f64, (part as f64 + 0.5) * length as f64 * block_s, n));
        }
    }
    let loudest = levels.iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
    let quietest = levels.iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
    let ratio = loudest.0 / quietest.0;
    let least = levels.iter().map(|l| l.2).min().unwrap_or(1) as f64;
    // The mean size of a difference is known to about 1/√n, and half as well where differences are correlated, as those
    // of quantisation noise are; the extremes of sixteen lie some three of its deviations to each side.
    let certain = ratio.ln() > 12.0 / least.sqrt();
    (quietest.0 > 0.0 && ratio.is_finite() && ratio > MIN_NOISE_RATIO && certain).then_some(NoiseChange {
        ratio,
        loudest_s: loudest.1,
        quietest_s: quietest.1,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::model::NoiseModel;
    use crate::noise::simulate::{Setup, Simulator};

    fn blocks(mean: Vec<f64>) -> BlockSeries {
        BlockSeries { block_len: 1, first_index: 0, count: vec![1; mean.len()], mean, rounding: Vec::new() }
    }

    fn noise(model: NoiseModel, seed: u64, n: usize) -> Vec<f64> {
        Simulator::new(&model, &Setup::for_record(seed, 1.0, n as u64)).take(n)
    }

    #[test]
    fn a_step_is_found_where_it_is_and_a_ramp_is_none() {
        let white = NoiseModel { n: 0.002, b: 0.003, ..NoiseModel::default() };
        let mut y = noise(white, 1, 36_000);
        y.iter_mut().skip(20_000).for_each(|v| *v += 0.13);
        let step = bias_step(&blocks(y), 1.0).unwrap();
        assert!((step.time_s - 20_000.0).abs() < 150.0 && (step.size_deg_h - 0.13).abs() < 0.03, "{step:?}");
        let ramp: Vec<f64> =
            noise(white, 2, 36_000).iter().enumerate().map(|(i, v)| v + 1e-5 * i as f64).collect();
        assert_eq!(bias_step(&blocks(ramp), 1.0), None);
    }

    #[test]
    fn records_of_one_piece_show_neither() {
        let mut said = 0;
        for seed in 0..18 {
            let model = match seed % 3 {
                0 => NoiseModel { n: 0.002, ..NoiseModel::default() },
                1 => NoiseModel { n: 0.002, b: 0.02, ..NoiseModel::default() },
                _ => NoiseModel { n: 0.002, k: 0.02, q: 0.1, ..NoiseModel::default() },
            };
            let y = blocks(noise(model, 1000 + seed, 20_000));
            said += usize::from(bias_step(&y, 1.0).is_some()) + usize::from(noise_change(&y, 1.0).is_some());
        }
        assert_eq!(said, 0);
    }

    #[test]
    fn a_change_of_the_noise_is_found() {
        let mut y = noise(NoiseModel { n: 0.002, ..NoiseModel::default() }, 5, 30_000);
        y.iter_mut().skip(15_000).for_each(|v| *v *= 1.7);
        let change = noise_change(&blocks(y), 1.0).unwrap();
        assert!((change.ratio - 1.7).abs() < 0.15 && change.loudest_s > 15_000.0, "{change:?}");
        assert!(change.quietest_s < 15_000.0);
    }
}
