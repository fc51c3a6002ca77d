//! Apache Parquet: columns of numbers, read in batches of rows.

use crate::byte_stream::{Packing, io_error};
use crate::decode_pipeline::{Blocks, run_pipeline};
use crate::error::{IngestError, IngestErrorKind};
use crate::in_memory::non_finite;
use crate::open_file;
use crate::{Block, Candidate, Column, FieldFaultKind, FileFacts, Format, OnBlock, Opened, Table};
use ::parquet::basic::{ConvertedType, LogicalType, TimeUnit, Type};
use ::parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use ::parquet::data_type::DataType;
use ::parquet::errors::ParquetError;
use ::parquet::file::reader::{FileReader, SerializedFileReader};
use ::parquet::schema::types::ColumnDescriptor;
use sagnac_core::message::note;
use sagnac_core::numeric::range::usable;
use std::fs::File;
use std::path::{Path, PathBuf};

/// Rows in a block.
const ROWS: usize = 1 << 15;

/// Apache Parquet.
pub(super) struct Parquet;

impl Format for Parquet {
    fn id(&self) -> &'static str {
        "parquet"
    }

    fn recognises(&self, file: &Candidate) -> bool {
        file.head.starts_with(b"PAR1")
    }

    fn open(&self, file: &Candidate) -> Result<Opened, IngestError> {
        if file.packing != Packing::Plain {
            return Err(IngestError::new(
                IngestErrorKind::UnknownFormat,
                &file.path,
                note!("ingest.packed_parquet", packing = file.packing.id()),
            )
            .hint("ingest.hint.unpack_parquet"));
        }
        let reader = reader(&file.path)?;
        let metadata = reader.metadata().file_metadata();
        let rows = u64::try_from(metadata.num_rows()).unwrap_or(0);
        if rows == 0 {
            return Err(IngestError::new(IngestErrorKind::Empty, &file.path, "ingest.no_rows")
                .hint("ingest.hint.check_written"));
        }
        let columns = metadata.schema_descr().columns().iter().map(|c| describe(c)).collect();
        Ok(Opened {
            labels: Vec::new(),
            bad_blocks: Vec::new(),
            columns,
            rows_estimate: Some(rows),
            cut_off: Vec::new(),
            notes: vec![note!("ingest.note.row_groups", count = reader.num_row_groups())],
            metadata: Vec::new(),
            stated_sample_rate_hz: None,
            table: Box::new(ParquetFile { path: file.path.clone() }),
        })
    }
}

/// Name, type and unit of a column; numeric when it holds one plain number for each row.
fn describe(column: &ColumnDescriptor) -> Column {
    let logical = column.logical_type_ref();
    let plain = matches!(
        logical,
        None | Some(LogicalType::Integer(_) | LogicalType::Timestamp(_) | LogicalType::Time(_))
    );
    let number = matches!(
        column.physical_type(),
        Type::DOUBLE | Type::FLOAT | Type::INT32 | Type::INT64 | Type::BOOLEAN
    );
    let decimal = matches!(column.converted_type(), ConvertedType::DECIMAL);
    let single = column.max_rep_level() == 0 && column.path().parts().len() == 1;
    let unit = |u: &TimeUnit| match u {
        TimeUnit::MILLIS => "ms",
        TimeUnit::MICROS => "us",
        TimeUnit::NANOS => "ns",
    };
    Column {
        name: column.path().string(),
        numeric: plain && number && single && !decimal,
        storage: match logical {
            Some(l) => format!("{} ({l:?})", column.physical_type()),
            None => column.physical_type().to_string(),
        },
        unit: match logical {
            Some(LogicalType::Timestamp(t)) => Some(unit(&t.unit).to_owned()),
            Some(LogicalType::Time(t)) => Some(unit(&t.unit).to_owned()),
            _ => None,
        },
        epoch_s: None,
        rollover_s: None,
        judged: None,
    }
}

fn reader(path: &Path) -> Result<SerializedFileReader<File>, IngestError> {
    let file = open_file(path).map_err(|e| io_error(path, &e))?;
    SerializedFileReader::new(file).map_err(|e| damaged(path, &e))
}

fn damaged(path: &Path, error: &ParquetError) -> IngestError {
    let text = error.to_string();
    let hint = if text.contains("feature") || text.contains("codec") {
        "ingest.hint.codec"
    } else {
        "ingest.hint.damaged"
    };
    IngestError::new(IngestErrorKind::Damaged, path, note!("ingest.parquet_damaged", reason = text))
        .hint(hint)
}

struct ParquetFile {
    path: PathBuf,
}

impl Table for ParquetFile {
    fn read(&self, wanted: &[usize], on_block: &mut OnBlock<'_>) -> Result<Option<FileFacts>, IngestError> {
        run_pipeline(&self.path, wanted.len(), on_block, |blocks| self.decode(wanted, blocks))
    }
}

