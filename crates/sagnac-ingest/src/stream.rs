//! A recording as a stream: columns become channels in inside units, stamps become a time base, sample blocks go to sinks.

use super::plan::{Plan, TimeBaseSpec, prepare};
use super::row_clock::{RowClock, TimeSpan};
use super::{FileFacts, IngestError, IngestErrorKind, PartFacts, Source};
use crate::clock::{Cadence, Measured};
use crate::value_checks::{ValueChecks, ValueFacts, min_samples_for};
use sagnac_core::message::{Note, note};
use sagnac_core::recording::integrity::{Fault, Integrity, OF_ROWS, OF_STAMPS, OF_VALUES};
use sagnac_core::recording::{Channel, Role, Sink};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// A channel of a recording that was streamed to its end.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelFacts {
    /// Id of the channel.
    pub id: String,
    /// Name of its column in the file.
    pub column: String,
    /// Role.
    pub role: Role,
    /// Unit in the file.
    pub unit: String,
    /// Unit in which it is analysed.
    pub unit_inside: String,
    /// Statistics of the values, in that unit.
    pub values: ValueFacts,
}

/// One file of a recording that was streamed to its end.
#[derive(Debug, Clone, PartialEq)]
pub struct FileReport {
    /// The file.
    pub path: PathBuf,
    /// Phase of the test that it belongs to, where a manifest says it.
    pub phase: Option<String>,
    /// Hash, size and rows.
    pub facts: FileFacts,
    /// Rows of the recording before this file.
    pub rows_before: u64,
    /// Mean interval within the file, s.
    pub sample_interval_s: f64,
    /// Start, RFC 3339, where the stamps are known to count from 1970.
    pub start: Option<String>,
    /// Last stamp minus first stamp plus one interval, s.
    pub duration_s: f64,
}

/// Facts about a recording that was streamed to its end: hash, faults, time base, channels.
#[derive(Debug, Clone, PartialEq)]
pub struct StreamReport {
    /// Hash, size and rows of the file.
    pub facts: FileFacts,
    /// Faults.
    pub integrity: Integrity,
    /// Interval found from the first rows, or declared, s; angle increments are divided by it.
    pub tau0_nominal_s: f64,
    /// Mean sample interval between gaps, s; the nominal one without stamps.
    pub tau0_measured_s: f64,
    /// Standard deviation of the stamps about a locally uniform clock, s.
    pub jitter_s: Option<f64>,
    /// First stamp, s; 0 without stamps.
    pub first_stamp_s: f64,
    /// Last stamp, s, on a scale without the jumps of a clock that was set.
    pub last_stamp_s: f64,
    /// Last stamp minus first stamp plus one interval, s.
    pub duration_s: f64,
    /// Start of the recording, RFC 3339, where the stamps are known to count from 1970.
    pub start: Option<String>,
    /// The interval measured by regression of the stamps, with its uncertainty and drift, where there are stamps.
    pub clock: Option<Measured>,
    /// Remarks on the time base, for the report.
    pub notes: Vec<Note>,
    /// Times at which samples go on after a pause of the test, s from the start of the recording.
    pub pauses_end_s: Vec<f64>,
    /// The files, in order: one, unless several were joined.
    pub files: Vec<FileReport>,
    /// Rows of the recording.
    pub rows: u64,
    /// Rows that were passed on to the sinks; the others have no usable stamp.
    pub rows_used: u64,
    /// Channels, in the order given.
    pub channels: Vec<ChannelFacts>,
}

impl Plan<'_> {
    /// Reads the recording to its end. Every sink receives every block of samples; `progress` receives the bytes read so
    /// far and in all.
    ///
    /// # Errors
    /// Errors of [`Source::read`], and a recording without a usable row.
    pub fn stream(
        &self,
        sinks: &mut [&mut dyn Sink],
        progress: &mut dyn FnMut(u64, u64),
    ) -> Result<StreamReport, IngestError> {
        let mut state = RowClock::new(self);
        let mut parts: Vec<PartFacts> = Vec::new();
        let total = self.source.bytes();
        let facts = self.source.read_parts(
            &self.wanted,
            &mut |block| {
                state.block(block, sinks);
                progress(block.bytes_done.min(total), total);
                ControlFlow::Continue(())
            },
            &mut |_, part| parts.push(part),
        )?;
        let Some(facts) = facts.filter(|_| state.used > 0) else {
            return Err(IngestError::new(
                IngestErrorKind::Empty,
                self.source.path(),
                "ingest.nothing_usable",
            )
            .hint("ingest.hint.check_time_column"));
        };
        Ok(state.report(facts, parts))
    }
}

