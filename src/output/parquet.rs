//! Tables in Parquet: a row each, columns by functions of a row.

use parquet::basic::{Compression, ZstdLevel};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::parser::parse_message_type;
use std::io::Write;
use std::sync::Arc;

/// Rows of a group: what is held in memory at once.
const GROUP_ROWS: usize = 65_536;

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
