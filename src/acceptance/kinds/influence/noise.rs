//! The noise without and with an influence: each state is identified from its own samples.

use crate::acceptance::reading::read_again;
use crate::acceptance::test_kind::{Progress, Reading, Run};
use crate::estimate::normal_quantile;
use crate::influence::comparison::{BandChange, NoiseChange, level_name};
use crate::influence::intervals::Intervals;
use crate::noise::digest::{DigestPlan, RateAccumulator};
use crate::noise::in_band::{Band, BandMean, OutputSpectrum};
use crate::noise::lines::SpectralLine;
use crate::noise::spectral_record::identify_digest;
use crate::noise::welch::WelchResult;
use crate::rate_table::blocks::Blocks;
use crate::recording::{SampleBlock, Sink};
use std::collections::BTreeMap;

/// Axis and level of an influence; `None` without it.
type Level = Option<(String, f64)>;

/// Noise of one channel in one state.
struct State {
    level: Level,
    /// N with its standard uncertainty, deg/sqrt(h); `None` where it is not shown.
    n: Option<(f64, f64)>,
    /// Density in every band of the procedure without the lines in it, and how many they are.
    bands: Vec<(Option<BandMean>, usize)>,
}

/// Digests of the states of every gyro channel, collected while the recording goes by.
struct Collector {
    /// First position and position after the last, and the state.
    spans: Vec<(u64, u64, usize)>,
    /// Position of every gyro among the channels, and a digest a state.
    gyros: Vec<(usize, Vec<RateAccumulator>)>,
    last: Option<usize>,
}

impl Sink for Collector {
    fn push(&mut self, block: &SampleBlock<'_>) {
        let end = block.first_index + block.len() as u64;
        for (at, (from, to, state)) in self.spans.iter().enumerate() {
            let (first, last) = ((*from).max(block.first_index), (*to).min(end));
            if first >= last {
                continue;
            }
            let continues = block.continues && first == block.first_index && self.last == Some(at);
            self.last = Some(at);
            let inside = (first - block.first_index) as usize..(last - block.first_index) as usize;
            for (slot, digests) in &mut self.gyros {
                let values = block.values.get(*slot).and_then(|v| v.get(inside.clone()));
                if let (Some(values), Some(digest)) = (values, digests.get_mut(*state)) {
                    digest.push(values, first, continues);
                }
            }
        }
    }
}

/// Densities in bands, and the lines in them.
fn in_bands(
    bands: &[Band],
    welch: &WelchResult,
    tau0_s: f64,
    lines: &[SpectralLine],
) -> Vec<(Option<BandMean>, usize)> {
    let spectrum = OutputSpectrum::of(welch, tau0_s, lines);
    let of = |band: &Band| {
        let mean = spectrum.as_ref().filter(|s| s.shows(*band)).and_then(|s| s.mean(*band, |_| 1.0));
        let inside = |l: &&SpectralLine| (band.from_hz..=band.to_hz).contains(&l.frequency_hz);
        (mean, lines.iter().filter(inside).count())
    };
    bands.iter().map(of).collect()
}

/// The changes of the noise by gyro channel: identifies the noise of every state in a second pass over the recording.
pub fn find(
    reading: &Reading<'_>,
    blocks: &Blocks,
    series: &Intervals,
    progress: Progress<'_>,
) -> Run<BTreeMap<String, Vec<NoiseChange>>> {
    let (levels, spans) = states(blocks, series);
    let plan = || DigestPlan { estimators: vec![], ..DigestPlan::new(reading.tau0_s) };
    let digests = || levels.iter().map(|_| RateAccumulator::new(plan())).collect();
    let gyros = reading.gyros().map(|(slot, _)| (slot, digests())).collect();
    let mut collector = Collector { spans, gyros, last: None };
    read_again(reading, &mut collector, progress)?;
    let procedure = reading.procedure();
    let alarm = procedure.analysis.line_false_alarm;
    let bands = procedure.noise_test.as_ref().map_or(&[][..], |test| test.bands.as_slice());
    let mut changes: BTreeMap<String, Vec<NoiseChange>> = BTreeMap::new();
    for (slot, digests) in collector.gyros {
        let step_deg_h = reading.quantization_step(slot);
        let channel = reading.channels.get(slot).map_or_else(String::new, |c| c.id.clone());
        let states: Vec<State> = digests
            .into_iter()
            .zip(&levels)
            .map(|(digest, level)| {
                let digest = digest.finish();
                let noise = identify_digest(&channel, &digest, reading.tau0_s, alarm, step_deg_h);
                let n = noise.ranged.identification.read_angle_random_walk();
                let half = n.interval95().map(|i| 0.5 * (i.high - i.low) / normal_quantile(0.975));
                let bands = in_bands(bands, &digest.welch, reading.tau0_s, &noise.lines);
                State { level: level.clone(), n: n.value.zip(half), bands }
            })
            .collect();
        let Some(without) = states.iter().find(|s| s.level.is_none()) else { continue };
        for state in &states {
            let Some((axis, level)) = &state.level else { continue };
            let level = level_name(*level);
            let place = if axis.is_empty() { level } else { format!("{axis}:{level}") };
            let own = format!("{channel}@{place}");
            let pairs = bands.iter().zip(without.bands.iter().zip(&state.bands));
            let of_bands = pairs.map(|(band, (before, at))| BandChange {
                channel: format!("{own}:{}", band.name()),
                without: before.0,
                with: at.0,
                lines: at.1,
            });
            let bands = of_bands.collect();
            let change = NoiseChange { channel: own, without: without.n, with: state.n, bands };
            changes.entry(channel.clone()).or_default().push(change);
        }
    }
    Ok(changes)
}

/// The levels that differ, the first without the influence, and the span of every interval with the number of its level.
fn states(blocks: &Blocks, series: &Intervals) -> (Vec<Level>, Vec<(u64, u64, usize)>) {
    let mut levels: Vec<Level> = vec![None];
    let mut spans = Vec::new();
    for interval in &series.list {
        let level = (!series.is_off(interval)).then(|| {
            let away = |a: &usize| (interval.levels[*a] - series.reference).abs();
            let axis = (0..interval.levels.len()).max_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or(0);
            (series.axes[axis].clone(), interval.levels[axis])
        });
        let same = |l: &Level| match (l, &level) {
            (None, None) => true,
            (Some(a), Some(b)) => a.0 == b.0 && (a.1 - b.1).abs() <= series.tolerance,
            _ => false,
        };
        let state = levels.iter().position(same).unwrap_or_else(|| {
            levels.push(level.clone());
            levels.len() - 1
        });
        let (first, last) = (&blocks.list[interval.blocks.0], &blocks.list[interval.blocks.1 - 1]);
        spans.push((first.first_index, last.first_index + u64::from(last.samples), state));
    }
    (levels, spans)
}
