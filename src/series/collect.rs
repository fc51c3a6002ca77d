//! Reads a recording into memory.

use super::channels::{SeriesChannels, select_channels};
use super::options::{SeriesError, SeriesOptions};
use crate::effect::Column;
use crate::ingest::{Source, TimeBaseSpec, open_recording, prepare};
use crate::recording::{SampleBlock, Sink};
use sagnac_core::series::{Faults, Series};
use std::path::PathBuf;

/// Reads a recording: a file of any kind that is read, several in sequence, a pattern, or a manifest.
///
/// `progress` gets bytes done and bytes in all.
///
/// # Errors
/// What keeps it from being read, and columns that cannot be identified.
pub fn load_series(
    named: &[PathBuf],
    options: &SeriesOptions,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<Series, SeriesError> {
    load_series_of(&open_recording(named, &options.read)?.source, options, progress)
}

/// Reads an opened recording; [`SeriesOptions::read`] plays no part.
///
/// # Errors
/// What keeps it from being read, and columns that cannot be identified.
pub fn load_series_of(
    source: &Source,
    options: &SeriesOptions,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<Series, SeriesError> {
    let chosen = select_channels(source, options)?;
    let spec = TimeBaseSpec {
        declared_sample_rate_hz: options.sample_rate_hz,
        use_stamps: chosen.time.is_some(),
        ..TimeBaseSpec::default()
    };
    let plan = prepare(source, &chosen.channels, spec)?;
    let nominal_s = plan.clock().interval_s;
    let mut rows = Rows::new(&chosen, nominal_s);
    let report = plan.stream(&mut [&mut rows], progress)?;
    let mut series = rows.series;
    series.faults.rows = report.rows as usize;
    series.faults.without_time = report.rows.saturating_sub(report.rows_used) as usize;
    series.faults.missing = report.integrity.missing_samples as usize;
    series.faults.integrity = report.integrity;
    series.sample_interval_s = report.tau0_measured_s;
    series.sha256 = report.facts.sha256;
    series.notes = source.notes().to_vec();
    series.notes.extend(report.notes);
    series.read_from = chosen.read_from;
    series.time_s.shrink_to_fit();
    series.rate_deg_h.shrink_to_fit();
    series.index.shrink_to_fit();
    let columns = std::mem::take(&mut series.columns);
    for (column, mut values) in columns {
        let bad = values.iter().filter(|v| !v.is_finite()).count();
        if bad == values.len() {
            series.read_from.retain(|r| r.name != column.name());
            continue;
        }
        if bad > 0 {
            interpolate_missing(column, &series.time_s, &mut values);
            series.faults.interpolated.insert(column, bad);
        }
        values.shrink_to_fit();
        series.columns.insert(column, values);
    }
    Ok(series)
}

/// Takes the sample blocks of a recording.
struct Rows<'a> {
    chosen: &'a SeriesChannels,
    interval_s: f64,
    series: Series,
}

impl<'a> Rows<'a> {
    fn new(chosen: &'a SeriesChannels, interval_s: f64) -> Rows<'a> {
        let columns = chosen.further.iter().map(|f| (f.column, vec![])).collect();
        Rows {
            chosen,
            interval_s,
            series: Series { columns, faults: Faults::default(), ..Series::default() },
        }
    }
}

impl Sink for Rows<'_> {
    fn push(&mut self, block: &SampleBlock<'_>) {
        let Some(rates) = block.values.get(self.chosen.rate) else { return };
        let stamps = self.chosen.time.and_then(|t| block.values.get(t)).filter(|s| !s.is_empty());
        // After a clock that was set back, the scale of the recording goes on and that of the stamps does not.
        let shift = stamps.and_then(|s| s.first()).map_or(0.0, |first| block.time_s - first);
        let series = &mut self.series;
        for (i, rate) in rates.iter().enumerate() {
            if !rate.is_finite() {
                series.faults.without_rate += 1;
                continue;
            }
            let time_s = match stamps.and_then(|s| s.get(i)) {
                Some(stamp) => stamp + shift,
                None => block.time_s + i as f64 * self.interval_s,
            };
            series.time_s.push(time_s);
            series.rate_deg_h.push(*rate);
            series.index.push(block.first_index + i as u64);
            for further in &self.chosen.further {
                let value = block.values.get(further.slot).and_then(|v| v.get(i)).copied();
                if let Some(values) = series.columns.get_mut(&further.column) {
                    values.push(further.conversion.apply(value.unwrap_or(f64::NAN)));
                }
            }
        }
    }
}

/// Puts straight lines in place of values that are no numbers; at the ends, the nearest value. An angle goes the
/// shorter way round.
fn interpolate_missing(column: Column, time_s: &[f64], values: &mut [f64]) {
    let known: Vec<usize> = (0..values.len()).filter(|i| values[*i].is_finite()).collect();
    let mut next = 0;
    for i in 0..values.len() {
        if values[i].is_finite() {
            continue;
        }
        while known.get(next).is_some_and(|k| *k < i) {
            next += 1;
        }
        let before = next.checked_sub(1).and_then(|n| known.get(n)).copied();
        values[i] = match (before, known.get(next).copied()) {
            (Some(a), Some(b)) => {
                let mut step = values[b] - values[a];
                if column == Column::TableAngle {
                    step = (step + 180.0).rem_euclid(360.0) - 180.0;
                }
                let between = values[a] + step * (time_s[i] - time_s[a]) / (time_s[b] - time_s[a]);
                if column == Column::TableAngle { between.rem_euclid(360.0) } else { between }
            }
            (Some(one), None) | (None, Some(one)) => values[one],
            (None, None) => f64::NAN,
        };
    }
}
