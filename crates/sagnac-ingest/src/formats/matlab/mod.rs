//! MATLAB's MAT files: version 4, 5 and 7. Those of version 7.3 are HDF5.
//!
//! The numbers are read where they lie, column by column; only names and sizes are taken into memory. The crates that
//! were looked at load whole files.

mod element_reader;
mod v4;
mod v5;

use crate::binary::array_selection;
use crate::binary::column_stream::{ColumnPlace, ColumnStreamTable, RecordGroup, Stream};
use crate::binary::positioned_file::PositionedFile;
use crate::error::{IngestError, IngestErrorKind};
use crate::layout::Field;
use crate::layout::{MAX_COLUMNS, MAX_RECORD_BYTES};
use crate::metadata::{Metadata, stated_sample_rate_hz};
use crate::{Candidate, Column, Format, Opened};
use sagnac_core::message::Note;

/// Most of what is said of variables that are left out.
const MOST_LEFT: usize = 1000;

/// Rows of a matrix up to which it may be one row for each channel, and how many times more columns it has then.
const MOST_CHANNELS: u64 = 64;
const FLAT: u64 = 8;

/// A MAT file.
pub(super) struct Mat;

/// An array of numbers in a file.
struct Numbers {
    /// Name, that of the structure before it for a field.
    name: String,
    /// The structure it is a field of.
    owner: Option<String>,
    dimensions: Vec<u64>,
    /// Type of its numbers.
    field: Field,
    /// The stream it stands in, and its first byte there.
    stream: usize,
    offset: u64,
}

/// What was found in a file.
#[derive(Default)]
struct Found {
    streams: Vec<Stream>,
    numbers: Vec<Numbers>,
    left: Vec<Note>,
    metadata: Metadata,
    rate_hz: Option<f64>,
    has_objects: bool,
}

impl Found {
    fn leave(&mut self, name: &str, reason: Note) {
        if self.left.len() < MOST_LEFT {
            let name = crate::error::shorten(name);
            self.left.push(Note::new("ingest.binary.left_out").with("name", name).with("reason", reason));
        }
    }

    fn keep(&mut self, name: &str, text: &str) {
        self.metadata.add(name, text);
    }

    fn scalar(&mut self, name: &str, value: f64) {
        let own = name.rsplit('.').next().unwrap_or(name);
        self.rate_hz = self.rate_hz.or_else(|| stated_sample_rate_hz(own, value));
        self.keep(name, &value.to_string());
    }
}

/// How an array becomes columns.
struct Shape {
    rows: u64,
    columns: usize,
    /// True when the values of a row stand together: one row of the array for each channel.
    flat: bool,
}

impl Numbers {
    fn shape(&self) -> Option<Shape> {
        let dimensions: Vec<u64> = self.dimensions.iter().copied().filter(|n| *n != 1).collect();
        let (rows, columns, flat) = match dimensions.as_slice() {
            [n] => (*n, 1, false),
            [rows, columns] => {
                let flat = *rows <= MOST_CHANNELS && *columns > MOST_CHANNELS && *columns / FLAT >= *rows;
                if flat { (*columns, *rows, true) } else { (*rows, *columns, false) }
            }
            _ => return None,
        };
        let columns = usize::try_from(columns).ok().filter(|n| *n <= MAX_COLUMNS)?;
        let fits = columns.checked_mul(self.field.kind.bytes())? <= MAX_RECORD_BYTES;
        fits.then_some(Shape { rows, columns, flat })
    }

    /// The columns, with the groups they are read from; `groups` are those so far.
    fn columns(&self, shape: &Shape, groups: &mut Vec<RecordGroup>) -> Vec<(Column, ColumnPlace)> {
        let bytes = self.field.kind.bytes();
        let column = |name: String| Column {
            name,
            numeric: true,
            storage: format!("{:?}", self.field.kind).to_lowercase(),
            unit: None,
            epoch_s: None,
            rollover_s: None,
        };
        if shape.flat {
            groups.push(RecordGroup {
                stream: self.stream,
                offset: self.offset,
                stride: bytes * shape.columns,
            });
        }
        let one = |j: usize| {
            let name = match (shape.columns, shape.flat) {
                (1, _) => self.name.clone(),
                (_, false) => format!("{}(:,{})", self.name, j + 1),
                (_, true) => format!("{}({},:)", self.name, j + 1),
            };
            if !shape.flat {
                let before = shape.rows.saturating_mul((j * bytes) as u64);
                let offset = self.offset.saturating_add(before);
                groups.push(RecordGroup { stream: self.stream, offset, stride: bytes });
            }
            let offset = if shape.flat { j * bytes } else { 0 };
            let place =
                ColumnPlace { group: groups.len().saturating_sub(1), field: Field { offset, ..self.field } };
            (column(name), place)
        };
        (0..shape.columns).map(one).collect()
    }
}

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
                found.leave(&one.name, Note::new("ingest.mat.no_table").with("shape", text.join(" × ")));
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
                let note = Note::new("ingest.binary.other_length").with("name", one.name.as_str());
                found.left.push(note.with("rows", shape.rows).with("chosen", rows));
                continue;
            }
            if shape.flat {
                let note = Note::new("ingest.mat.flat").with("name", one.name.as_str());
                notes.push(note.with("rows", shape.columns).with("columns", shape.rows));
            }
            for (column, place) in one.columns(shape, &mut groups) {
                columns.push(column);
                places.push(Some(place));
            }
        }
        notes.extend(array_selection::notes(found.left));
        Ok(Opened {
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
fn nothing(file: &Candidate, found: Found) -> IngestError {
    let hint = if found.has_objects { "ingest.mat.hint.tables" } else { "ingest.mat.hint.arrays" };
    let error = match found.left.into_iter().next() {
        Some(reason) => Note::new("ingest.mat.nothing_but").with("reason", reason),
        None => Note::new("ingest.mat.nothing"),
    };
    IngestError::new(IngestErrorKind::NotNumeric, &file.path, error).hint(hint)
}
