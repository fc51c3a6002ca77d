//! What stands between every reader and its consumer: refusing a column that is no column of numbers, and giving one
//! column to several takers.

use super::error::{IngestError, IngestErrorKind};
use super::{Block, Column, FieldFault, FieldFaultKind};
use sagnac_core::message::note;
use std::path::Path;

/// Rows from which it is judged whether a column holds numbers at all.
const JUDGED_ROWS: u64 = 1000;

/// Watches the first rows of every wanted column.
pub(super) struct NumericCheck {
    rows: u64,
    bad: Vec<u64>,
    first: Vec<Option<FieldFault>>,
    done: bool,
}

impl NumericCheck {
    pub(super) fn new(slots: usize) -> NumericCheck {
        NumericCheck { rows: 0, bad: vec![0; slots], first: vec![None; slots], done: false }
    }

    /// The first bad field of each column of which more than half of the first rows are no numbers.
    pub(super) fn judge(&mut self, block: &Block) -> Vec<FieldFault> {
        if self.done {
            return vec![];
        }
        let left = JUDGED_ROWS - self.rows;
        let rows = block.rows() as u64;
        let last_row = block.first_row + left.min(rows);
        let mut listed = vec![0u64; self.bad.len()];
        for fault in block.faults.iter().filter(|f| f.kind == FieldFaultKind::Unparsable) {
            if let Some(first) = self.first.get_mut(fault.slot) {
                first.get_or_insert_with(|| fault.clone());
            }
            if let Some(listed) = listed.get_mut(fault.slot).filter(|_| fault.row < last_row) {
                *listed += 1;
            }
        }
        for (slot, (bad, listed)) in self.bad.iter_mut().zip(listed).enumerate() {
            // Only the first faults of a block are located; when the list is full the rest is taken in proportion.
            let all = block.unparsable.get(slot).copied().unwrap_or(0);
            *bad += if all <= crate::block::LOCATED_PER_BLOCK {
                listed
            } else {
                (all as f64 * left.min(rows) as f64 / rows.max(1) as f64) as u64
            };
        }
        self.rows += left.min(rows);
        if self.rows < JUDGED_ROWS {
            return vec![];
        }
        self.verdict()
    }

    /// The same for a file that ended before.
    pub(super) fn judge_at_end(&mut self) -> Vec<FieldFault> {
        if self.done { vec![] } else { self.verdict() }
    }

    fn verdict(&mut self) -> Vec<FieldFault> {
        self.done = true;
        let rows = self.rows;
        let refused = self.bad.iter().zip(&self.first).filter(|(bad, _)| **bad * 2 > rows);
        refused.filter_map(|(_, first)| first.clone()).collect()
    }
}

/// The diagnostic of a column that holds no numbers.
pub(super) fn not_numeric(
    path: &Path,
    fault: &FieldFault,
    wanted: &[usize],
    columns: &[Column],
) -> IngestError {
    let name = wanted.get(fault.slot).and_then(|&i| columns.get(i)).map_or("?", |c| c.name.as_str());
    let error = IngestError::new(IngestErrorKind::NotNumeric, path, note!("ingest.not_numeric", name))
        .found(&fault.text)
        .hint("ingest.hint.check_dialect");
    if fault.line > 0 { error.at(fault.line, Some(fault.character)) } else { error }
}

/// Turns columns read once each into columns as wanted, where one may be wanted several times.
pub(super) fn repeat_columns(block: &mut Block, slots: &[usize]) {
    if slots.len() == block.columns.len() {
        return;
    }
    let unique = std::mem::take(&mut block.columns);
    block.columns = slots.iter().filter_map(|&s| unique.get(s).cloned()).collect();
    let repeat = |counts: &[u64]| slots.iter().filter_map(|&s| counts.get(s).copied()).collect();
    block.non_finite = repeat(&block.non_finite);
    block.unparsable = repeat(&block.unparsable);
    let faults = std::mem::take(&mut block.faults);
    for (slot, source) in slots.iter().enumerate() {
        block
            .faults
            .extend(faults.iter().filter(|f| f.slot == *source).map(|f| FieldFault { slot, ..f.clone() }));
    }
}

/// Undoes the shape of [`repeat_columns`], so that the block's memory can be used again.
pub(super) fn restore_columns(block: &mut Block, unique: usize) {
    block.columns.resize_with(unique, Vec::new);
}
