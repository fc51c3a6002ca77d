//! Arrow arrays and tables as columns of a recording. Numbers are read where they are, in blocks.

use crate::errors::argument;
use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, Int64Type};
use arrow_array::{Array, ArrayRef};
use arrow_cast::cast;
use arrow_schema::{DataType, TimeUnit};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyDictMethods};
use pyo3_arrow::input::{AnyArray, AnyRecordBatch};
use sagnac::ingest::{MemoryColumn, MemoryValues};
use std::ops::Range;

/// Numbers in one or more Arrow arrays of one type.
pub struct ArrowValues {
    pieces: Vec<ArrayRef>,
    /// Row at which each piece begins, and the number of rows at the end.
    starts: Vec<usize>,
    /// Offset taken off integers before they become numbers, and the factor they are then multiplied by.
    stamps: Option<(i64, f64)>,
}

impl ArrowValues {
    /// `None` for a type that holds no numbers.
    fn new(pieces: Vec<ArrayRef>) -> Option<ArrowValues> {
        let kind = pieces.first().map_or(DataType::Float64, |p| p.data_type().clone());
        let mut starts = vec![0];
        for piece in &pieces {
            starts.push(starts.last().copied().unwrap_or(0) + piece.len());
        }
        let mut values = ArrowValues { pieces, starts, stamps: None };
        match kind {
            kind if kind.is_numeric() => {}
            DataType::Timestamp(unit, _) => {
                let first = values.pieces.iter().find_map(first_integer).unwrap_or(0);
                values.stamps = Some((first, unit_s(unit)));
            }
            _ => return None,
        }
        Some(values)
    }

    /// Time that stamps count from, s since 1970.
    fn epoch_s(&self) -> Option<f64> {
        self.stamps.map(|(first, unit_s)| first as f64 * unit_s)
    }

    fn append_piece(&self, piece: &ArrayRef, rows: Range<usize>, to: &mut Vec<f64>) {
        if self.stamps.is_none()
            && let Some(numbers) = piece.as_primitive_opt::<Float64Type>()
        {
            if numbers.null_count() == 0 {
                to.extend_from_slice(numbers.values().get(rows).unwrap_or_default());
            } else {
                to.extend(rows.map(|i| if numbers.is_null(i) { f64::NAN } else { numbers.value(i) }));
            }
            return;
        }
        // Other types become numbers a block at a time.
        let block = piece.slice(rows.start, rows.len());
        let wanted = if self.stamps.is_some() { DataType::Int64 } else { DataType::Float64 };
        let Ok(block) = cast(&block, &wanted) else {
            to.extend(rows.map(|_| f64::NAN));
            return;
        };
        match self.stamps {
            Some((first, unit_s)) => {
                let stamps = block.as_primitive::<Int64Type>();
                to.extend(stamps.iter().map(|t| t.map_or(f64::NAN, |t| (t - first) as f64 * unit_s)));
            }
            None => {
                let numbers = block.as_primitive::<Float64Type>();
                to.extend(numbers.iter().map(|v| v.unwrap_or(f64::NAN)));
            }
        }
    }
}

impl MemoryValues for ArrowValues {
    fn rows(&self) -> usize {
        self.starts.last().copied().unwrap_or(0)
    }

    fn append(&self, rows: Range<usize>, to: &mut Vec<f64>) {
        let first = self.starts.partition_point(|start| *start <= rows.start).saturating_sub(1);
        for (piece, start) in self.pieces.iter().zip(&self.starts).skip(first) {
            let from = rows.start.max(*start);
            let until = rows.end.min(start + piece.len());
            if from >= rows.end {
                break;
            }
            if from < until {
                self.append_piece(piece, from - start..until - start, to);
            }
        }
    }
}

fn first_integer(piece: &ArrayRef) -> Option<i64> {
    let integers = cast(&piece.slice(0, piece.len().min(4096)), &DataType::Int64).ok()?;
    integers.as_primitive::<Int64Type>().iter().flatten().next()
}

fn unit_s(unit: TimeUnit) -> f64 {
    match unit {
        TimeUnit::Second => 1.0,
        TimeUnit::Millisecond => 1e-3,
        TimeUnit::Microsecond => 1e-6,
        TimeUnit::Nanosecond => 1e-9,
    }
}

/// The numbers of one array: anything that Arrow or the buffer protocol hands over without a copy.
pub fn values(array: &Bound<'_, PyAny>, name: &str) -> PyResult<ArrowValues> {
    let py = array.py();
    let refused = |why: &str| argument(py, &format!("{name}: {why}"));
    let pieces = array
        .extract::<AnyArray>()
        .and_then(|any| Ok(any.into_chunked_array()?))
        .map_err(|e| refused(&format!("not an array of numbers ({})", e.value(py))))?;
    let (pieces, field) = pieces.into_inner();
    ArrowValues::new(pieces).ok_or_else(|| refused(&format!("holds {}, not numbers", field.data_type())))
}

/// The columns of a dictionary of arrays, or of anything that Arrow hands over as a table. Columns of a table that hold no numbers are
/// left out.
pub fn columns(source: &Bound<'_, PyAny>) -> PyResult<Vec<MemoryColumn>> {
    if let Ok(arrays) = source.cast::<PyDict>() {
        let named = arrays.iter().map(|(name, array)| {
            let name: String = name.extract()?;
            let values = values(&array, &name)?;
            Ok(column(name, values))
        });
        return named.collect();
    }
    let py = source.py();
    let table = source
        .extract::<AnyRecordBatch>()
        .and_then(|any| Ok(any.into_table()?))
        .map_err(|e| argument(py, &format!("neither a path nor a table of columns ({})", e.value(py))))?;
    let (batches, schema) = table.into_inner();
    let fields = schema.fields().iter().enumerate();
    let numbers = fields.filter_map(|(i, field)| {
        let values = ArrowValues::new(batches.iter().map(|b| b.column(i).clone()).collect())?;
        Some(column(field.name().clone(), values))
    });
    Ok(numbers.collect())
}

fn column(name: String, values: ArrowValues) -> MemoryColumn {
    let epoch_s = values.epoch_s();
    MemoryColumn { name, values: Box::new(values), epoch_s }
}
