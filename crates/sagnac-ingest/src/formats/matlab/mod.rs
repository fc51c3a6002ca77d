//! MATLAB's MAT files: version 4, 5 and 7. Those of version 7.3 are HDF5.
//!
//! The numbers are read where they lie, column by column; only names and sizes are taken into memory. The crates that
//! were looked at load whole files.

mod element_reader;
mod v4;
mod v5;
mod variables;

use crate::binary::array_selection;
use crate::binary::column_stream::ColumnStreamTable;
use crate::binary::positioned_file::PositionedFile;
use crate::error::{IngestError, IngestErrorKind};
use crate::{Candidate, Format, Opened};
use sagnac_core::message::note;
use variables::Variables;

/// A MAT file.
pub(super) struct Mat;

impl Format for Mat {
    fn id(&self) -> &'static str {
        "mat"
    }

    fn recognises(&self, file: &Candidate) -> bool {
        v5::byte_order(&file.head).is_some() || v4::recognises(&file.head)
    }

    fn open(&self, file: &Candidate) -> Result<Opened, IngestError> {
        let path = &file.path;
        let at = PositionedFile::open(file)?;
        let mut found = match v5::byte_order(&file.head) {
            Some(order) => v5::walk(file, &at, order)?,
            None => v4::walk(file, &at)?,
        };
        let (mut numbers, mut arrays) = (Vec::new(), Vec::new());
        for one in std::mem::take(&mut found.numbers) {
            let Some(shape) = one.shape() else {
                let text: Vec<String> = one.dimensions.iter().map(u64::to_string).collect();
                found.leave(&one.name, note!("ingest.mat.no_table", shape = text.join(" × ")));
                continue;
            };
            arrays.push(array_selection::Array {
                name: one.owner.clone().unwrap_or_else(|| one.name.clone()),
                rows: shape.rows,
                columns: shape.columns,
                in_structure: one.owner.is_some(),
            });
            numbers.push((one, shape));
        }
        let part = file.options.part.as_deref();
        let Some(rows) = array_selection::rows(path, &arrays, part)? else {
            return Err(nothing(file, found));
        };
        let mut notes = Vec::new();
        let (mut columns, mut groups, mut places) = (Vec::new(), Vec::new(), Vec::new());
        for ((one, shape), array) in numbers.iter().zip(&arrays) {
            if !array_selection::belongs(array, rows, part, &arrays) {
                let note = note!("ingest.binary.other_length", name = one.name.as_str());
                found.left.push(note.with("rows", shape.rows).with("chosen", rows));
                continue;
            }
            if shape.flat {
                let note = note!("ingest.mat.flat", name = one.name.as_str());
                notes.push(note.with("rows", shape.columns).with("columns", shape.rows));
            }
            for (column, place) in one.columns(shape, &mut groups) {
                columns.push(column);
                places.push(Some(place));
            }
        }
        notes.extend(array_selection::notes(found.left));
        Ok(Opened {
            labels: Vec::new(),
            bad_blocks: Vec::new(),
            columns,
            rows_estimate: Some(rows),
            cut_off: Vec::new(),
            notes,
            metadata: found.metadata.entries(),
            stated_sample_rate_hz: found.rate_hz,
            table: Box::new(ColumnStreamTable::new(
                path.clone(),
                file.bytes,
                at,
                found.streams,
                groups,
                places,
                rows,
            )),
        })
    }
}

/// The diagnostic of a file without an array of numbers.
fn nothing(file: &Candidate, found: Variables) -> IngestError {
    let hint = if found.has_objects { "ingest.mat.hint.tables" } else { "ingest.mat.hint.arrays" };
    let error = match found.left.into_iter().next() {
        Some(reason) => note!("ingest.mat.nothing_but", reason),
        None => note!("ingest.mat.nothing"),
    };
    IngestError::new(IngestErrorKind::NotNumeric, &file.path, error).hint(hint)
}
