//! Records of fixed length that follow each other: read and hashed by one thread, decoded by another.

use crate::byte_stream::{ByteStream, Packing};
use crate::error::{IngestError, IngestErrorKind};
use crate::in_memory::non_finite;
use crate::layout::Field;
use crate::{Block, FieldFault, FieldFaultKind, FileFacts, OnBlock, Table};
use sagnac_core::message::note;
use sagnac_core::numeric::range::usable;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

/// Most rows in a block.
pub(crate) const ROWS: usize = 1 << 15;

/// Bytes that are read at a time.
const CHUNK: usize = 1 << 20;

/// Whole records cut out of a stream of bytes, and those among them that cannot be used.
#[derive(Debug, Default)]
pub(crate) struct FramedRecords {
    /// Records one after another; a bad one is all zeros.
    pub records: Vec<u8>,
    /// Bad records: position among the records, and what was found there.
    pub bad: Vec<(usize, String)>,
}

impl FramedRecords {
    /// Takes records of which the last one is cut off: it becomes a bad one. `at`: place of the first in the file.
    fn keep_partial_record(&mut self, bytes: &[u8], stride: usize, at: u64) {
        let whole = bytes.len() / stride;
        let rest = bytes.len() - whole * stride;
        let at = at + (whole * stride) as u64;
        self.records.clear();
        self.bad.clear();
        self.records.extend_from_slice(bytes.get(..whole * stride).unwrap_or_default());
        self.records.resize((whole + 1) * stride, 0);
        self.bad.push((whole, format!("{rest}/{stride} B @{at}")));
    }
}

/// Finds the records in a stream in which they are not simply one after another.
pub(crate) trait Framer {
    /// Takes the next bytes, the last ones when `end` is true, and gives the records that are complete.
    fn take(&mut self, bytes: &[u8], end: bool, out: &mut FramedRecords);
}

/// Makes a framer for a reading from the start.
pub(crate) type MakeFramer = Box<dyn Fn() -> Box<dyn Framer> + Send + Sync>;

/// Records in a file, plain or packed.
pub(crate) struct Records {
    /// File.
    pub path: PathBuf,
    /// How it is packed.
    pub packing: Packing,
    /// Bytes before the first record.
    pub header_bytes: u64,
    /// Length of a record, bytes; 1 to [`MAX_RECORD_BYTES`](crate::layout::MAX_RECORD_BYTES).
    pub record_bytes: usize,
    /// Number of records, where the file declares it.
    pub declared_rows: Option<u64>,
    /// Columns; `None` where one holds no numbers.
    pub columns: Vec<Option<Field>>,
    /// How records are found; `None`: they follow each other to the end.
    pub framer: Option<MakeFramer>,
}

struct Chunk {
    bytes: Vec<u8>,
    file_bytes: u64,
}

impl Table for Records {
    fn read(&self, wanted: &[usize], on_block: &mut OnBlock<'_>) -> Result<Option<FileFacts>, IngestError> {
        let fields = fields(&self.path, &self.columns, wanted)?;
        let mut stream = ByteStream::open(&self.path, self.packing)?;
        skip(&mut stream, self.header_bytes)?;
        let (chunk_out, chunk_in) = sync_channel::<Chunk>(3);
        let (back, free) = sync_channel::<Vec<u8>>(6);
        std::thread::scope(|scope| {
            let reader = scope.spawn(move || self.cut(stream, &chunk_out, &free));
            let decoded = self.deliver(&fields, chunk_in, &back, on_block);
            drop(back);
            let digested = reader
                .join()
                .map_err(|_| IngestError::new(IngestErrorKind::Io, &self.path, "ingest.thread_stopped"))?;
            let Some(rows) = decoded else { return Ok(None) };
            let Some(digested) = digested? else { return Ok(None) };
            if let Some(declared) = self.declared_rows.filter(|d| *d > rows) {
                return Err(short(&self.path, declared, rows));
            }
            Ok(Some(FileFacts { sha256: digested.sha256, bytes: digested.bytes, rows }))
        })
    }
}

/// The diagnostic of a file that ends before all declared rows.
pub(crate) fn short(path: &Path, declared: u64, found: u64) -> IngestError {
    let note = note!("ingest.binary.short", declared, found);
    IngestError::new(IngestErrorKind::Damaged, path, note).hint("ingest.hint.cut_off")
}

/// The fields of the wanted columns.
pub(crate) fn fields(
    path: &Path,
    columns: &[Option<Field>],
    wanted: &[usize],
) -> Result<Vec<Field>, IngestError> {
    let field = |w: &usize| {
        columns.get(*w).copied().flatten().ok_or_else(|| {
            let note = note!("ingest.no_column_at", position = w.saturating_add(1));
            IngestError::new(IngestErrorKind::Column, path, note)
        })
    };
    wanted.iter().map(field).collect()
}

/// Passes over bytes; the end of the file may come before.
fn skip(stream: &mut ByteStream, mut bytes: u64) -> Result<(), IngestError> {
    let mut scratch = vec![0; CHUNK.min(usize::try_from(bytes).unwrap_or(CHUNK))];
    while bytes > 0 {
        let n = usize::try_from(bytes).unwrap_or(usize::MAX).min(scratch.len());
        let read = stream.fill(scratch.get_mut(..n).unwrap_or_default())?;
        if read == 0 {
            break;
        }
        bytes -= read as u64;
    }
    Ok(())
}

