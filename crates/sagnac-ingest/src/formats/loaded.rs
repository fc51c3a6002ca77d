//! Files that are read into memory as a whole when they are opened, because nothing in them can be read row by row.

use crate::byte_stream::{ByteStream, digest};
use crate::error::{IngestError, IngestErrorKind};
use crate::{Block, Candidate, Column, FieldFault, FieldFaultKind, FileFacts, OnBlock, Opened, Table};
use sagnac_core::message::{Note, note};
use std::path::PathBuf;

/// Rows of a block.
const BLOCK_ROWS: usize = 8192;

/// Largest content, bytes.
const MAX_LOADED_BYTES: usize = 512 << 20;

/// Columns in memory with the file they come from.
struct Loaded {
    path: PathBuf,
    columns: Vec<Vec<f64>>,
}

impl Table for Loaded {
    fn read(&self, wanted: &[usize], on_block: &mut OnBlock<'_>) -> Result<Option<FileFacts>, IngestError> {
        let rows = self.columns.first().map_or(0, Vec::len);
        let mut block = Block::default();
        let mut start = 0;
        while start < rows {
            let end = (start + BLOCK_ROWS).min(rows);
            block.reset(wanted.len());
            block.first_row = start as u64 + 1;
            for (slot, of) in wanted.iter().enumerate() {
                let values = self.columns.get(*of).and_then(|c| c.get(start..end)).unwrap_or_default();
                if let Some(column) = block.columns.get_mut(slot) {
                    column.extend_from_slice(values);
                }
                for (row, _) in (start as u64 + 1..).zip(values).filter(|(_, v)| !v.is_finite()) {
                    let kind = FieldFaultKind::NonFinite;
                    let text = String::new();
                    block.fault(|| FieldFault { slot, row, line: 0, character: 0, kind, text }, slot, kind);
                }
            }
            if on_block(&mut block).is_break() {
                return Ok(None);
            }
            start = end;
        }
        let file = digest(&self.path)?;
        Ok(Some(FileFacts { sha256: file.sha256, bytes: file.bytes, rows: rows as u64 }))
    }
}

/// A column with its values.
pub(super) struct LoadedColumn {
    pub described: Column,
    pub values: Vec<f64>,
}

impl LoadedColumn {
    /// A column of numbers with a unit where the format states one.
    pub fn new(name: impl Into<String>, unit: Option<&str>, values: Vec<f64>) -> LoadedColumn {
        let described = Column {
            name: name.into(),
            numeric: true,
            storage: "double".to_owned(),
            unit: unit.map(str::to_owned),
            epoch_s: None,
            rollover_s: None,
            judged: None,
        };
        LoadedColumn { described, values }
    }

    /// The same, with the zero of stamps, s since 1970.
    pub fn since(mut self, epoch_s: f64) -> LoadedColumn {
        self.described.epoch_s = Some(epoch_s);
        self
    }
}

/// What a file says beside its columns.
#[derive(Default)]
pub(super) struct About {
    pub notes: Vec<Note>,
    pub metadata: Vec<(String, String)>,
    pub sample_rate_hz: Option<f64>,
}

/// The opened file.
///
/// # Errors
/// [`IngestErrorKind::Empty`] without rows.
pub(super) fn opened(
    file: &Candidate,
    columns: Vec<LoadedColumn>,
    about: About,
) -> Result<Opened, IngestError> {
    let rows = columns.iter().map(|c| c.values.len()).max().unwrap_or(0);
    if rows == 0 {
        return Err(IngestError::new(IngestErrorKind::Empty, &file.path, "ingest.no_rows")
            .hint("ingest.hint.check_written"));
    }
    let (mut described, mut values) = (Vec::new(), Vec::new());
    for mut column in columns {
        column.values.resize(rows, f64::NAN);
        described.push(column.described);
        values.push(column.values);
    }
    Ok(Opened {
        labels: Vec::new(),
        bad_blocks: Vec::new(),
        columns: described,
        rows_estimate: Some(rows as u64),
        cut_off: Vec::new(),
        notes: about.notes,
        metadata: about.metadata,
        stated_sample_rate_hz: about.sample_rate_hz,
        table: Box::new(Loaded { path: file.path.clone(), columns: values }),
    })
}

/// The text of a file, unpacked.
///
/// # Errors
/// As [`bytes`].
pub(super) fn text(file: &Candidate) -> Result<String, IngestError> {
    Ok(String::from_utf8_lossy(&bytes(file)?).into_owned())
}

/// The content of a file, unpacked.
///
/// # Errors
/// Those of reading, and a file beyond what is kept in memory.
pub(super) fn bytes(file: &Candidate) -> Result<Vec<u8>, IngestError> {
    let mut stream = ByteStream::open(&file.path, file.packing)?;
    let mut all = Vec::new();
    let mut buffer = vec![0; 1 << 18];
    loop {
        let n = stream.fill(&mut buffer)?;
        if n == 0 {
            break;
        }
        all.extend_from_slice(buffer.get(..n).unwrap_or_default());
        if all.len() > MAX_LOADED_BYTES {
            let note = note!("ingest.loaded.too_large", mebibytes = MAX_LOADED_BYTES >> 20);
            return Err(IngestError::new(IngestErrorKind::UnknownFormat, &file.path, note)
                .hint("ingest.loaded.hint_split"));
        }
    }
    Ok(all)
}