/// Checks that were made: one that had nothing to look at, or too little, found nothing and says nothing.
fn examined(plan: &Plan<'_>, values: &[ValueFacts], rows: u64) -> Vec<String> {
    let gyros = plan.channels.iter().zip(values).filter(|(c, _)| c.role.is_gyro());
    let samples = gyros.map(|(_, v)| v.count).min().unwrap_or(0);
    let mut out: Vec<&str> = vec![];
    if rows > 0 {
        out.extend(OF_ROWS);
    }
    if rows > 1 && (plan.time.is_some() || plan.counter.is_some()) {
        out.extend(OF_STAMPS);
    }
    out.extend(OF_VALUES.iter().filter(|id| samples >= min_samples_for(id)));
    out.into_iter().map(str::to_owned).collect()
}

impl RowClock<'_> {
    fn report(mut self, facts: FileFacts, parts: Vec<PartFacts>) -> StreamReport {
        let plan = self.plan;
        let clock = self.measured();
        let checks = std::mem::replace(&mut self.checks, ValueChecks::new(&[], 1.0));
        let (values, faults) = checks.finish(&mut self.log);
        let nominal = plan.clock.interval_s;
        let measured = clock.map(|c| c.interval_s).filter(|i| i.is_normal() && *i > 0.0).unwrap_or(nominal);
        let TimeSpan { first_s: first, last_s: last } = self.span(measured);
        let mut integrity = std::mem::take(&mut self.integrity);
        integrity.outliers = faults.outliers;
        integrity.saturated = faults.saturated;
        integrity.stuck = faults.stuck;
        integrity.repeated = faults.repeated;
        integrity.outlier_threshold = faults.outlier_threshold;
        integrity.timestamp_jitter_s = self.jitter_s();
        integrity.quantization_step_deg_h = values.iter().find_map(|v| v.quantization_step);
        integrity.implausible = self.plausible.count();
        let cut_off = plan.source.cut_off();
        integrity.cut_off = cut_off.len() as u64;
        for note in cut_off {
            // The end is missing: the place is the last row there is.
            self.log.push("cut_off", None, None, facts.rows, 1, || note.clone());
        }
        for block in plan.source.bad_blocks() {
            integrity.implausible += block.rows;
            self.log.push("implausible", None, None, block.first_row, block.rows, || block.note.clone());
        }
        integrity.examined = examined(plan, &values, facts.rows);
        integrity.faults = std::mem::take(&mut self.log).into_list();
        let files = self.files(&facts, parts, measured);
        for fault in &mut integrity.faults {
            locate(&files, fault);
        }
        let notes = self.notes(nominal, measured, integrity.rollovers);
        let channels = plan
            .channels
            .iter()
            .zip(values)
            .enumerate()
            .map(|(slot, (c, values))| ChannelFacts {
                id: c.id.clone(),
                column: plan.column_name(slot).to_owned(),
                role: c.role,
                unit: c.unit.text().to_owned(),
                unit_inside: match c.role {
                    Role::AngleIncrement | Role::AccumulatedAngle => "deg/h".to_owned(),
                    role => role.internal_unit().map_or_else(|| c.unit.text().to_owned(), str::to_owned),
                },
                values,
            })
            .collect();
        StreamReport {
            rows: facts.rows,
            facts,
            jitter_s: integrity.timestamp_jitter_s,
            integrity,
            tau0_nominal_s: nominal,
            tau0_measured_s: measured,
            first_stamp_s: first,
            last_stamp_s: last,
            duration_s: last - first + measured,
            start: plan.absolute_start(first).or_else(|| plan.source.stated_start()),
            clock,
            notes,
            pauses_end_s: std::mem::take(&mut self.pauses.ends_s),
            files,
            rows_used: self.used,
            channels,
        }
    }

    /// Remarks on the time base, for the report.
    fn notes(&self, nominal: f64, measured: f64, rollovers: u64) -> Vec<Note> {
        let clock = self.plan.clock;
        let mut notes = Vec::new();
        if let Some(other) = clock.ambiguous_with_s {
            let note = note!("time_base.ambiguous", interval_s = clock.interval_s);
            notes.push(note.with("other_s", other));
        }
        match clock.cadence {
            Cadence::Even => {}
            Cadence::Uneven => notes.push(note!("time_base.uneven")),
            Cadence::Bunched { period_s, rows } => {
                notes.push(note!("time_base.bunched", rows, period_s));
            }
            Cadence::Buffered { rows, spread_s, .. } => {
                notes.push(note!("time_base.buffered", hz = 1.0 / measured, rows, spread_s))
            }
        }
        if rollovers > 0 {
            notes.push(note!("time_base.rollovers", count = rollovers));
        }
        let pauses = self.pauses.ends_s.len();
        if pauses > 0 {
            notes.push(note!("time_base.pauses", count = pauses));
        }
        let off = measured / nominal - 1.0;
        if off.abs() > 1e-6
            && self.measured().is_some_and(|m| (measured - nominal).abs() > 5.0 * m.uncertainty_s)
        {
            notes.push(note!("time_base.first_rows", ppm = off * 1e6));
        }
        notes
    }

    /// Facts about each file.
    fn files(&self, facts: &FileFacts, parts: Vec<PartFacts>, measured: f64) -> Vec<FileReport> {
        let source = self.plan.source;
        let parts =
            if parts.is_empty() { vec![PartFacts { facts: facts.clone(), rows_before: 0 }] } else { parts };
        let paths = source.files();
        let TimeSpan { first_s: first, last_s: last } = self.span(measured);
        let several = parts.len() > 1;
        parts
            .into_iter()
            .enumerate()
            .map(|(i, part)| {
                let span = self.spans.iter().find(|s| s.part == i);
                let (from, to, samples) = match span.filter(|_| several) {
                    Some(s) => (s.first_s, s.last_s, s.last_index.saturating_sub(s.first_index)),
                    None if several => (first, first - measured, 0),
                    None => (first, last, 0),
                };
                let sample_interval_s = if samples > 1 { (to - from) / samples as f64 } else { measured };
                FileReport {
                    path: paths.get(i).map(|p| p.to_path_buf()).unwrap_or_default(),
                    phase: source.phase(i).map(str::to_owned),
                    facts: part.facts,
                    rows_before: part.rows_before,
                    sample_interval_s,
                    start: self.plan.absolute_start(from),
                    duration_s: to - from + measured,
                }
            })
            .collect()
    }
}