impl Records {
    /// Reads the stream into chunks of whole records; `None` when the consumer stopped.
    fn cut(
        &self,
        mut stream: ByteStream,
        out: &SyncSender<Chunk>,
        free: &Receiver<Vec<u8>>,
    ) -> Result<Option<crate::byte_stream::Digested>, IngestError> {
        let records = (CHUNK / self.record_bytes.max(1)).clamp(1, ROWS);
        let size = records * self.record_bytes.max(1);
        loop {
            let mut bytes = free.try_recv().unwrap_or_default();
            bytes.resize(size, 0);
            let n = stream.fill(&mut bytes)?;
            bytes.truncate(n);
            let last = n < size;
            let file_bytes = stream.file_bytes();
            if out.send(Chunk { bytes, file_bytes }).is_err() {
                return Ok(None);
            }
            if last {
                return stream.finish().map(Some);
            }
        }
    }

    /// Decodes the chunks; gives the number of rows, `None` when the consumer stopped.
    fn deliver(
        &self,
        fields: &[Field],
        chunks: Receiver<Chunk>,
        back: &SyncSender<Vec<u8>>,
        on_block: &mut OnBlock<'_>,
    ) -> Option<u64> {
        let stride = self.record_bytes.max(1);
        let mut framer = self.framer.as_ref().map(|make| make());
        let mut cut = FramedRecords::default();
        let mut block = Block::default();
        let mut rows = 0u64;
        for chunk in chunks {
            let left = self.declared_rows.map_or(u64::MAX, |d| d.saturating_sub(rows));
            let records: &[u8] = match framer.as_mut() {
                Some(framer) => {
                    cut.records.clear();
                    cut.bad.clear();
                    let end = chunk.bytes.len() < (CHUNK / stride).clamp(1, ROWS) * stride;
                    framer.take(&chunk.bytes, end, &mut cut);
                    &cut.records
                }
                None if self.declared_rows.is_none() && !chunk.bytes.len().is_multiple_of(stride) => {
                    cut.keep_partial_record(&chunk.bytes, stride, self.header_bytes + rows * stride as u64);
                    &cut.records
                }
                None => &chunk.bytes,
            };
            let whole = (records.len() / stride) as u64;
            let take = usize::try_from(whole.min(left)).unwrap_or(usize::MAX);
            let mut bad = cut.bad.iter().peekable();
            for (part, piece) in records.chunks(ROWS * stride).enumerate() {
                let start = part * ROWS;
                let n = (piece.len() / stride).min(take.saturating_sub(start));
                if n == 0 {
                    break;
                }
                block.reset(fields.len());
                block.first_row = rows + 1;
                block.bytes_done = chunk.file_bytes;
                fill(&mut block, fields, piece.get(..n * stride).unwrap_or_default(), stride);
                set_aside_unusable(&mut block, fields);
                while let Some((at, text)) = bad.next_if(|(at, _)| *at < start + n) {
                    mark_unusable(&mut block, at.saturating_sub(start), text);
                }
                rows += n as u64;
                if on_block(&mut block).is_break() {
                    return None;
                }
            }
            // A full return channel only means that the memory is not used again.
            let _ = back.try_send(chunk.bytes);
        }
        Some(rows)
    }
}

/// Decodes every field of some records.
fn fill(block: &mut Block, fields: &[Field], records: &[u8], stride: usize) {
    for (field, column) in fields.iter().zip(&mut block.columns) {
        field.decode(records, stride, column);
    }
}

/// Takes the values of a row that cannot be used away, and says so for each column.
fn mark_unusable(block: &mut Block, row: usize, text: &str) {
    let number = block.first_row + row as u64;
    for slot in 0..block.columns.len() {
        if let Some(value) = block.columns.get_mut(slot).and_then(|c| c.get_mut(row)) {
            *value = f64::NAN;
        }
        let kind = FieldFaultKind::Unparsable;
        let fault = || FieldFault { slot, row: number, line: 0, character: 0, kind, text: text.to_owned() };
        block.fault(fault, slot, kind);
    }
}

/// Counts and locates values that cannot be reckoned with.
pub(crate) fn set_aside_unusable(block: &mut Block, fields: &[Field]) {
    for (slot, field) in fields.iter().enumerate() {
        let Some(mut column) = block.columns.get_mut(slot).map(std::mem::take) else { continue };
        if column.iter().any(|v| !usable(*v)) {
            for (i, v) in column.iter_mut().enumerate().filter(|(_, v)| !usable(**v)) {
                let (row, value) = (block.first_row + i as u64, *v);
                let text = || if field.ticks.is_some() { "NaT".to_owned() } else { value.to_string() };
                block.fault(|| non_finite(slot, row, text()), slot, FieldFaultKind::NonFinite);
                *v = f64::NAN;
            }
        }
        if let Some(place) = block.columns.get_mut(slot) {
            *place = column;
        }
    }
}
