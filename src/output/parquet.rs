//! Tables in Parquet: a row each, columns by functions of a row; recordings as columns of doubles.

use parquet::basic::{Compression, Repetition, Type as Physical, ZstdLevel};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::parser::parse_message_type;
use parquet::schema::types::Type;
use std::io::{self, Write};
use std::sync::Arc;

/// Rows of a group: what is held in memory at once.
const GROUP_ROWS: usize = 65_536;

/// Most rows of a group of a recording, so that a reader need not hold more.
const RECORDING_GROUP_ROWS: usize = 1 << 20;

/// Compression of a recording.
const RECORDING_LEVEL: i32 = 3;

/// Columns of doubles, written as their rows arrive.
pub struct Doubles<W: Write + Send> {
    writer: SerializedFileWriter<W>,
}

impl<W: Write + Send> Doubles<W> {
    /// A file with columns of these names, so far without rows.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn begin(out: W, columns: &[&str]) -> io::Result<Doubles<W>> {
        let column = |name: &&str| {
            let column = Type::primitive_type_builder(name, Physical::DOUBLE);
            column.with_repetition(Repetition::REQUIRED).build().map(Arc::new)
        };
        let columns = columns.iter().map(column).collect::<Result<Vec<_>, _>>().map_err(as_io)?;
        let schema = Type::group_type_builder("recording").with_fields(columns).build().map_err(as_io)?;
        let level = ZstdLevel::try_new(RECORDING_LEVEL).map_err(as_io)?;
        // Noise hardly repeats a value: a dictionary is a third of the work, and given up in the end.
        let properties = WriterProperties::builder()
            .set_compression(Compression::ZSTD(level))
            .set_dictionary_enabled(false)
            .build();
        let writer = SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties)).map_err(as_io)?;
        Ok(Doubles { writer })
    }

    /// Writes rows, a slice each column, all of one length.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn rows(&mut self, columns: &[&[f64]]) -> io::Result<()> {
        let rows = columns.first().map_or(0, |c| c.len());
        for from in (0..rows).step_by(RECORDING_GROUP_ROWS) {
            let to = (from + RECORDING_GROUP_ROWS).min(rows);
            let mut group = self.writer.next_row_group().map_err(as_io)?;
            for column in columns {
                let Some(mut own) = group.next_column().map_err(as_io)? else { break };
                let part = column.get(from..to).unwrap_or_default();
                own.typed::<DoubleType>().write_batch(part, None, None).map_err(as_io)?;
                own.close().map_err(as_io)?;
            }
            group.close().map_err(as_io)?;
        }
        Ok(())
    }

    /// Ends the file.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn end(self) -> io::Result<()> {
        self.writer.close().map(|_| ()).map_err(as_io)
    }
}

fn as_io(e: ParquetError) -> io::Error {
    match e {
        ParquetError::External(inner) => match inner.downcast::<io::Error>() {
            Ok(own) => *own,
            Err(other) => io::Error::other(other),
        },
        other => io::Error::other(other),
    }
}

/// How a column gets its values.
pub enum Column<R> {
    /// A text; never absent, empty where nothing is stated.
    Text(fn(&R) -> String),
    /// A number, or none.
    Number(fn(&R) -> Option<f64>),
    /// A count.
    Count(fn(&R) -> i64),
}

/// Writes rows as a table of measurands, compressed, with their columns by name.
///
/// # Errors
/// The message of the library: a name that is none, or a file that cannot be written.
pub fn write_table<R, W: Write + Send>(
    rows: &[R],
    columns: &[(&str, Column<R>)],
    out: W,
) -> Result<(), ParquetError> {
    let field = |(name, column): &(&str, Column<R>)| match column {
        Column::Text(_) => format!("required binary {name} (string);"),
        Column::Number(_) => format!("optional double {name};"),
        Column::Count(_) => format!("required int64 {name};"),
    };
    let fields: String = columns.iter().map(field).collect();
    let schema = Arc::new(parse_message_type(&format!("message measurands {{ {fields} }}"))?);
    let properties =
        WriterProperties::builder().set_compression(Compression::ZSTD(ZstdLevel::default())).build();
    let mut writer = SerializedFileWriter::new(out, schema, Arc::new(properties))?;
    for group in rows.chunks(GROUP_ROWS) {
        let mut groups = writer.next_row_group()?;
        for (_, column) in columns {
            write_column(&mut groups, column, group)?;
        }
        groups.close()?;
    }
    writer.close().map(|_| ())
}

fn write_column<R, W: Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    column: &Column<R>,
    rows: &[R],
) -> Result<(), ParquetError> {
    let Some(mut out) = group.next_column()? else { return Ok(()) };
    match column {
        Column::Text(of) => {
            let values: Vec<ByteArray> = rows.iter().map(|r| of(r).into_bytes().into()).collect();
            out.typed::<ByteArrayType>().write_batch(&values, None, None)?;
        }
        Column::Number(of) => {
            let all: Vec<Option<f64>> = rows.iter().map(of).collect();
            let values: Vec<f64> = all.iter().flatten().copied().collect();
            let present: Vec<i16> = all.iter().map(|v| i16::from(v.is_some())).collect();
            out.typed::<DoubleType>().write_batch(&values, Some(&present), None)?;
        }
        Column::Count(of) => {
            let values: Vec<i64> = rows.iter().map(of).collect();
            out.typed::<Int64Type>().write_batch(&values, None, None)?;
        }
    }
    out.close()
}
