//! Rows put on the grid of the recording: by their stamps, by a counter, or by their number.

use super::Block;
use super::angle_differences::{AngleRollover, Angles};
use super::pauses::Paused;
use super::plan::Plan;
use crate::clock::{Cadence, CounterStep, CounterTracker, Measured, Rollover, Step, Tracker, Unwrapper};
use crate::faults::FaultLog;
use crate::value_checks::ValueChecks;
use crate::value_checks::plausible::Plausible;
use sagnac_core::message::{Arg, Note, note};
use sagnac_core::numeric::range::settled;
use sagnac_core::recording::integrity::Integrity;
use sagnac_core::recording::{SampleBlock, Sink};

/// The samples of one file.
pub(super) struct FileSpan {
    pub part: usize,
    pub first_index: u64,
    pub last_index: u64,
    pub first_s: f64,
    pub last_s: f64,
}

/// First and last time of a recording, s.
pub(super) struct TimeSpan {
    pub first_s: f64,
    pub last_s: f64,
}

/// State that goes along while a recording is read.
pub(super) struct RowClock<'a> {
    pub plan: &'a Plan<'a>,
    pub tracker: Tracker,
    counter: CounterTracker,
    rollover: Unwrapper,
    counts: Unwrapper,
    pub checks: ValueChecks,
    pub plausible: Plausible,
    pub log: FaultLog,
    pub integrity: Integrity,
    pub pauses: Paused,
    /// Grid position of the next sample.
    pub index: u64,
    pub used: u64,
    /// True when the next sample follows the last one passed on.
    connected: bool,
    scratch: Vec<Vec<f64>>,
    part: usize,
    pub spans: Vec<FileSpan>,
    /// Added to the stamps of a file that follows the one before whatever its stamps are.
    shift_s: f64,
    /// The first row of the block was placed by its file.
    joined: bool,
    angles: Angles,
    /// The next sample block of differences begins a stretch.
    broken: bool,
    /// Losses of the plan that were reported.
    lost: usize,
}

