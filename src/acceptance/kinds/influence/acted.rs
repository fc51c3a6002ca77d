//! Whether the recording shows that an influence acted: a channel that tells its level, or what it did to the output.
//!
//! Vibration makes the output louder. The variance within ten samples tells that without what is slow: that of the intervals
//! with it is set against that without. A variance of white noise with n degrees of freedom scatters by √(2/n); where the
//! intervals of one level differ among themselves by more, that counts.

use crate::acceptance::condition::influence::Acted;
use crate::acceptance::reading::read_again;
use crate::acceptance::test_kind::{Progress, Reading, Run};
use crate::influence::intervals::Intervals;
use crate::influence::{ComparisonTest, Influence};
use crate::rate_table::blocks::Blocks;
use crate::recording::{SampleBlock, Sink};

/// Share of the largest level by which a channel may differ from what is stated.
const LEVEL_TOLERANCE: f64 = 0.1;

/// Samples within which the output scatters by what is fast.
const SAMPLES_PER_GROUP: usize = 10;

/// Squares about the means of so many samples in every interval of every gyro channel.
struct Loudness {
    /// First position and position after the last of every interval.
    spans: Vec<(u64, u64)>,
    /// Position of every gyro among the channels, and sum and degrees of freedom of every interval.
    gyros: Vec<(usize, Vec<(f64, u64)>)>,
}

impl Sink for Loudness {
    fn push(&mut self, block: &SampleBlock<'_>) {
        let end = block.first_index + block.len() as u64;
        for (at, (from, to)) in self.spans.iter().enumerate() {
            let (first, last) = ((*from).max(block.first_index), (*to).min(end));
            if first >= last {
                continue;
            }
            let inside = (first - block.first_index) as usize..(last - block.first_index) as usize;
            for (slot, sums) in &mut self.gyros {
                let values = block.values.get(*slot).and_then(|v| v.get(inside.clone())).unwrap_or_default();
                let Some(sum) = sums.get_mut(at) else { continue };
                for part in values.chunks(SAMPLES_PER_GROUP).filter(|p| p.iter().all(|v| v.is_finite())) {
                    let mean = part.iter().sum::<f64>() / part.len() as f64;
                    sum.0 += part.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
                    sum.1 += part.len() as u64 - 1;
                }
            }
        }
    }
}

/// What tells the level beside the procedure.
pub struct Told<'a> {
    /// Channels of the level, in the order in which blocks keep them beside.
    pub axes: &'a [String],
    /// Rms acceleration in every interval by the accelerometer, g; `None` without one.
    pub rms: Option<Vec<f64>>,
}

/// What the recording shows of the influence having acted.
pub fn find(
    reading: &Reading<'_>,
    test: &ComparisonTest,
    blocks: &Blocks,
    series: &Intervals,
    told: &Told<'_>,
    progress: Progress<'_>,
) -> Run<Acted> {
    if test.intervals.is_empty() {
        return Ok(Acted::Recorded);
    }
    if let Some(acted) = against_channels(test, blocks, series, told.axes) {
        return Ok(acted);
    }
    if let Some(rms) = &told.rms {
        return Ok(against_rms(test, blocks, series, rms));
    }
    let by_noise = if test.setting.influence == Influence::Vibration && series.with() > 0 {
        louder(reading, blocks, series, progress)?
    } else {
        None
    };
    Ok(match by_noise {
        Some((ratio, significance)) if significance >= Acted::MIN_SIGNIFICANCE => {
            Acted::Inferred { ratio, significance }
        }
        _ if test.declared => Acted::Declared,
        by_noise => Acted::NotShown { by_noise },
    })
}

/// Largest distance of a level from the reference that is stated.
fn largest(test: &ComparisonTest, series: &Intervals) -> f64 {
    let away = |l: f64| (l - test.reference).abs();
    series.list.iter().flat_map(|i| &i.levels).fold(0.0, |m: f64, l| m.max(away(*l)))
}

/// Stated levels against the rms of the accelerometer.
fn against_rms(test: &ComparisonTest, blocks: &Blocks, series: &Intervals, rms: &[f64]) -> Acted {
    let tolerance = LEVEL_TOLERANCE * largest(test, series);
    for (interval, recorded) in series.list.iter().zip(rms) {
        let stated = interval.levels.iter().copied().fold(test.reference, f64::max);
        // A level that is not recorded in an interval agrees with nothing.
        let near = (recorded - stated).abs() <= tolerance;
        if !near {
            let at_s = blocks.start_s(interval.blocks.0);
            return Acted::Contradicted { stated, recorded: *recorded, at_s };
        }
    }
    Acted::Recorded
}

