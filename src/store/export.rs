//! The measurands of all results as a table in Parquet: one row a measurand.

use super::entry::EntryMeasurand;
use super::error::StoreError;
use super::index::{Attempt, Filter};
use super::opened::Store;
use crate::output::{OutputError, StagedFile};
use parquet::basic::{Compression, ZstdLevel};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::parser::parse_message_type;
use std::fs::File;
use std::path::Path;
use std::sync::Arc;

/// Rows of a group: what is held in memory at once.
const GROUP: usize = 65_536;

/// One row of the table.
struct Measured<'a> {
    of: &'a Attempt,
    what: &'a EntryMeasurand,
}

/// How a column gets its values.
enum Column {
    /// A text; never absent, empty where nothing is stated.
    Text(fn(&Measured<'_>) -> String),
    /// A number, or none.
    Number(fn(&Measured<'_>) -> Option<f64>),
    /// A count.
    Count(fn(&Measured<'_>) -> i64),
}

/// The columns, in their order.
const COLUMNS: &[(&str, Column)] = &[
    ("serial", Column::Text(|r| r.of.entry.unit.serial.clone())),
    ("model", Column::Text(|r| r.of.entry.unit.model.clone())),
    ("lot", Column::Text(|r| r.of.entry.unit.lot.clone())),
    ("build_date", Column::Text(|r| r.of.entry.unit.build_date.clone().unwrap_or_default())),
    ("reference", Column::Count(|r| i64::from(r.of.entry.unit.reference))),
    ("procedure", Column::Text(|r| r.of.entry.test.procedure.clone())),
    ("revision", Column::Text(|r| r.of.entry.test.revision.clone())),
    ("station", Column::Text(|r| r.of.entry.test.station.clone())),
    ("operator", Column::Text(|r| r.of.entry.test.operator.clone())),
    ("evaluated_at", Column::Text(|r| r.of.entry.test.evaluated_at.clone())),
    ("attempt", Column::Count(|r| r.of.number as i64)),
    ("verdict", Column::Text(|r| r.of.entry.verdict.id().to_owned())),
    ("superseded_by", Column::Text(|r| r.of.superseded.as_ref().map(|c| c.by.clone()).unwrap_or_default())),
    ("measurand", Column::Text(|r| r.what.id.clone())),
    ("channel", Column::Text(|r| r.what.channel.clone())),
    ("phase", Column::Text(|r| r.what.phase.clone().unwrap_or_default())),
    ("unit", Column::Text(|r| r.what.unit.clone())),
    ("value", Column::Number(|r| r.what.value)),
    ("low", Column::Number(|r| r.what.interval.map(|i| i.low))),
    ("high", Column::Number(|r| r.what.interval.map(|i| i.high))),
    ("coverage", Column::Number(|r| r.what.interval.map(|i| i.coverage))),
    ("upper_limit", Column::Number(|r| r.what.upper_limit.map(|u| u.value))),
    ("limit_min", Column::Number(|r| r.what.min)),
    ("limit_max", Column::Number(|r| r.what.max)),
    ("measurand_verdict", Column::Text(|r| r.what.verdict.id().to_owned())),
    ("address", Column::Text(|r| r.of.address.clone())),
    ("result_sha256", Column::Text(|r| r.of.entry.result_sha256.clone())),
    ("procedure_sha256", Column::Text(|r| r.of.entry.test.procedure_sha256.clone())),
    ("limits_sha256", Column::Text(|r| r.of.entry.test.limits_sha256.clone())),
    (
        "recording_sha256",
        Column::Text(|r| {
            let all: Vec<&str> = r.of.entry.recordings.iter().map(|f| f.sha256.as_str()).collect();
            all.join(" ")
        }),
    ),
];

/// Writes the table; the file appears whole or not at all. Gives the number of rows.
///
/// # Errors
/// [`StoreError`] where the index or the file refuses.
pub fn export(store: &Store, filter: &Filter, out: &Path, replace: bool) -> Result<usize, StoreError> {
    let attempts = store.attempts(filter)?;
    let staged = StagedFile::begin(out, &[], replace)?;
    let rows: Vec<Measured<'_>> = attempts
        .iter()
        .flat_map(|of| of.entry.measurands.iter().map(move |what| Measured { of, what }))
        .collect();
    let refused = |e: ParquetError| OutputError::Io {
        action: "output_error.write",
        path: out.to_owned(),
        source: std::io::Error::other(e.to_string()),
    };
    write(&rows, staged.file()?).map_err(refused)?;
    staged.publish()?;
    Ok(rows.len())
}

fn write(rows: &[Measured<'_>], file: File) -> Result<(), ParquetError> {
    let field = |(name, column): &(&str, Column)| match column {
        Column::Text(_) => format!("required binary {name} (string);"),
        Column::Number(_) => format!("optional double {name};"),
        Column::Count(_) => format!("required int64 {name};"),
    };
    let fields: String = COLUMNS.iter().map(field).collect();
    let schema = Arc::new(parse_message_type(&format!("message measurands {{ {fields} }}"))?);
    let properties =
        WriterProperties::builder().set_compression(Compression::ZSTD(ZstdLevel::default())).build();
    let mut writer = SerializedFileWriter::new(file, schema, Arc::new(properties))?;
    for group in rows.chunks(GROUP) {
        let mut groups = writer.next_row_group()?;
        for (_, column) in COLUMNS {
            write_column(&mut groups, column, group)?;
        }
        groups.close()?;
    }
    writer.close().map(|_| ())
}

fn write_column(
    group: &mut SerializedRowGroupWriter<'_, File>,
    column: &Column,
    rows: &[Measured<'_>],
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
