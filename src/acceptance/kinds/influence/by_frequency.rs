//! Vibration by frequency: the accelerometer in a second pass over the recording, and what the output does with it.

use crate::acceptance::reading::read_again;
use crate::acceptance::test_kind::{Progress, Reading, Run};
use crate::influence::comparison::Beside;
use crate::influence::intervals::Intervals;
use crate::influence::over_frequency::OverFrequency;
use crate::influence::shaken::{Accelerations, Shaken};
use crate::influence::{ByFrequency, ComparisonTest, rectification, resonance};
use crate::rate_table::blocks::Blocks;
use crate::rate_table::cross_spectrum::{Bin, CrossSpectra};
use crate::recording::{SampleBlock, Sink};

/// What the accelerometer and the outputs show together.
pub(super) struct Vibration {
    /// Acceleration in the intervals.
    pub(super) shaken: Shaken,
    /// Spectra of every gyro channel against the acceleration, in the intervals with vibration.
    spectra: Vec<(String, Vec<Bin>)>,
}

/// Rows of an interval.
struct Span {
    /// First position and position after the last.
    samples: (u64, u64),
    /// True with vibration.
    on: bool,
}

/// Acceleration of every interval, and spectra of those with vibration.
struct Collector {
    spans: Vec<Span>,
    accelerometer: usize,
    accelerations: Accelerations,
    spectra: CrossSpectra,
    last: Option<usize>,
}

impl Sink for Collector {
    fn push(&mut self, block: &SampleBlock<'_>) {
        let end = block.first_index + block.len() as u64;
        let Some(values) = block.values.get(self.accelerometer) else { return };
        for (at, span) in self.spans.iter().enumerate() {
            let (first, last) = (span.samples.0.max(block.first_index), span.samples.1.min(end));
            if first >= last {
                continue;
            }
            let rows = (first - block.first_index) as usize..(last - block.first_index) as usize;
            let continues = block.continues && rows.start == 0 && self.last == Some(at);
            self.last = Some(at);
            let own = values.get(rows.clone()).unwrap_or_default();
            self.accelerations.push(at, own, continues);
            if span.on {
                self.spectra.push_rows(block, rows, continues);
            }
        }
    }
}

/// Reads the acceleration by frequency; `None` where the recording has no such channel.
pub(super) fn read(
    reading: &Reading<'_>,
    asked: &ByFrequency,
    blocks: &Blocks,
    series: &Intervals,
    progress: Progress<'_>,
) -> Run<Option<Vibration>> {
    let slot = reading.channels.iter().position(|c| c.id == asked.accelerometer);
    let Some(accelerometer) = slot else { return Ok(None) };
    let span = |interval: &crate::influence::intervals::Interval| {
        let list = blocks.list.get(interval.blocks.0..interval.blocks.1).unwrap_or_default();
        let from = list.first().map_or(0, |b| b.first_index);
        let to = list.last().map_or(0, |b| b.first_index + u64::from(b.samples));
        Span { samples: (from, to), on: !series.is_off(interval) }
    };
    let spans: Vec<Span> = series.list.iter().map(span).collect();
    let lengths: Vec<u64> = spans.iter().map(|s| s.samples.1 - s.samples.0).collect();
    let interval_s = reading.report.tau0_measured_s;
    let mut collector = Collector {
        spans,
        accelerometer,
        accelerations: Accelerations::new(&asked.bands, interval_s, &lengths),
        spectra: CrossSpectra::from(&reading.channels, interval_s, Some(accelerometer)),
        last: None,
    };
    read_again(reading, &mut collector, progress)?;
    Ok(Some(Vibration {
        shaken: collector.accelerations.finish(),
        spectra: collector.spectra.finish_finest(interval_s),
    }))
}

impl Vibration {
    /// What it does to one gyro channel.
    pub(super) fn evaluate(
        &self,
        blocks: &Blocks,
        series: &Intervals,
        test: &ComparisonTest,
        beside: &Beside,
        gyro: usize,
    ) -> Option<OverFrequency> {
        let channel = blocks.gyros.get(gyro)?.clone();
        let bins = self.spectra.iter().find(|(id, _)| *id == channel).map_or(&[][..], |(_, b)| b.as_slice());
        Some(OverFrequency {
            rectification: rectification::evaluate(blocks, series, test, beside, gyro, &self.shaken),
            resonance: resonance::search(bins, &self.shaken.bands),
            channel,
        })
    }
}
