//! Raw binary records, as loggers write them. Nothing in such a file says what it is: it is taken for one only where
//! its user gives a layout.

mod framing;

use crate::binary::records::{FramedRecords, Framer, MakeFramer, Records};
use crate::byte_stream::Packing;
use crate::error::{IngestError, IngestErrorKind};
use crate::layout::Layout;
use crate::{Candidate, Column, Format, Opened};
use framing::Scanner;
use sagnac_core::message::note;

/// Raw binary records.
pub(super) struct Raw;

/// Records at the start of a file by which it is judged whether the layout fits.
const JUDGED: usize = 1000;

impl Format for Raw {
    fn id(&self) -> &'static str {
        "raw"
    }

    fn recognises(&self, file: &Candidate) -> bool {
        file.options.layout.is_some()
    }

    fn may_be(&self, _file: &Candidate) -> bool {
        // Opening says that a layout is needed, and how to write one.
        true
    }

    fn open(&self, file: &Candidate) -> Result<Opened, IngestError> {
        let Some(layout) = file.options.layout.as_ref().and_then(|l| l.layout.as_deref()) else {
            return Err(IngestError::new(IngestErrorKind::Layout, &file.path, "ingest.raw.no_layout")
                .hint("ingest.raw.hint.give_layout"));
        };
        let record = layout.record_bytes as u64;
        let rows = file.bytes.saturating_sub(layout.header_bytes) / record.max(1);
        if file.packing == Packing::Plain && rows == 0 {
            let note = note!("ingest.raw.no_record", bytes = file.bytes, record);
            return Err(IngestError::new(IngestErrorKind::Empty, &file.path, note)
                .hint("ingest.raw.hint.check_layout"));
        }
        judge(file, layout)?;
        let mut notes = vec![note!("ingest.raw.records", record, header = layout.header_bytes)];
        let rest = file.bytes.saturating_sub(layout.header_bytes) % record.max(1);
        if file.packing == Packing::Plain && rest > 0 && layout.sync.is_empty() {
            notes.push(note!("ingest.raw.rest", bytes = rest, record));
        }
        let columns = layout.columns.iter().map(|c| Column {
            name: c.name.clone(),
            numeric: true,
            storage: c.storage.to_owned(),
            unit: c.unit.as_ref().map(|u| u.text().to_owned()),
            epoch_s: None,
            rollover_s: c.rollover_s,
            judged: None,
        });
        let columns = columns.collect();
        let framed = !layout.sync.is_empty() || layout.checksum.is_some();
        let table = Records {
            path: file.path.clone(),
            packing: file.packing,
            header_bytes: layout.header_bytes,
            record_bytes: layout.record_bytes,
            declared_rows: None,
            columns: layout.columns.iter().map(|c| Some(c.field)).collect(),
            framer: framed.then(|| make(layout.clone())),
        };
        let whole = file.bytes.saturating_sub(layout.header_bytes) % (layout.record_bytes as u64).max(1) == 0;
        let cut_off = match file.packing {
            Packing::Plain if !framed && !whole => {
                vec![note!("ingest.raw.cut_off", bytes = file.bytes)]
            }
            _ => Vec::new(),
        };
        Ok(Opened {
            labels: Vec::new(),
            bad_blocks: Vec::new(),
            columns,
            rows_estimate: (file.packing == Packing::Plain).then_some(rows),
            cut_off,
            notes,
            metadata: Vec::new(),
            stated_sample_rate_hz: layout.sample_rate_hz,
            table: Box::new(table),
        })
    }
}

fn make(layout: Layout) -> MakeFramer {
    Box::new(move || Box::new(Scanner::new(&layout)))
}

/// Refuses a file whose first records mostly lack the sync word or have a wrong checksum: the layout is another's.
fn judge(file: &Candidate, layout: &Layout) -> Result<(), IngestError> {
    let framed = !layout.sync.is_empty() || layout.checksum.is_some();
    let start = usize::try_from(layout.header_bytes).unwrap_or(usize::MAX);
    let Some(bytes) = file.head.get(start..).filter(|b| framed && b.len() >= layout.record_bytes) else {
        return Ok(());
    };
    let mut cut = FramedRecords::default();
    let length = layout.record_bytes.saturating_mul(JUDGED).min(bytes.len());
    let end = file.head_is_all && length == bytes.len();
    Scanner::new(layout).take(bytes.get(..length).unwrap_or_default(), end, &mut cut);
    let found = cut.records.len() / layout.record_bytes.max(1);
    let expected = length / layout.record_bytes.max(1);
    let good = found.saturating_sub(cut.bad.len());
    if good * 2 >= expected {
        return Ok(());
    }
    let note = note!("ingest.raw.does_not_fit", records = expected, good);
    let error = IngestError::new(IngestErrorKind::Layout, &file.path, note);
    let error = match cut.bad.first() {
        Some((_, text)) => error.found(text),
        None => error,
    };
    Err(error.hint("ingest.raw.hint.check_layout"))
}
