//! A NumPy array as columns: its header, its shape, and where the values of each column stand.

use super::dtype::{self, Element, Leaf, TypeFault};
use super::literal::{self, Literal};
use crate::Column;
use crate::layout::{Field, Ticks};
use crate::layout::{MAX_COLUMNS, MAX_RECORD_BYTES};
use sagnac_core::message::{Note, note};

/// First bytes of an array.
pub(super) const MAGIC: &[u8] = b"\x93NUMPY";

/// Rows of a two-dimensional array up to which it may be one row for each channel.
const MAX_CHANNELS: u64 = 64;

/// How many times more columns than rows such an array has.
const FLAT: u64 = 8;

/// An array as it is described.
#[derive(Debug)]
pub(super) struct Array {
    pub element: Element,
    pub shape: Vec<u64>,
    pub fortran_order: bool,
    /// First byte of the data.
    pub data_at: u64,
    /// Length of the data, bytes.
    pub data_bytes: u64,
}

/// Why an array cannot be read, as a fragment of a sentence, and what to do.
pub(super) type Fault = (Note, &'static str);

fn damaged(at: usize, key: &'static str) -> Fault {
    (Note::new(key).with("at", at), "ingest.hint.damaged")
}

/// Reads the header of an array from its first bytes.
pub(super) fn header(head: &[u8]) -> Result<Array, Fault> {
    let version = head.get(6).copied().unwrap_or(0);
    let wide = match version {
        1 => false,
        2 | 3 => true,
        other => {
            let note = note!("ingest.npy.version", version = u64::from(other));
            return Err((note, "ingest.npy.hint.save_again"));
        }
    };
    let start = if wide { 12 } else { 10 };
    let cut = || damaged(head.len(), "ingest.npy.header_cut");
    let length = head.get(8..start).ok_or_else(cut)?;
    let length = length.iter().rev().fold(0usize, |all, b| (all << 8) | usize::from(*b));
    let end = length.checked_add(start).ok_or_else(cut)?;
    let text = String::from_utf8_lossy(head.get(start..end).ok_or_else(cut)?);
    let literal = literal::parse(&text).map_err(|at| damaged(start + at, "ingest.npy.header_damaged"))?;
    let key = |name: &'static str| {
        literal.get(name).ok_or_else(|| (note!("ingest.npy.no_key", key = name), "ingest.hint.damaged"))
    };
    let element = dtype::element(key("descr")?).map_err(type_fault)?;
    let fortran_order = match key("fortran_order")? {
        Literal::Truth(truth) => *truth,
        _ => {
            return Err((note!("ingest.npy.no_key", key = "fortran_order"), "ingest.hint.damaged"));
        }
    };
    let shape = match key("shape")? {
        Literal::Whole(n) => Some(vec![*n]),
        shape => shape.list().and_then(|s| s.iter().map(Literal::whole).collect::<Option<Vec<u64>>>()),
    };
    let bad_shape = || (note!("ingest.npy.no_key", key = "shape"), "ingest.hint.damaged");
    let shape = shape.filter(|s| s.len() <= 32).ok_or_else(bad_shape)?;
    let data_bytes = shape
        .iter()
        .try_fold(element.bytes as u64, |all, n| all.checked_mul(*n))
        .filter(|bytes| *bytes < 1 << 62)
        .ok_or_else(bad_shape)?;
    Ok(Array { element, shape, fortran_order, data_at: end as u64, data_bytes })
}

fn type_fault(fault: TypeFault) -> Fault {
    match fault {
        TypeFault::Objects => ("ingest.npy.objects".into(), "ingest.npy.hint.no_objects"),
        TypeFault::Unknown(text) => {
            (note!("ingest.npy.type").with("type", text), "ingest.npy.hint.save_numbers")
        }
        TypeFault::TooMany => too_many(),
    }
}

fn too_many() -> Fault {
    (note!("ingest.binary.too_many_columns", most = MAX_COLUMNS), "ingest.hint.give_recording")
}

/// The columns of an array and where their values stand.
pub(super) struct Columns {
    /// Number of rows.
    pub rows: u64,
    /// Name, type and place of each.
    pub list: Vec<Place>,
    /// True when a row stands together; false when a column does.
    pub by_rows: bool,
    /// Length of a row where rows stand together, else of an element, bytes.
    pub stride: usize,
    /// Why rows and columns are as they are, where that is not plain.
    pub note: Option<Note>,
}

/// A column of an array.
pub(super) struct Place {
    pub column: Column,
    /// Field of the row, or of the element.
    pub field: Option<Field>,
    /// First byte of the column in the data, where columns stand together.
    pub from: u64,
}