/// Stated levels against the channels that tell them; `None` without such a channel.
fn against_channels(
    test: &ComparisonTest,
    blocks: &Blocks,
    series: &Intervals,
    axes: &[String],
) -> Option<Acted> {
    if axes.is_empty() {
        return None;
    }
    let largest = largest(test, series);
    for interval in &series.list {
        let list = &blocks.list[interval.blocks.0..interval.blocks.1];
        for (at, axis) in axes.iter().enumerate() {
            let own = match series.axes.iter().position(|a| a == axis) {
                Some(own) => own,
                None if axes.len() == 1 => 0,
                None => continue,
            };
            let stated = *interval.levels.get(own)?;
            let values: Vec<f64> =
                list.iter().filter_map(|b| b.beside.get(at).copied()).filter(|v| v.is_finite()).collect();
            let recorded = values.iter().sum::<f64>() / values.len() as f64;
            // A level that is not recorded in an interval agrees with nothing.
            let near = (recorded - stated).abs() <= LEVEL_TOLERANCE * largest;
            if !near {
                let at_s = blocks.start_s(interval.blocks.0);
                return Some(Acted::Contradicted { stated, recorded, at_s });
            }
        }
    }
    Some(Acted::Recorded)
}

/// How much louder the output is with the influence, as a ratio of standard deviations, and by how many standard deviations
/// of what is known of it: of the level where least is seen, on the channel where most is.
fn louder(
    reading: &Reading<'_>,
    blocks: &Blocks,
    series: &Intervals,
    progress: Progress<'_>,
) -> Run<Option<(f64, f64)>> {
    let spans = series.list.iter().map(|interval| {
        let (first, last) = (&blocks.list[interval.blocks.0], &blocks.list[interval.blocks.1 - 1]);
        (first.first_index, last.first_index + u64::from(last.samples))
    });
    let none = || vec![(0.0, 0); series.list.len()];
    let gyros = reading.gyros().map(|(slot, _)| (slot, none())).collect();
    let mut loudness = Loudness { spans: spans.collect(), gyros };
    read_again(reading, &mut loudness, progress)?;
    let levels = levels(series);
    let of_channels = loudness.gyros.iter().filter_map(|(_, sums)| of_levels(sums, &levels));
    Ok(of_channels.max_by(|a, b| a.1.total_cmp(&b.1)))
}

/// The level of every interval by number, 0 without the influence.
fn levels(series: &Intervals) -> Vec<usize> {
    let mut seen: Vec<Vec<f64>> = vec![];
    let same = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= series.tolerance);
    let number = |i: &crate::influence::intervals::Interval| {
        if series.is_off(i) {
            return 0;
        }
        let at = seen.iter().position(|s| same(s, &i.levels)).unwrap_or_else(|| {
            seen.push(i.levels.clone());
            seen.len() - 1
        });
        at + 1
    };
    series.list.iter().map(number).collect()
}

/// Ratio and significance at the level where least is seen; `None` without samples of both kinds.
fn of_levels(sums: &[(f64, u64)], levels: &[usize]) -> Option<(f64, f64)> {
    let most = *levels.iter().max()?;
    let of = |level: usize| -> Option<(f64, f64)> {
        let own = sums.iter().zip(levels).filter(|(_, l)| **l == level).map(|(s, _)| s);
        let (sum, n) = own.fold((0.0, 0), |(s, n), (sum, count)| (s + sum, n + count));
        (n > 1 && sum > 0.0).then(|| (sum / n as f64, n as f64))
    };
    // How much more the intervals of one level differ than their samples let them.
    let (mut excess, mut free) = (0.0, 0.0);
    for level in 0..=most {
        let (mean, _) = of(level)?;
        let own = sums.iter().zip(levels).filter(|(s, l)| **l == level && s.1 > 1).map(|(s, _)| s);
        let parts: Vec<f64> =
            own.map(|(sum, n)| (sum / *n as f64 / mean - 1.0).powi(2) * *n as f64 / 2.0).collect();
        excess += parts.iter().sum::<f64>();
        free += parts.len().saturating_sub(1) as f64;
    }
    let factor = if free > 0.0 { (excess / free).max(1.0) } else { 1.0 };
    let (rest, n0) = of(0)?;
    let ratios = (1..=most).filter_map(|level| {
        let (loud, n) = of(level)?;
        let scatter = (2.0 * factor * (1.0 / n + 1.0 / n0)).sqrt();
        Some(((loud / rest).sqrt(), (loud / rest).ln() / scatter))
    });
    ratios.min_by(|a, b| a.1.total_cmp(&b.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_level_must_be_louder() {
        let levels = [0, 1, 0, 2, 0];
        let quiet = (1000.0, 1000);
        let both = [quiet, (1500.0, 1000), quiet, (2500.0, 1000), quiet];
        assert!(of_levels(&both, &levels).unwrap().1 > 5.0);
        let one = [quiet, (1010.0, 1000), quiet, (2500.0, 1000), quiet];
        assert!(of_levels(&one, &levels).unwrap().1 < 1.0);
    }

    #[test]
    fn intervals_that_differ_at_rest_leave_less() {
        let levels = [0, 1, 0, 1, 0];
        let wild = [(700.0, 1000), (1500.0, 1000), (1300.0, 1000), (1500.0, 1000), (1000.0, 1000)];
        assert!(of_levels(&wild, &levels).unwrap().1 < 3.0);
    }
}