impl<'a> RowClock<'a> {
    pub fn new(plan: &'a Plan<'a>) -> RowClock<'a> {
        RowClock {
            plan,
            tracker: Tracker::new(plan.clock),
            counter: CounterTracker::new(plan.clock.interval_s),
            rollover: plan.rollover.clone(),
            counts: Unwrapper::of_counter(plan.counter_modulus),
            checks: ValueChecks::new(plan.channels, plan.clock.interval_s),
            plausible: Plausible::new(plan.channels, plan.clock.interval_s),
            log: FaultLog::default(),
            integrity: Integrity::default(),
            pauses: Paused::new(plan.pauses),
            index: 0,
            used: 0,
            connected: false,
            scratch: Vec::new(),
            part: 0,
            spans: Vec::new(),
            shift_s: 0.0,
            joined: false,
            angles: Angles::new(plan),
            broken: false,
            lost: 0,
        }
    }

    pub fn block(&mut self, block: &mut Block, sinks: &mut [&mut dyn Sink]) {
        for (column, conversion) in block.columns.iter_mut().zip(&self.plan.conversions) {
            conversion.apply_all(column);
            column.iter_mut().for_each(|v| *v = settled(*v));
        }
        self.unwrap(block);
        if block.part != self.part {
            self.next_part(block);
        }
        self.field_faults(block);
        let mut columns = std::mem::take(&mut block.columns);
        if self.shift_s != 0.0
            && let Some(stamps) = self.plan.time.and_then(|t| columns.get_mut(t))
        {
            stamps.iter_mut().for_each(|t| *t += self.shift_s);
        }
        let first_row = block.first_row;
        match (self.plan.counter, self.plan.time) {
            (Some(counter), time) => self.counted(&columns, counter, time, first_row, sinks),
            (None, Some(time)) => self.stamped(&columns, time, first_row, sinks),
            (None, None) => {
                let time_s = self.index as f64 * self.plan.clock.interval_s;
                self.emit(&columns, first_row, time_s, sinks);
            }
        }
        if let Some(span) = self.spans.last_mut() {
            span.last_index = self.index.saturating_sub(1);
            let by_index = self.plan.start_s() + span.last_index as f64 * self.plan.clock.interval_s;
            span.last_s = match (self.plan.counter, self.plan.time) {
                (None, Some(_)) => self.tracker.latest_s().unwrap_or(by_index),
                _ => by_index,
            };
        }
        block.columns = columns;
    }

    /// Undoes roll-overs of stamps and counter and lists them.
    fn unwrap(&mut self, block: &mut Block) {
        let mut found: Vec<(Rollover, bool)> = Vec::new();
        if let Some(stamps) = self.plan.time.and_then(|t| block.columns.get_mut(t)) {
            found.extend(self.rollover.apply(stamps).into_iter().map(|r| (r, false)));
        }
        if let Some(counts) = self.plan.counter.and_then(|t| block.columns.get_mut(t)) {
            found.extend(self.counts.apply(counts).into_iter().map(|r| (r, true)));
        }
        for (rollover, counter) in found {
            self.integrity.rollovers += 1;
            let stamp = self.plan.time.and_then(|t| block.columns.get(t)?.get(rollover.at).copied());
            let at = stamp.map(|s| self.tracker.on_scale(s)).filter(|t| t.is_finite());
            let row = block.first_row + rollover.at as u64;
            let key = if counter { "time_base.counter_rollover" } else { "time_base.rollover" };
            self.log
                .push("rollover", None, at, row, 1, || Note::new(key).with("period", nano(rollover.period)));
        }
    }

    /// The first block of another file.
    fn next_part(&mut self, block: &Block) {
        self.part = block.part;
        let row = block.first_row;
        let files = self.plan.source.files();
        let name = files.get(block.part).map(|p| p.display().to_string()).unwrap_or_default();
        let first = |slot: Option<usize>| {
            slot.and_then(|t| block.columns.get(t)?.iter().copied().find(|v| v.is_finite()))
        };
        let contiguous = self.plan.source.is_contiguous();
        let pause = self.pauses.file_begins();
        if self.plan.counter.is_some() {
            if first(self.plan.counter).is_some_and(|count| self.counter.join(count)) {
                self.unknown_gap(row, None, note!("time_base.joint_counter", file = name));
            }
            return;
        }
        match first(self.plan.time) {
            Some(stamp) if contiguous => {
                // The shift of the file before no longer holds.
                self.shift_s = 0.0;
                let shift = self.tracker.shift_to_follow(stamp).unwrap_or(0.0);
                let beyond = shift.abs() > 0.5 * self.plan.clock.interval_s;
                self.shift_s = if beyond { shift } else { 0.0 };
            }
            Some(stamp) => {
                let restarted = pause && self.begins_again(stamp);
                if let Some(back_s) = self.tracker.join(stamp, restarted) {
                    let at = Some(self.tracker.on_scale(stamp));
                    if !pause {
                        self.integrity.backward_timestamps += 1;
                        let note = note!("time_base.joint_back", file = name, back_s = nano(back_s));
                        self.log.push("backward_timestamp", Some("clock"), at, row, 1, || note);
                    }
                    self.unknown_gap(row, at, note!("fault_note.gap_set_back"));
                    self.joined = true;
                }
            }
            None if self.plan.time.is_none() && !contiguous => {
                let at = Some(self.index as f64 * self.plan.clock.interval_s);
                self.unknown_gap(row, at, note!("time_base.joint_unknown", file = name));
            }
            None => {}
        }
    }

    /// True when the stamps of another file begin before the middle of the file before: a clock of its own, or files in
    /// another order. What overlaps by less are rows recorded twice.
    fn begins_again(&self, stamp: f64) -> bool {
        let before = self.spans.last().map(|s| 0.5 * (s.first_s + s.last_s));
        before.is_some_and(|middle| self.tracker.on_scale(stamp) < middle)
    }

    /// Samples are missing before a row, nobody knows how many; one place of the grid is left free.
    fn unknown_gap(&mut self, row: u64, at: Option<f64>, note: Note) {
        self.missing(1, None, row, at, note);
    }

    /// Samples are missing before a row, over a time where it is known: a pause of the test, or a gap.
    fn missing(&mut self, samples: u64, step_s: Option<f64>, row: u64, at: Option<f64>, note: Note) {
        if !self.pauses.takes(step_s) {
            self.integrity.gaps += 1;
            self.integrity.missing_samples += samples;
            self.log.push("gap", None, at, row, samples, || note);
        }
        self.index += samples;
        self.connected = false;
    }

    fn stamped(&mut self, columns: &[Vec<f64>], time: usize, first_row: u64, sinks: &mut [&mut dyn Sink]) {
        let stamps = columns.get(time).map(Vec::as_slice).unwrap_or_default();
        if self.connected && self.tracker.take_unbroken(stamps) {
            let time_s = self.tracker.on_scale(stamps.first().copied().unwrap_or(0.0));
            self.emit(columns, first_row, time_s, sinks);
            return;
        }
        let rows = stamps.len();
        let mut start = 0;
        let mut start_s = self.tracker.on_scale(stamps.first().copied().unwrap_or(0.0));
        for i in 0..rows {
            let Some(&stamp) = stamps.get(i) else { break };
            let joined = self.joined && stamp.is_finite();
            self.note_loss(first_row + i as u64);
            self.joined &= !joined;
            let step = if joined { Step::Next } else { self.tracker.step(stamp, stamps.get(i + 1).copied()) };
            if step == Step::Next && (self.connected || start < i) {
                continue;
            }
            self.part(columns, first_row, start_s, start..i, sinks);
            start = if self.account(step, first_row + i as u64, stamp) { i } else { i + 1 };
            start_s = self.tracker.on_scale(stamps.get(start).copied().unwrap_or(stamp));
        }
        self.part(columns, first_row, start_s, start..rows, sinks);
    }

    /// Tells the tracker of samples that are missing before a row.
    fn note_loss(&mut self, row: u64) {
        while let Some(loss) = self.plan.losses.get(self.lost).filter(|l| l.row <= row) {
            self.tracker.note_loss(loss.samples);
            self.lost += 1;
        }
    }

    /// Rows by a counter; stamps beside it are fitted and compared.
    fn counted(
        &mut self,
        columns: &[Vec<f64>],
        counter: usize,
        time: Option<usize>,
        first_row: u64,
        sinks: &mut [&mut dyn Sink],
    ) {
        let counts = columns.get(counter).map(Vec::as_slice).unwrap_or_default();
        let stamps = time.and_then(|t| columns.get(t)).map(Vec::as_slice).unwrap_or_default();
        let time_at = |index: u64| self.plan.start_s() + index as f64 * self.plan.clock.interval_s;
        let mut start = 0;
        for (i, &count) in counts.iter().enumerate() {
            let stamp = stamps.get(i).copied().unwrap_or(f64::NAN);
            let step = self.counter.step(count, stamp);
            let row = first_row + i as u64;
            if let Some(more_s) = self.counter.disagreement_s() {
                self.integrity.timestamp_disagreements += 1;
                self.log.push("timestamp_disagreement", None, Some(stamp), row, 1, || {
                    note!("time_base.disagreement", more_s = nano(more_s))
                });
            }
            if step == CounterStep::Next && (self.connected || start < i) {
                continue;
            }
            self.part(columns, first_row, time_at(self.index), start..i, sinks);
            start =
                if self.account_count(step, row, Some(stamp).filter(|s| s.is_finite())) { i } else { i + 1 };
        }
        self.part(columns, first_row, time_at(self.index), start..counts.len(), sinks);
    }

    fn account_count(&mut self, step: CounterStep, row: u64, at: Option<f64>) -> bool {
        match step {
            CounterStep::Next => return true,
            CounterStep::Unusable => {}
            CounterStep::Gap { missing } => {
                let note = note!("time_base.counter_gap", missing);
                let step_s = (missing as f64 + 1.0) * self.plan.clock.interval_s;
                self.missing(missing, Some(step_s), row, at, note);
                return true;
            }
            CounterStep::Restart => {
                self.unknown_gap(row, at, note!("time_base.counter_restart"));
                return true;
            }
            CounterStep::Duplicate => {
                self.integrity.duplicate_timestamps += 1;
                let note = || note!("time_base.counter_duplicate");
                self.log.push("duplicate_timestamp", None, at, row, 1, note);
            }
            CounterStep::Backward { back } => {
                self.integrity.backward_timestamps += 1;
                let note = || note!("time_base.counter_backward", back = back as u64);
                self.log.push("backward_timestamp", None, at, row, 1, note);
            }
        }
        false
    }

    /// Counts and lists what a step means; true when its row is used.
    fn account(&mut self, step: Step, row: u64, stamp: f64) -> bool {
        let at = Some(self.tracker.on_scale(stamp)).filter(|t| t.is_finite());
        match step {
            Step::Next => return true,
            Step::Unusable => {}
            Step::Gap { missing, step_s, clock_set } => {
                let key = if clock_set { "fault_note.clock_ahead" } else { "fault_note.gap" };
                let note = Note::new(key).with("step_s", nano(step_s)).with("missing", missing);
                self.missing(missing, Some(step_s), row, at, note);
                return true;
            }
            Step::SetBack { back_s } => {
                self.integrity.backward_timestamps += 1;
                self.unknown_gap(row, at, note!("fault_note.gap_set_back"));
                // One entry of its own, or it would be added to the rows set aside before it.
                self.log.push("backward_timestamp", Some("clock"), at, row, 1, || {
                    note!("fault_note.set_back", back_s = nano(back_s))
                });
                return true;
            }
            Step::Duplicate => {
                self.integrity.duplicate_timestamps += 1;
                self.log.push("duplicate_timestamp", None, at, row, 1, || note!("fault_note.duplicate"));
            }
            Step::Backward { back_s } => {
                self.integrity.backward_timestamps += 1;
                self.log.push("backward_timestamp", None, at, row, 1, || {
                    note!("fault_note.backward", back_s = nano(back_s))
                });
            }
            Step::Stray { ahead_s } => {
                self.integrity.backward_timestamps += 1;
                self.log.push("backward_timestamp", None, at, row, 1, || {
                    note!("fault_note.stray", ahead_s = nano(ahead_s))
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

    /// Passes rows on; of accumulated angles, their differences.
    fn emit(&mut self, values: &[Vec<f64>], first_row: u64, time_s: f64, sinks: &mut [&mut dyn Sink]) {
        let time_s = match self.plan.clock.cadence {
            Cadence::Buffered { .. } if self.plan.counter.is_none() => {
                self.plan.start_s() + self.index as f64 * self.plan.clock.interval_s
            }
            _ => time_s,
        };
        if values.first().is_none_or(Vec::is_empty) {
            return;
        }
        if self.spans.last().is_none_or(|s| s.part != self.part) {
            let (first_index, part) = (self.index, self.part);
            let first_s = if self.plan.time.is_some() { time_s } else { self.plan.start_s() + time_s };
            self.spans.push(FileSpan {
                part,
                first_index,
                last_index: first_index,
                first_s,
                last_s: first_s,
            });
        }
        if self.angles.is_empty() {
            self.pass_on(values, first_row, time_s, sinks);
            return;
        }
        // The first row of a stretch has no angle before it.
        let skipped = usize::from(!self.connected);
        let (rates, wraps) = self.angles.differences(values, !self.connected);
        for AngleRollover { row: at, slot, period } in wraps {
            self.integrity.rollovers += 1;
            let id = self.plan.channels.get(slot).map(|c| c.id.as_str());
            let note = || note!("time_base.angle_rollover", period_deg = period / 3600.0);
            self.log.push("rollover", id, Some(time_s), first_row + at as u64, 1, note);
        }
        if skipped > 0 {
            self.index += 1;
            self.broken = true;
        }
        if rates.first().is_some_and(|r| !r.is_empty()) {
            let follows = self.connected && !std::mem::take(&mut self.broken);
            self.connected = follows;
            let time_s = time_s + skipped as f64 * self.plan.clock.interval_s;
            self.pass_on(&rates, first_row + skipped as u64, time_s, sinks);
        }
        self.connected = true;
    }

    fn pass_on(&mut self, values: &[Vec<f64>], first_row: u64, time_s: f64, sinks: &mut [&mut dyn Sink]) {
        let sample_block =
            SampleBlock { first_index: self.index, first_row, time_s, continues: self.connected, values };
        self.pauses.passed(time_s - self.plan.start_s());
        self.checks.push(&sample_block);
        self.plausible.push(&sample_block, &mut self.log);
        for sink in sinks {
            sink.push(&sample_block);
        }
        self.index += sample_block.len() as u64;
        self.used += sample_block.len() as u64;
        self.connected = true;
    }

    /// The clock as fitted, where stamps were.
    pub fn measured(&self) -> Option<Measured> {
        self.plan.time?;
        if self.plan.counter.is_some() { self.counter.measured() } else { self.tracker.measured() }
    }

    /// Jitter of the stamps.
    pub fn jitter_s(&self) -> Option<f64> {
        self.plan.time?;
        match self.plan.counter {
            Some(_) => self.counter.measured().map(|m| m.residual_s),
            None => self.tracker.jitter_s(),
        }
    }

    /// First and last time, s.
    pub fn span(&self, measured: f64) -> TimeSpan {
        let samples = self.index.saturating_sub(1) as f64;
        if self.plan.time.is_some() && self.plan.counter.is_none() {
            let first = self.tracker.first_s().unwrap_or(0.0);
            let last = self.tracker.latest_s().unwrap_or(first + samples * measured);
            return TimeSpan { first_s: first, last_s: last };
        }
        let first = self.counter.first_s().unwrap_or(0.0);
        TimeSpan { first_s: first, last_s: first + samples * measured }
    }
}

/// Rounds a time that is shown to nanoseconds.
fn nano(time_s: f64) -> Arg {
    let rounded = (time_s * 1e9).round() / 1e9;
    Arg::Stated(if rounded.is_finite() { rounded } else { time_s })
}
