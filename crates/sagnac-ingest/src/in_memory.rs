//! A recording in memory, delivered in blocks as a file would be.

use super::error::{IngestError, IngestErrorKind};
use super::{Block, Column, FieldFault, FieldFaultKind, FileFacts, OnBlock, Opened, Table};
use sagnac_core::numeric::range::usable;
use std::ops::Range;
use std::path::Path;

/// Values of a column in memory, read in blocks: the memory of another library is used as it stands, without a copy of the whole.
pub trait MemoryValues: Send + Sync {
    /// Number of rows.
    fn rows(&self) -> usize;

    /// Appends the values of some rows; NaN where there is none.
    fn append(&self, rows: Range<usize>, to: &mut Vec<f64>);
}

impl MemoryValues for Vec<f64> {
    fn rows(&self) -> usize {
        self.len()
    }

    fn append(&self, rows: Range<usize>, to: &mut Vec<f64>) {
        to.extend_from_slice(self.get(rows).unwrap_or_default());
    }
}

/// A column in memory.
pub struct MemoryColumn {
    /// Name, which tells quantity and unit as in a file.
    pub name: String,
    /// The values.
    pub values: Box<dyn MemoryValues>,
    /// Time that the values count from, s since 1970-01-01T00:00:00Z, where they are stamps with a date; their unit is then s.
    pub epoch_s: Option<f64>,
}

impl MemoryColumn {
    /// Numbers under a name.
    pub fn new(name: impl Into<String>, values: impl MemoryValues + 'static) -> MemoryColumn {
        MemoryColumn { name: name.into(), values: Box::new(values), epoch_s: None }
    }
}

/// Size of columns of numbers, bytes.
pub(super) fn bytes(rows: u64, columns: usize) -> u64 {
    rows.saturating_mul(columns as u64).saturating_mul(size_of::<f64>() as u64)
}

struct Memory {
    columns: Vec<Box<dyn MemoryValues>>,
    block_rows: usize,
}

/// Opens named columns.
pub(super) fn open(
    path: &Path,
    columns: Vec<MemoryColumn>,
    block_rows: usize,
) -> Result<Opened, IngestError> {
    let rows = columns.first().map_or(0, |c| c.values.rows());
    if rows == 0 || columns.iter().any(|c| c.values.rows() != rows) {
        return Err(IngestError::new(IngestErrorKind::Empty, path, "ingest.uneven"));
    }
    let describe = |column: &MemoryColumn| Column {
        name: column.name.clone(),
        numeric: true,
        storage: "double".to_owned(),
        unit: column.epoch_s.map(|_| "s".to_owned()),
        epoch_s: column.epoch_s,
        rollover_s: None,
        judged: None,
    };
    let described = columns.iter().map(describe).collect();
    let columns = columns.into_iter().map(|c| c.values).collect();
    Ok(Opened {
        labels: Vec::new(),
        bad_blocks: Vec::new(),
        columns: described,
        rows_estimate: Some(rows as u64),
        cut_off: Vec::new(),
        notes: Vec::new(),
        metadata: Vec::new(),
        stated_sample_rate_hz: None,
        table: Box::new(Memory { columns, block_rows: block_rows.max(1) }),
    })
}

/// Nothing at all: what stands in for a file that could not be opened.
pub(super) fn nothing() -> Opened {
    let table = Box::new(Memory { columns: Vec::new(), block_rows: 1 });
    Opened {
        labels: Vec::new(),
        bad_blocks: Vec::new(),
        columns: Vec::new(),
        rows_estimate: Some(0),
        cut_off: Vec::new(),
        notes: Vec::new(),
        metadata: Vec::new(),
        stated_sample_rate_hz: None,
        table,
    }
}

impl Table for Memory {
    fn read(&self, wanted: &[usize], on_block: &mut OnBlock<'_>) -> Result<Option<FileFacts>, IngestError> {
        let rows = self.columns.first().map_or(0, |c| c.rows());
        let mut block = Block::default();
        let mut start = 0;
        while start < rows {
            let end = (start + self.block_rows).min(rows);
            block.reset(wanted.len());
            block.first_row = start as u64 + 1;
            for (slot, &w) in wanted.iter().enumerate() {
                let (Some(values), Some(column)) = (self.columns.get(w), block.columns.get_mut(slot)) else {
                    continue;
                };
                values.append(start..end, column);
                let mut unusable = vec![];
                for (row, v) in (start as u64 + 1..).zip(column.iter_mut()).filter(|(_, v)| !usable(**v)) {
                    unusable.push((row, v.to_string()));
                    *v = f64::NAN;
                }
                for (row, text) in unusable {
                    block.fault(|| non_finite(slot, row, text), slot, FieldFaultKind::NonFinite);
                }
            }
            block.bytes_done = bytes(end as u64, self.columns.len());
            if on_block(&mut block).is_break() {
                return Ok(None);
            }
            start = end;
        }
        let bytes = bytes(rows as u64, self.columns.len());
        Ok(Some(FileFacts { sha256: String::new(), bytes, rows: rows as u64 }))
    }
}

/// A located non-finite field of a format without lines.
pub(super) fn non_finite(slot: usize, row: u64, text: String) -> FieldFault {
    FieldFault { slot, row, line: 0, character: 0, kind: FieldFaultKind::NonFinite, text }
}