impl ParquetFile {
    /// Decodes every row group.
    fn decode(&self, wanted: &[usize], blocks: &mut Blocks) -> Result<(), IngestError> {
        let fail = |e: ParquetError| damaged(&self.path, &e);
        let reader = reader(&self.path)?;
        let size = std::fs::metadata(&self.path).map_err(|e| io_error(&self.path, &e))?.len();
        let total = u64::try_from(reader.metadata().file_metadata().num_rows()).unwrap_or(0).max(1);
        let mut stored: Vec<Stored> = wanted.iter().map(|_| Stored::default()).collect();
        for group in 0..reader.num_row_groups() {
            let group = reader.get_row_group(group).map_err(fail)?;
            let rows = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
            let mut columns = wanted
                .iter()
                .zip(&mut stored)
                .map(|(&w, stored)| {
                    group.get_column_reader(w).map(move |r| Decoder::new(r, stored)).map_err(fail)
                })
                .collect::<Result<Vec<_>, _>>()?;
            let mut left = rows;
            while left > 0 {
                let n = left.min(ROWS);
                let mut block = blocks.empty();
                for (slot, column) in columns.iter_mut().enumerate() {
                    column.batch(n, slot, &mut block).map_err(fail)?;
                }
                left -= n;
                let done = blocks.rows() + n as u64;
                block.bytes_done = (size as f64 * (done as f64 / total as f64)) as u64;
                if !blocks.pass_counted(block) {
                    return Ok(());
                }
            }
        }
        Ok(())
    }
}

/// Values of a column as they are stored, kept from batch to batch. Doubles need no such place.
#[derive(Default)]
struct Stored {
    floats: Vec<f32>,
    short: Vec<i32>,
    long: Vec<i64>,
    flags: Vec<bool>,
    levels: Vec<i16>,
}

/// Decodes one column of a row group.
struct Decoder<'a> {
    reader: ColumnReader,
    stored: &'a mut Stored,
}

impl<'a> Decoder<'a> {
    fn new(reader: ColumnReader, stored: &'a mut Stored) -> Decoder<'a> {
        Decoder { reader, stored }
    }

    fn batch(&mut self, rows: usize, slot: usize, block: &mut Block) -> Result<(), ParquetError> {
        let Stored { floats, short, long, flags, levels } = self.stored;
        let mut column = block.columns.get_mut(slot).map(std::mem::take).unwrap_or_default();
        let present = match &mut self.reader {
            ColumnReader::DoubleColumnReader(r) => {
                read(r, rows, levels, &mut column)?;
                column.len()
            }
            ColumnReader::FloatColumnReader(r) => values(r, rows, levels, floats, &mut column, f64::from)?,
            ColumnReader::Int32ColumnReader(r) => values(r, rows, levels, short, &mut column, f64::from)?,
            ColumnReader::Int64ColumnReader(r) => values(r, rows, levels, long, &mut column, |v| v as f64)?,
            ColumnReader::BoolColumnReader(r) => {
                values(r, rows, levels, flags, &mut column, |v| f64::from(u8::from(v)))?
            }
            _ => return Err(ParquetError::General("the column holds no numbers".to_owned())),
        };
        if present < rows {
            spread_over_nulls(&mut column, levels, rows);
        }
        count_non_finite(&mut column, slot, block, |i| {
            present < rows && levels.get(i).is_some_and(|&l| l == 0)
        });
        if let Some(place) = block.columns.get_mut(slot) {
            *place = column;
        }
        Ok(())
    }
}

/// Reads the values of so many rows, without those that are null.
fn read<T: DataType>(
    reader: &mut ColumnReaderImpl<T>,
    rows: usize,
    levels: &mut Vec<i16>,
    values: &mut Vec<T::T>,
) -> Result<(), ParquetError> {
    levels.clear();
    values.clear();
    let (records, ..) = reader.read_records(rows, Some(levels), None, values)?;
    if records != rows {
        return Err(ParquetError::General(format!("{rows} values expected, {records} found")));
    }
    Ok(())
}

/// The same as numbers; gives how many there are.
fn values<T: DataType>(
    reader: &mut ColumnReaderImpl<T>,
    rows: usize,
    levels: &mut Vec<i16>,
    stored: &mut Vec<T::T>,
    column: &mut Vec<f64>,
    number: impl Fn(T::T) -> f64,
) -> Result<usize, ParquetError>
where
    T::T: Copy,
{
    read(reader, rows, levels, stored)?;
    column.clear();
    column.extend(stored.iter().map(|&v| number(v)));
    Ok(column.len())
}

/// Puts the values of a column at their rows, NaN where a row is null.
fn spread_over_nulls(column: &mut Vec<f64>, levels: &[i16], rows: usize) {
    let top = levels.iter().copied().max().unwrap_or(0).max(1);
    let mut left = column.len();
    column.resize(rows, f64::NAN);
    // From behind: a value never moves to a place before its own.
    for row in (0..rows).rev() {
        let value = if levels.get(row) == Some(&top) { left.checked_sub(1) } else { None };
        let moved = value.and_then(|at| column.get(at).copied());
        left = value.unwrap_or(left);
        if let Some(place) = column.get_mut(row) {
            *place = moved.unwrap_or(f64::NAN);
        }
    }
}

/// Counts what is no number, as null or by its text, and marks it as NaN.
fn count_non_finite(column: &mut [f64], slot: usize, block: &mut Block, is_null: impl Fn(usize) -> bool) {
    // Without a branch a row, so that a column without faults is gone through several rows at a time.
    if column.iter().fold(true, |all, v| all & usable(*v)) {
        return;
    }
    for (i, v) in column.iter_mut().enumerate().filter(|(_, v)| !usable(**v)) {
        let (row, text) = (block.first_row + i as u64, *v);
        let describe =
            || non_finite(slot, row, if is_null(i) { "null".to_owned() } else { text.to_string() });
        block.fault(describe, slot, FieldFaultKind::NonFinite);
        *v = f64::NAN;
    }
}

#[cfg(test)]
mod tests {
    use crate::english::english;
    use ::parquet::data_type::{ByteArrayType, DoubleType, FloatType, Int32Type, Int64Type};
    use ::parquet::file::writer::SerializedFileWriter;
    use sagnac_core::recording::ColumnRef;
    use std::ops::ControlFlow;

