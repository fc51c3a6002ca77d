//! A recording in memory, delivered in blocks as a file would be.

use super::error::{IngestError, IngestErrorKind};
use super::{Block, Column, FieldFault, FieldFaultKind, FileFacts, OnBlock, Opened, Table};
use sagnac_core::numeric::range::usable;
use std::path::Path;

struct Memory {
    columns: Vec<Vec<f64>>,
    block_rows: usize,
}

/// Opens named columns.
pub(super) fn open(
    path: &Path,
    columns: Vec<(String, Vec<f64>)>,
    block_rows: usize,
) -> Result<Opened, IngestError> {
    let rows = columns.first().map_or(0, |(_, c)| c.len());
    if rows == 0 || columns.iter().any(|(_, c)| c.len() != rows) {
        return Err(IngestError::new(IngestErrorKind::Empty, path, "ingest.uneven"));
    }
    let (names, columns): (Vec<String>, Vec<Vec<f64>>) = columns.into_iter().unzip();
    let describe = |name| Column {
        name,
        numeric: true,
        storage: "double".to_owned(),
        unit: None,
        epoch_s: None,
        rollover_s: None,
    };
    Ok(Opened {
        columns: names.into_iter().map(describe).collect(),
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
        let rows = self.columns.first().map_or(0, Vec::len);
        let mut block = Block::default();
        let mut start = 0;
        while start < rows {
            let end = (start + self.block_rows).min(rows);
            block.reset(wanted.len());
            block.first_row = start as u64 + 1;
            for (slot, &w) in wanted.iter().enumerate() {
                let values = self.columns.get(w).and_then(|c| c.get(start..end)).unwrap_or_default();
                if let Some(column) = block.columns.get_mut(slot) {
                    column.extend_from_slice(values);
                }
                for (i, v) in values.iter().enumerate().filter(|(_, v)| !usable(**v)) {
                    let row = (start + i) as u64 + 1;
                    block.fault(|| non_finite(slot, row, v.to_string()), slot, FieldFaultKind::NonFinite);
                }
                if let Some(column) = block.columns.get_mut(slot) {
                    column.iter_mut().filter(|v| !usable(**v)).for_each(|v| *v = f64::NAN);
                }
            }
            if on_block(&mut block).is_break() {
                return Ok(None);
            }
            start = end;
        }
        Ok(Some(FileFacts { sha256: String::new(), bytes: 0, rows: rows as u64 }))
    }
}

/// A located non-finite field of a format without lines.
pub(super) fn non_finite(slot: usize, row: u64, text: String) -> FieldFault {
    FieldFault { slot, row, line: 0, character: 0, kind: FieldFaultKind::NonFinite, text }
}
