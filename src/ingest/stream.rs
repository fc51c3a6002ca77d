//! A recording as a stream: columns become channels in inside units, stamps become a time base, slabs go to sinks.

use super::plan::{Plan, TimeBaseSpec, prepare};
use super::{Block, FieldFaultKind, FileFacts, IngestError, IngestErrorKind, Source};
use crate::numeric::range::settled;
use crate::record::Integrity;
use crate::recording::faults::FaultLog;
use crate::recording::integrity::{ValueChecks, ValueFacts};
use crate::recording::timebase::{Step, Tracker};
use crate::recording::{Channel, Role, Sink, Slab};
use crate::text::{Arg, Note};
use std::ops::ControlFlow;
use std::path::Path;

/// A channel after the whole recording was read.
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
    /// Unit inside.
    pub unit_inside: String,
    /// What the values are like, in the unit inside.
    pub values: ValueFacts,
}

/// What is known when a recording was read to its end.
#[derive(Debug, Clone, PartialEq)]
pub struct StreamReport {
    /// Hash, size and rows of the file.
    pub facts: FileFacts,
    /// Faults.
    pub integrity: Integrity,
    /// Interval found from the first rows, or declared, s; angle increments are divided by it.
    pub tau0_nominal_s: f64,
    /// Mean interval over the unbroken stretches, s; the nominal one without stamps.
    pub tau0_measured_s: f64,
    /// Standard deviation of the stamps about a locally uniform clock, s.
    pub jitter_s: Option<f64>,
    /// First stamp, s; 0 without stamps.
    pub first_stamp_s: f64,
    /// Last stamp, s, on a scale that goes on where the clock was set back.
    pub last_stamp_s: f64,
    /// Last stamp minus first stamp plus one interval, s.
    pub duration_s: f64,
    /// Start of the recording, RFC 3339, where the stamps are known to count from 1970.
    pub start: Option<String>,
    /// Rows in the file.
    pub rows: u64,
    /// Rows that were passed on.
    pub rows_used: u64,
    /// Channels, in the order given.
    pub channels: Vec<ChannelFacts>,
}

impl Plan<'_> {
    /// Reads the recording to its end. Every sink gets every slab; `progress` is told bytes read and bytes in all.
    ///
    /// # Errors
    /// What [`Source::read`] says, or a recording in which no row is usable.
    pub fn stream(
        &self,
        sinks: &mut [&mut dyn Sink],
        progress: &mut dyn FnMut(u64, u64),
    ) -> Result<StreamReport, IngestError> {
        let mut state = State {
            plan: self,
            tracker: Tracker::new(self.clock),
            checks: ValueChecks::new(self.channels, self.clock.interval_s),
            log: FaultLog::default(),
            integrity: Integrity::default(),
            index: 0,
            used: 0,
            connected: false,
            scratch: Vec::new(),
        };
        let total = self.source.bytes();
        let facts = self.source.read(&self.wanted, &mut |block| {
            state.block(block, sinks);
            progress(block.bytes_done.min(total), total);
            ControlFlow::Continue(())
        })?;
        let Some(facts) = facts.filter(|_| state.used > 0) else {
            return Err(IngestError::new(
                IngestErrorKind::Empty,
                self.source.path(),
                "ingest.nothing_usable",
            )
            .hint("ingest.hint.check_time_column"));
        };
        Ok(state.report(facts))
    }
}

struct State<'a> {
    plan: &'a Plan<'a>,
    tracker: Tracker,
    checks: ValueChecks,
    log: FaultLog,
    integrity: Integrity,
    /// Grid position of the next sample.
    index: u64,
    used: u64,
    /// True when the next sample follows the last one passed on.
    connected: bool,
    scratch: Vec<Vec<f64>>,
}

