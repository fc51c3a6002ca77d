//! The variables of a MAT file, and how arrays of numbers become columns.

use crate::Column;
use crate::binary::column_stream::{ColumnPlace, RecordGroup, Stream};
use crate::layout::{Field, MAX_COLUMNS, MAX_RECORD_BYTES};
use crate::metadata::{Metadata, stated_sample_rate_hz};
use sagnac_core::message::{Note, note};

/// Most of what is said of variables that are left out.
const MAX_SKIPPED_NOTES: usize = 1000;

/// Rows of a matrix up to which it may be one row for each channel, and how many times more columns it has then.
const MAX_CHANNELS: u64 = 64;
const FLAT: u64 = 8;

/// An array of numbers in a file.
pub(super) struct NumericArray {
    /// Name, that of the structure before it for a field.
    pub name: String,
    /// The structure it is a field of.
    pub owner: Option<String>,
    pub dimensions: Vec<u64>,
    /// Type of its numbers.
    pub field: Field,
    /// The stream it stands in, and its first byte there.
    pub stream: usize,
    pub offset: u64,
}

/// The variables of a file.
#[derive(Default)]
pub(super) struct Variables {
    pub streams: Vec<Stream>,
    pub numbers: Vec<NumericArray>,
    pub left: Vec<Note>,
    pub metadata: Metadata,
    pub rate_hz: Option<f64>,
    pub has_objects: bool,
}

impl Variables {
    /// Says why a variable is left out.
    pub fn leave(&mut self, name: &str, reason: Note) {
        if self.left.len() < MAX_SKIPPED_NOTES {
            let name = crate::error::shorten(name);
            self.left.push(note!("ingest.binary.left_out", name, reason));
        }
    }

    /// Keeps a text among what the file says of itself.
    pub fn keep(&mut self, name: &str, text: &str) {
        self.metadata.add(name, text);
    }

    /// Keeps a single number, as the sample rate where its name says so.
    pub fn scalar(&mut self, name: &str, value: f64) {
        let own = name.rsplit('.').next().unwrap_or(name);
        self.rate_hz = self.rate_hz.or_else(|| stated_sample_rate_hz(own, value));
        self.keep(name, &value.to_string());
    }
}

/// How an array becomes columns.
pub(super) struct Shape {
    pub rows: u64,
    pub columns: usize,
    /// True when the values of a row stand together: one row of the array for each channel.
    pub flat: bool,
}

impl NumericArray {
    /// How the array becomes columns; `None` where it is no table.
    pub fn shape(&self) -> Option<Shape> {
        let dimensions: Vec<u64> = self.dimensions.iter().copied().filter(|n| *n != 1).collect();
        let (rows, columns, flat) = match dimensions.as_slice() {
            [n] => (*n, 1, false),
            [rows, columns] => {
                let flat = *rows <= MAX_CHANNELS && *columns > MAX_CHANNELS && *columns / FLAT >= *rows;
                if flat { (*columns, *rows, true) } else { (*rows, *columns, false) }
            }
            _ => return None,
        };
        let columns = usize::try_from(columns).ok().filter(|n| *n <= MAX_COLUMNS)?;
        let fits = columns.checked_mul(self.field.kind.bytes())? <= MAX_RECORD_BYTES;
        fits.then_some(Shape { rows, columns, flat })
    }

    /// The columns, with the groups they are read from; `groups` are those so far.
    pub fn columns(&self, shape: &Shape, groups: &mut Vec<RecordGroup>) -> Vec<(Column, ColumnPlace)> {
        let bytes = self.field.kind.bytes();
        let column = |name: String| Column {
            name,
            numeric: true,
            storage: format!("{:?}", self.field.kind).to_lowercase(),
            unit: None,
            epoch_s: None,
            rollover_s: None,
            judged: None,
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
