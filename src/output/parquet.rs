//! Tables in Parquet: a row each, columns by functions of a row; recordings as columns of doubles.

use parquet::basic::{Compression, Repetition, Type as Physical, ZstdLevel};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::parser::parse_message_type;
use parquet::schema::types::{ColumnPath, Type};
use std::io::{self, Write};
use std::sync::Arc;

/// Rows of a group: what is held in memory at once.
const GROUP_ROWS: usize = 65_536;

/// Most rows of a group of a recording, so that a reader need not hold more.
const RECORDING_GROUP_ROWS: usize = 1 << 20;

/// Compression of a recording. Higher levels make the time no smaller and take longer.
const RECORDING_LEVEL: i32 = 1;

/// Rows that tell whether a column is worth its compression.
const TRIED_ROWS: usize = 1 << 13;

/// Share of the size that compression must leave at most. Noise keeps 0.96 of it, and takes longer to read and to write than all else of it.
const WORTH: f64 = 0.9;

/// Columns of doubles, written as their rows arrive.
pub struct Doubles<W: Write + Send> {
    stage: Stage<W>,
}

/// How far a file is. The first rows decide about compression, which the writer must know before them.
enum Stage<W: Write + Send> {
    Waiting {
        out: W,
        columns: Vec<String>,
    },
    Begun(Box<SerializedFileWriter<W>>),
    /// The writer could not be made.
    Failed,
}

impl<W: Write + Send> Doubles<W> {
    /// A file with columns of these names, so far without rows.
    pub fn begin(out: W, columns: &[&str]) -> Doubles<W> {
        let columns = columns.iter().map(|name| (*name).to_owned()).collect();
        Doubles { stage: Stage::Waiting { out, columns } }
    }

    /// The writer, made for the first rows.
    fn writer(&mut self, rows: &[&[f64]]) -> io::Result<&mut SerializedFileWriter<W>> {
        self.stage = match std::mem::replace(&mut self.stage, Stage::Failed) {
            Stage::Waiting { out, columns } => Stage::Begun(Box::new(writer_of(out, &columns, rows)?)),
            other => other,
        };
        match &mut self.stage {
            Stage::Begun(writer) => Ok(writer),
            // Why it could not be made was said before.
            _ => Err(io::ErrorKind::BrokenPipe.into()),
        }
    }

    /// Writes rows, a slice each column, all of one length.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn rows(&mut self, columns: &[&[f64]]) -> io::Result<()> {
        let rows = columns.first().map_or(0, |c| c.len());
        if rows == 0 {
            return Ok(());
        }
        let writer = self.writer(columns)?;
        for from in (0..rows).step_by(RECORDING_GROUP_ROWS) {
            let to = (from + RECORDING_GROUP_ROWS).min(rows);
            let mut group = writer.next_row_group().map_err(as_io)?;
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
    pub fn end(mut self) -> io::Result<()> {
        self.writer(&[])?.finish().map(|_| ()).map_err(as_io)
    }
}

/// The writer of a file that begins with these rows. Noise hardly repeats a value: a dictionary is a third of the work, and given up in
/// the end.
fn writer_of<W: Write + Send>(
    out: W,
    columns: &[String],
    rows: &[&[f64]],
) -> io::Result<SerializedFileWriter<W>> {
    let column = |name: &String| {
        let column = Type::primitive_type_builder(name, Physical::DOUBLE);
        column.with_repetition(Repetition::REQUIRED).build().map(Arc::new)
    };
    let fields = columns.iter().map(column).collect::<Result<Vec<_>, _>>().map_err(as_io)?;
    let schema = Type::group_type_builder("recording").with_fields(fields).build().map_err(as_io)?;
    let level = ZstdLevel::try_new(RECORDING_LEVEL).map_err(as_io)?;
    let mut properties =
        WriterProperties::builder().set_compression(Compression::ZSTD(level)).set_dictionary_enabled(false);
    for (name, values) in columns.iter().zip(rows) {
        if !is_worth_compression(values)? {
            let path = ColumnPath::new(vec![name.clone()]);
            properties = properties.set_column_compression(path, Compression::UNCOMPRESSED);
        }
    }
    SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties.build())).map_err(as_io)
}

/// True where the first values of a column get smaller by more than noise does.
fn is_worth_compression(values: &[f64]) -> io::Result<bool> {
    let first = values.get(..TRIED_ROWS).unwrap_or(values);
    let bytes: Vec<u8> = first.iter().flat_map(|v| v.to_le_bytes()).collect();
    let compressed = zstd::bulk::compress(&bytes, RECORDING_LEVEL)?;
    Ok(compressed.len() as f64 <= WORTH * bytes.len() as f64)
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

#[cfg(test)]
mod tests {
    use super::*;
    use parquet::column::reader::ColumnReader;
    use parquet::file::reader::{FileReader, SerializedFileReader};

    /// Numbers whose bits are as good as random.
    fn noise(rows: usize) -> Vec<f64> {
        let mut state = 0x9e37_79b9_7f4a_7c15_u64;
        let mut next = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..rows).map(|_| next() + next() - 1.0).collect()
    }

    #[test]
    fn noise_is_stored_as_it_is_and_time_is_compressed() {
        let time: Vec<f64> = (0..20_000).map(|i| 0.01 * f64::from(i)).collect();
        let columns = [time, noise(20_000), vec![25.0; 20_000]];
        let file = tempfile::NamedTempFile::new().unwrap();
        let mut written = Doubles::begin(file.reopen().unwrap(), &["time_s", "rate_deg_h", "temperature_c"]);
        for part in [0..12_000, 12_000..20_000] {
            let rows: Vec<&[f64]> = columns.iter().map(|c| &c[part.clone()]).collect();
            written.rows(&rows).unwrap();
        }
        written.end().unwrap();
        let reader = SerializedFileReader::new(file.reopen().unwrap()).unwrap();
        let (mut read, mut compressions) = (vec![vec![]; 3], vec![]);
        for group in 0..reader.num_row_groups() {
            let group = reader.get_row_group(group).unwrap();
            for (column, values) in read.iter_mut().enumerate() {
                compressions.push(group.metadata().column(column).compression() != Compression::UNCOMPRESSED);
                let ColumnReader::DoubleColumnReader(mut doubles) = group.get_column_reader(column).unwrap()
                else {
                    panic!("column {column} holds no doubles");
                };
                doubles.read_records(20_000, None, None, values).unwrap();
            }
        }
        assert_eq!(read, columns);
        assert_eq!(compressions, [true, false, true, true, false, true]);
    }

    #[test]
    fn a_file_without_rows_has_its_columns() {
        let file = tempfile::NamedTempFile::new().unwrap();
        Doubles::begin(file.reopen().unwrap(), &["time_s", "rate_deg_h"]).end().unwrap();
        let reader = SerializedFileReader::new(file.reopen().unwrap()).unwrap();
        let metadata = reader.metadata().file_metadata();
        assert_eq!((metadata.num_rows(), metadata.schema_descr().num_columns()), (0, 2));
    }
}