impl State<'_> {
    fn block(&mut self, block: &mut Block, sinks: &mut [&mut dyn Sink]) {
        for (column, &(factor, offset)) in block.columns.iter_mut().zip(&self.plan.maps) {
            if (factor, offset) == (1.0, 0.0) {
                column.iter_mut().for_each(|v| *v = settled(*v));
            } else {
                column.iter_mut().for_each(|v| *v = settled(*v * factor + offset));
            }
        }
        self.field_faults(block);
        let rows = block.rows();
        let Some(time) = self.plan.time else {
            let time_s = self.index as f64 * self.plan.clock.interval_s;
            self.emit(&block.columns, block.first_row, time_s, sinks);
            return;
        };
        let columns = std::mem::take(&mut block.columns);
        let stamps = columns.get(time).map(Vec::as_slice).unwrap_or_default();
        if self.connected && self.tracker.take_unbroken(stamps) {
            let time_s = self.tracker.on_scale(stamps.first().copied().unwrap_or(0.0));
            self.emit(&columns, block.first_row, time_s, sinks);
        } else {
            let mut start = 0;
            let mut start_s = self.tracker.on_scale(stamps.first().copied().unwrap_or(0.0));
            for i in 0..rows {
                let Some(&stamp) = stamps.get(i) else { break };
                let step = self.tracker.step(stamp, stamps.get(i + 1).copied());
                if step == Step::Next && (self.connected || start < i) {
                    continue;
                }
                self.part(&columns, block.first_row, start_s, start..i, sinks);
                start = if self.account(step, block.first_row + i as u64, stamp) { i } else { i + 1 };
                start_s = self.tracker.on_scale(stamps.get(start).copied().unwrap_or(stamp));
            }
            self.part(&columns, block.first_row, start_s, start..rows, sinks);
        }
        block.columns = columns;
    }

    /// Counts and lists what a step means; true when its row is used.
    fn account(&mut self, step: Step, row: u64, stamp: f64) -> bool {
        let integrity = &mut self.integrity;
        let at = Some(self.tracker.on_scale(stamp)).filter(|t| t.is_finite());
        match step {
            Step::Next => return true,
            Step::Unusable => {}
            Step::Gap { missing, step_s, clock_set } => {
                integrity.gaps += 1;
                integrity.missing_samples += missing;
                self.index += missing;
                self.connected = false;
                self.log.push("gap", None, at, row, missing, || {
                    let note = if clock_set { "fault_note.clock_ahead" } else { "fault_note.gap" };
                    Note::new(note).with("step_s", nano(step_s)).with("missing", missing)
                });
                return true;
            }
            Step::SetBack { back_s } => {
                integrity.backward_timestamps += 1;
                integrity.gaps += 1;
                integrity.missing_samples += 1;
                self.index += 1;
                self.connected = false;
                self.log.push("gap", None, at, row, 1, || Note::new("fault_note.gap_set_back"));
                // One entry of its own, or it would be added to the rows set aside before it.
                self.log.push("backward_timestamp", Some("clock"), at, row, 1, || {
                    Note::new("fault_note.set_back").with("back_s", nano(back_s))
                });
                return true;
            }
            Step::Duplicate => {
                integrity.duplicate_timestamps += 1;
                self.log.push("duplicate_timestamp", None, at, row, 1, || Note::new("fault_note.duplicate"));
            }
            Step::Backward { back_s } => {
                integrity.backward_timestamps += 1;
                self.log.push("backward_timestamp", None, at, row, 1, || {
                    Note::new("fault_note.backward").with("back_s", nano(back_s))
                });
            }
            Step::Stray { ahead_s } => {
                integrity.backward_timestamps += 1;
                self.log.push("backward_timestamp", None, at, row, 1, || {
                    Note::new("fault_note.stray").with("ahead_s", nano(ahead_s))
                });
            }
        }
        false
    }

    /// Passes some rows of a block on.
    fn part(
        &mut self,
        columns: &[Vec<f64>],
        first_row: u64,
        time_s: f64,
        range: std::ops::Range<usize>,
        sinks: &mut [&mut dyn Sink],
    ) {
        if range.is_empty() {
            return;
        }
        let mut scratch = std::mem::take(&mut self.scratch);
        scratch.resize_with(columns.len(), Vec::new);
        for (part, column) in scratch.iter_mut().zip(columns) {
            part.clear();
            part.extend_from_slice(column.get(range.clone()).unwrap_or_default());
        }
        self.emit(&scratch, first_row + range.start as u64, time_s, sinks);
        self.scratch = scratch;
    }

    fn emit(&mut self, values: &[Vec<f64>], first_row: u64, time_s: f64, sinks: &mut [&mut dyn Sink]) {
        let slab = Slab { first_index: self.index, first_row, time_s, continues: self.connected, values };
        self.checks.push(&slab);
        for sink in sinks {
            sink.push(&slab);
        }
        self.index += slab.len() as u64;
        self.used += slab.len() as u64;
        self.connected = true;
    }

    fn field_faults(&mut self, block: &Block) {
        self.integrity.non_finite += block.non_finite.iter().sum::<u64>();
        self.integrity.unparsable += block.unparsable.iter().sum::<u64>();
        for fault in &block.faults {
            let row = usize::try_from(fault.row.saturating_sub(block.first_row)).unwrap_or(usize::MAX);
            let stamp = match self.plan.time {
                Some(t) => block.columns.get(t).and_then(|c| c.get(row)).map(|s| self.tracker.on_scale(*s)),
                None => Some((fault.row - 1) as f64 * self.plan.clock.interval_s),
            };
            let (kind, word) = match fault.kind {
                FieldFaultKind::NonFinite if fault.text.trim().parse().is_ok_and(f64::is_finite) => {
                    ("non_finite", "fault_note.too_large")
                }
                FieldFaultKind::NonFinite => ("non_finite", "fault_note.no_finite_number"),
                FieldFaultKind::Unparsable => ("unparsable", "fault_note.no_number"),
            };
            let channel = self.plan.channels.get(fault.slot).map(|c| c.id.as_str());
            self.log.push(kind, channel, stamp.filter(|s| s.is_finite()), fault.row, 1, || {
                let place = if fault.line > 0 {
                    Note::new("fault_note.place").with("line", fault.line).with("character", fault.character)
                } else {
                    Note::new("fault_note.no_place")
                };
                Note::new("fault_note.field")
                    .with("what", Note::new(word))
                    .with("column", self.plan.column_name(fault.slot))
                    .with("place", place)
                    .with("text", format!("`{}`", fault.text))
            });
        }
    }

    fn report(mut self, facts: FileFacts) -> StreamReport {
        let plan = self.plan;
        let (values, faults) = self.checks.finish(&mut self.log);
        let nominal = plan.clock.interval_s;
        let stamped = plan.time.is_some();
        let measured = if stamped { self.tracker.mean_interval_s() } else { nominal };
        let first = self.tracker.first_s().unwrap_or(0.0);
        let last = self.tracker.latest_s().unwrap_or_else(|| self.index.saturating_sub(1) as f64 * nominal);
        let mut integrity = self.integrity;
        integrity.outliers = faults.outliers;
        integrity.saturated = faults.saturated;
        integrity.stuck = faults.stuck;
        integrity.outlier_threshold = faults.outlier_threshold;
        integrity.timestamp_jitter_s = if stamped { self.tracker.jitter_s() } else { None };
        integrity.quantization_step_deg_h = values.iter().find_map(|v| v.quantization_step);
        integrity.faults = self.log.into_list();
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
                    Role::AngleIncrement => "deg/h".to_owned(),
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
            start: plan.absolute_start(first),
            rows_used: self.used,
            channels,
        }
    }
}

/// Rounds a time that is shown to nanoseconds.
fn nano(time_s: f64) -> Arg {
    let rounded = (time_s * 1e9).round() / 1e9;
    Arg::Stated(if rounded.is_finite() { rounded } else { time_s })
}

/// [`prepare`] and [`Plan::stream`] in one.
///
/// # Errors
/// As both.
pub fn stream(
    source: &Source,
    channels: &[Channel],
    spec: TimeBaseSpec,
    sinks: &mut [&mut dyn Sink],
    progress: &mut dyn FnMut(u64, u64),
) -> Result<StreamReport, IngestError> {
    prepare(source, channels, spec)?.stream(sinks, progress)
}

/// [`super::open`] and [`stream`] in one.
///
/// # Errors
/// As both.
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
