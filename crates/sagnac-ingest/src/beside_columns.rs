//! Columns of second files read as if they stood in the recording: interpolated at its stamps, block by block.

use crate::stamp_column::Stamps;
use crate::{Block, FieldFault, FieldFaultKind, FileFacts, IngestError, OnBlock};
use std::path::PathBuf;
use std::sync::Arc;

/// Longest time between two samples of a second file across which it is interpolated, in its middle steps.
pub(crate) const MAX_STEPS_APART: f64 = 5.0;

/// A standard uncertainty of the clock of a file beside a recording, in one of the two ways in which a clock can be wrong.
#[derive(Debug, Clone, PartialEq)]
pub struct ClockUncertainty {
    /// The file.
    pub file: PathBuf,
    /// Position of the file among those beside the recording, from 0.
    position: usize,
    /// Its offset, s; 0 where the rate is meant.
    pub offset_s: f64,
    /// Its rate about the middle of what ties it, relative; 0 where the offset is meant.
    pub rate: f64,
    /// Estimated from the data, not stated.
    pub estimated: bool,
}

/// Standard uncertainty of the tie between the clock of a file and that of the recording.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct TieUncertainty {
    /// Of the offset, s.
    pub offset_s: f64,
    /// Of the rate.
    pub rate: f64,
    /// Time of the recording about which the rate is uncertain, s.
    pub about_s: f64,
}

/// The columns of second files beside those of a recording.
#[derive(Clone)]
pub(crate) struct Beside {
    /// Number of the recording's own columns.
    pub own: usize,
    /// Its stamps.
    pub stamps: Stamps,
    /// The columns of each file, in order.
    pub files: Vec<Track>,
}

/// The columns of one second file.
#[derive(Clone)]
pub(crate) struct Track {
    /// The file.
    pub file: PathBuf,
    /// How well its clock is known.
    pub uncertainty: TieUncertainty,
    /// Stamps of its rows on the clock of the recording, s, increasing.
    pub at_s: Vec<f64>,
    /// Longest time between two rows across which values are interpolated, s.
    pub longest_s: f64,
    /// The values, by column.
    pub values: Arc<Vec<Vec<f64>>>,
}

impl Track {
    /// The value of a column at a time; `None` in a gap and beyond the ends.
    fn at(&self, column: usize, t: f64) -> Option<f64> {
        let values = self.values.get(column)?;
        let after = self.at_s.partition_point(|s| *s < t);
        let (Some(t1), Some(v1)) = (self.at_s.get(after), values.get(after)) else {
            // Behind the last row its value holds for one step.
            let (last_s, last) = self.at_s.last().zip(values.last())?;
            return (t - last_s <= self.longest_s / MAX_STEPS_APART).then_some(*last);
        };
        let before = after.checked_sub(1).and_then(|i| self.at_s.get(i).zip(values.get(i)));
        let Some((t0, v0)) = before else {
            return (t1 - t <= self.longest_s / MAX_STEPS_APART).then_some(*v1);
        };
        (t1 - t0 <= self.longest_s).then(|| v0 + (v1 - v0) * (t - t0) / (t1 - t0))
    }
}

impl Beside {
    /// What is known of the uncertainty of the clocks.
    pub fn uncertainties(&self) -> Vec<ClockUncertainty> {
        let of = |(position, track): (usize, &Track)| {
            let estimated = track.uncertainty.rate > 0.0;
            let is = |offset_s: f64, rate: f64| ClockUncertainty {
                estimated,
                file: track.file.clone(),
                position,
                offset_s,
                rate,
            };
            [is(track.uncertainty.offset_s, 0.0), is(0.0, track.uncertainty.rate)]
        };
        let all = self.files.iter().enumerate().flat_map(of);
        all.filter(|u| u.offset_s > 0.0 || u.rate > 0.0).collect()
    }

    /// The columns with the clock of a file moved by an uncertainty, times a factor.
    pub fn moved(&self, by: &ClockUncertainty, factor: f64) -> Beside {
        let mut moved = self.clone();
        if let Some(track) = moved.files.get_mut(by.position) {
            let about_s = track.uncertainty.about_s;
            track.at_s.iter_mut().for_each(|t| *t += factor * (by.offset_s + by.rate * (*t - about_s)));
        }
        moved
    }

    /// Reads columns of the recording and of the files beside it. `read`: reads those of the recording alone.
    ///
    /// # Errors
    /// As `read`.
    pub fn read(
        &self,
        wanted: &[usize],
        on_block: &mut OnBlock<'_>,
        read: impl FnOnce(&[usize], &mut OnBlock<'_>) -> Result<Option<FileFacts>, IngestError>,
    ) -> Result<Option<FileFacts>, IngestError> {
        let mut own: Vec<usize> = wanted.iter().copied().filter(|w| *w < self.own).collect();
        if own.len() == wanted.len() {
            return read(wanted, on_block);
        }
        own.push(self.stamps.column);
        let (mut unwrapper, mut part) = (self.stamps.unwrapper(), 0);
        read(&own, &mut |block| {
            if block.part != part {
                // The stamps of each file start anew.
                (unwrapper, part) = (self.stamps.unwrapper(), block.part);
            }
            let mut stamps = block.columns.pop().unwrap_or_default();
            self.stamps.seconds(&mut stamps, &mut unwrapper);
            self.widen(block, wanted, &stamps);
            let flow = on_block(block);
            // The reader goes on with the columns that it knows.
            block.columns.resize_with(own.len(), Vec::new);
            flow
        })
    }

    /// Puts the values of the files beside the recording where they are wanted. `stamps`: of the rows of the block, s.
    fn widen(&self, block: &mut Block, wanted: &[usize], stamps: &[f64]) {
        let mut own = std::mem::take(&mut block.columns).into_iter();
        let faults = std::mem::take(&mut block.faults);
        let counts = (std::mem::take(&mut block.non_finite), std::mem::take(&mut block.unparsable));
        let mut places = Vec::new();
        for (slot, w) in wanted.iter().enumerate() {
            block.non_finite.push(0);
            block.unparsable.push(0);
            if *w < self.own {
                let from = places.len();
                let of = |counts: &[u64]| counts.get(from).copied().unwrap_or(0);
                if let (Some(n), Some(u)) = (block.non_finite.last_mut(), block.unparsable.last_mut()) {
                    (*n, *u) = (of(&counts.0), of(&counts.1));
                }
                block.columns.push(own.next().unwrap_or_default());
                places.push(slot);
                continue;
            }
            let values: Vec<f64> = stamps.iter().map(|t| self.value(*w, *t).unwrap_or(f64::NAN)).collect();
            for (row, _) in (block.first_row..).zip(&values).filter(|(_, v)| !v.is_finite()) {
                let fault = || FieldFault {
                    slot,
                    row,
                    line: 0,
                    character: 0,
                    kind: FieldFaultKind::NonFinite,
                    text: String::new(),
                };
                block.fault(fault, slot, FieldFaultKind::NonFinite);
            }
            block.columns.push(values);
        }
        block
            .faults
            .extend(faults.into_iter().filter_map(|f| Some(FieldFault { slot: *places.get(f.slot)?, ..f })));
    }

    /// The value of a column of the files at a time of the recording.
    fn value(&self, column: usize, t: f64) -> Option<f64> {
        let mut column = column.checked_sub(self.own)?;
        for file in &self.files {
            if column < file.values.len() {
                return file.at(column, t);
            }
            column -= file.values.len();
        }
        None
    }
}