    #[test]
    fn parquet_numbers_nulls_and_words() {
        let schema = "message m { required double t; optional float r; required int32 i; required int64 l;
                      required binary word (UTF8); optional int64 stamp (TIMESTAMP(MILLIS,true)); }";
        let schema = std::sync::Arc::new(::parquet::schema::parser::parse_message_type(schema).unwrap());
        let f = tempfile::NamedTempFile::new().unwrap();
        let mut w = SerializedFileWriter::new(f.reopen().unwrap(), schema, Default::default()).unwrap();
        for group in 0..2i32 {
            let mut g = w.next_row_group().unwrap();
            macro_rules! column {
                ($t:ty, $values:expr, $levels:expr) => {
                    let mut c = g.next_column().unwrap().unwrap();
                    c.typed::<$t>().write_batch($values, $levels, None).unwrap();
                    c.close().unwrap();
                };
            }
            let base = f64::from(group) * 3.0;
            column!(DoubleType, &[base, base + 1.0, f64::INFINITY], None);
            column!(FloatType, &[1.5, 2.5], Some(&[1, 0, 1]));
            column!(Int32Type, &[1, 2, 3], None);
            column!(Int64Type, &[-1, 1 << 40, 3], None);
            column!(ByteArrayType, &["a".into(), "b".into(), "c".into()], None);
            column!(Int64Type, &[1_700_000_000_000, 1_700_000_000_001, 1_700_000_000_002], Some(&[1, 1, 1]));
            g.close().unwrap();
        }
        w.close().unwrap();
        let source = crate::open(f.path()).unwrap();
        assert_eq!(source.rows_estimate(), Some(6));
        let kinds: Vec<bool> = source.columns().iter().map(|c| c.numeric).collect();
        assert_eq!(kinds, [true, true, true, true, false, true]);
        assert_eq!(source.columns()[5].unit.as_deref(), Some("ms"));
        let e = source.resolve(&ColumnRef::Name("word".to_owned())).unwrap_err();
        assert!(english(&e.note()).contains("not numbers"), "{e}");
        let (mut columns, mut faults) = (vec![Vec::new(); 5], Vec::new());
        let facts = source.read(&[0, 1, 2, 3, 5], &mut |block| {
            columns.iter_mut().zip(&block.columns).for_each(|(all, part)| all.extend_from_slice(part));
            faults.append(&mut block.faults);
            ControlFlow::Continue(())
        });
        let facts = facts.unwrap().unwrap();
        assert_eq!(facts.rows, 6);
        assert_eq!((columns[0][3], columns[0][4]), (3.0, 4.0));
        assert!(columns[0][2].is_nan() && columns[1][1].is_nan());
        assert_eq!((columns[1][0], columns[1][2], columns[1][5]), (1.5, 2.5, 2.5));
        assert_eq!((columns[2][5], columns[3][4], columns[4][0]), (3.0, (1u64 << 40) as f64, 1.7e12));
        let found: Vec<(u64, usize, &str)> =
            faults.iter().map(|f| (f.row, f.slot, f.text.as_str())).collect();
        assert_eq!(found, [(3, 0, "inf"), (2, 1, "null"), (6, 0, "inf"), (5, 1, "null")]);
        assert_eq!(facts.sha256, crate::byte_stream::digest(f.path()).unwrap().sha256);
    }
}