impl Array {
    /// True for a single number.
    pub fn is_scalar(&self) -> bool {
        self.element.leaves.len() == 1 && self.shape.iter().all(|n| *n == 1)
    }

    /// The columns. `name` stands before them, empty for an array alone in its file; `data` are first bytes of the
    /// data, from which dates get their zero.
    pub fn columns(&self, name: &str, data: &[u8]) -> Result<Columns, Fault> {
        let mut shape: Vec<u64> = self.shape.iter().copied().filter(|n| *n != 1).collect();
        if shape.is_empty() {
            shape.push(1);
        }
        let single = matches!(self.element.leaves.as_slice(), [leaf] if leaf.name.is_empty());
        let (rows, count, flat) = match shape.as_slice() {
            [n] => (*n, 1, None),
            [rows, columns] if single => {
                let flat = *rows <= MAX_CHANNELS && *columns > MAX_CHANNELS && *columns / FLAT >= *rows;
                let note = note!("ingest.npy.flat", rows = *rows, columns = *columns);
                if flat { (*columns, *rows, Some(note)) } else { (*rows, *columns, None) }
            }
            _ => {
                let text: Vec<String> = self.shape.iter().map(u64::to_string).collect();
                let note = note!("ingest.npy.dimensions", shape = text.join(" × "));
                return Err((note, "ingest.npy.hint.two_dimensions"));
            }
        };
        let bytes = self.element.bytes;
        let count = usize::try_from(count).ok().filter(|n| *n <= MAX_COLUMNS).ok_or_else(too_many)?;
        let by_rows = count == 1 || self.fortran_order == flat.is_some();
        let stride = if by_rows { bytes.checked_mul(count) } else { Some(bytes) };
        let stride = stride.filter(|n| (1..=MAX_RECORD_BYTES).contains(n)).ok_or_else(too_many)?;
        let mut list = Vec::new();
        for j in 0..count {
            for leaf in &self.element.leaves {
                let shift = if by_rows { j * bytes } else { 0 };
                let from = if by_rows { 0 } else { rows.saturating_mul((j * bytes) as u64) };
                list.push(Place {
                    from,
                    ..self.place(leaf, label(name, leaf, j, count), shift, stride, data)
                });
            }
        }
        Ok(Columns { rows, list, by_rows, stride, note: flat })
    }

    fn place(&self, leaf: &Leaf, name: String, shift: usize, stride: usize, data: &[u8]) -> Place {
        let mut column = Column {
            name,
            numeric: leaf.field.is_some(),
            storage: leaf.storage.clone(),
            unit: None,
            epoch_s: None,
            rollover_s: None,
            judged: None,
        };
        let mut field = leaf.field;
        if let Some(field) = &mut field {
            field.offset += shift;
            if let Some(ticks) = field.ticks {
                column.unit = Some("s".to_owned());
                if leaf.date {
                    let (zero, epoch_s) = zero(ticks, first_tick(field, data, stride));
                    field.ticks = Some(Ticks { zero, ..ticks });
                    column.epoch_s = Some(epoch_s);
                }
            }
        }
        Place { column, field, from: 0 }
    }
}

/// The name of a column.
fn label(name: &str, leaf: &Leaf, j: usize, count: usize) -> String {
    match (name.is_empty(), leaf.name.is_empty()) {
        (true, true) => format!("column_{}", j + 1),
        (true, false) => leaf.name.clone(),
        (false, false) => format!("{name}.{}", leaf.name),
        (false, true) if count == 1 => name.to_owned(),
        (false, true) => format!("{name}[{j}]"),
    }
}

/// The first date among some records.
fn first_tick(field: &Field, data: &[u8], stride: usize) -> Option<i64> {
    data.chunks_exact(stride.max(1))
        .filter_map(|record| field.whole(record, 8))
        .map(u64::cast_signed)
        .find(|tick| *tick != i64::MIN)
}

/// The tick at the zero of the values and the seconds from 1970 to it: the whole second at or before the first date,
/// where ticks fall on it.
fn zero(ticks: Ticks, first: Option<i64>) -> (i64, f64) {
    let first = first.unwrap_or(0);
    let (factor, divisor) = (ticks.tick_s.0 as i128, ticks.tick_s.1 as i128);
    let second = (i128::from(first) * factor).div_euclid(divisor.max(1));
    let scaled = second * divisor;
    match i64::try_from(scaled / factor.max(1)) {
        Ok(tick) if scaled % factor.max(1) == 0 => (tick, second as f64),
        _ => (first, first as f64 * ticks.tick_s.0 / ticks.tick_s.1),
    }
}

#[cfg(test)]
#[path = "array_tests.rs"]
mod tests;
