//! NumPy arrays (`.npy`): one array, read as it lies in the file.

use super::array::{self, Array, Fault, MAGIC};
use crate::binary::column_stream::{Coding, ColumnPlace, ColumnStreamTable, RecordGroup, Stream};
use crate::binary::positioned_file::PositionedFile;
use crate::binary::records::Records;
use crate::byte_stream::Packing;
use crate::error::{IngestError, IngestErrorKind};
use crate::{Candidate, Format, Opened, Table};
use sagnac_core::message::{Note, note};

/// A NumPy array, plain or packed.
pub(crate) struct Npy;

impl Format for Npy {
    fn id(&self) -> &'static str {
        "npy"
    }

    fn recognises(&self, file: &Candidate) -> bool {
        file.head.starts_with(MAGIC)
    }

    fn open(&self, file: &Candidate) -> Result<Opened, IngestError> {
        let path = &file.path;
        let refuse = |(note, hint): Fault| IngestError::new(IngestErrorKind::Damaged, path, note).hint(hint);
        if !file.head.starts_with(MAGIC) {
            return Err(refuse(("ingest.npy.no_magic".into(), "ingest.stated.hint_format")));
        }
        let array = array::header(&file.head).map_err(refuse)?;
        let data = usize::try_from(array.data_at).ok().and_then(|at| file.head.get(at..)).unwrap_or_default();
        let columns = array.columns("", data).map_err(refuse)?;
        if array.data_bytes == 0 {
            return Err(IngestError::new(IngestErrorKind::Empty, path, "ingest.no_rows")
                .hint("ingest.hint.check_written"));
        }
        let mut notes: Vec<Note> = columns.note.clone().into_iter().collect();
        notes.extend(length(file, &array)?);
        let rows = columns.rows;
        let (list, places): (Vec<_>, Vec<_>) =
            columns.list.into_iter().map(|p| (p.column, (p.field, p.from))).unzip();
        let table: Box<dyn Table> = if columns.by_rows {
            Box::new(Records {
                path: path.clone(),
                packing: file.packing,
                header_bytes: array.data_at,
                record_bytes: columns.stride,
                declared_rows: Some(rows),
                columns: places.into_iter().map(|(field, _)| field).collect(),
                framer: None,
            })
        } else {
            let at = PositionedFile::open(file)?;
            let stream =
                Stream { name: "array".to_owned(), from: 0, length: u64::MAX, coding: Coding::Stored };
            let group =
                |from: u64| RecordGroup { stream: 0, offset: array.data_at + from, stride: columns.stride };
            let groups = places.iter().map(|(_, from)| group(*from)).collect();
            let place = |(group, (field, _)): (usize, &(Option<_>, u64))| {
                field.map(|field| ColumnPlace { group, field })
            };
            let columns = places.iter().enumerate().map(place).collect();
            Box::new(ColumnStreamTable::new(
                path.clone(),
                file.bytes,
                at,
                vec![stream],
                groups,
                columns,
                rows,
            ))
        };
        Ok(Opened {
            labels: Vec::new(),
            bad_blocks: Vec::new(),
            columns: list,
            rows_estimate: Some(rows),
            cut_off: Vec::new(),
            notes,
            metadata: Vec::new(),
            stated_sample_rate_hz: None,
            table,
        })
    }
}

/// Compares the length of a plain file with what its header declares.
fn length(file: &Candidate, array: &Array) -> Result<Option<Note>, IngestError> {
    if file.packing != Packing::Plain {
        return Ok(None);
    }
    let there = file.bytes.saturating_sub(array.data_at);
    if there < array.data_bytes {
        let note = note!("ingest.npy.short", declared = array.data_bytes, found = there);
        return Err(IngestError::new(IngestErrorKind::Damaged, &file.path, note).hint("ingest.hint.cut_off"));
    }
    let more = there - array.data_bytes;
    Ok((more > 0).then(|| note!("ingest.npy.longer", bytes = more)))
}