/// Replaces the row of a fault by its file and the row in that file, for a recording of several files.
pub fn locate(files: &[FileReport], fault: &mut Fault) {
    if files.len() < 2 || fault.file.is_some() {
        return;
    }
    if let Some(file) = files.iter().rev().find(|f| f.rows_before < fault.row) {
        fault.file = Some(file.path.display().to_string());
        fault.row -= file.rows_before;
    }
}

/// Calls [`prepare`] and [`Plan::stream`].
///
/// # Errors
/// Those of both.
pub fn stream(
    source: &Source,
    channels: &[Channel],
    spec: TimeBaseSpec,
    sinks: &mut [&mut dyn Sink],
    progress: &mut dyn FnMut(u64, u64),
) -> Result<StreamReport, IngestError> {
    prepare(source, channels, spec)?.stream(sinks, progress)
}

/// Calls [`super::open`] and [`stream()`].
///
/// # Errors
/// Those of both.
pub fn stream_path(
    path: &Path,
    channels: &[Channel],
    spec: TimeBaseSpec,
    sinks: &mut [&mut dyn Sink],
    progress: &mut dyn FnMut(u64, u64),
) -> Result<StreamReport, IngestError> {
    stream(&super::open(path)?, channels, spec, sinks, progress)
}

#[cfg(test)]
#[path = "stream_tests.rs"]
mod tests;
