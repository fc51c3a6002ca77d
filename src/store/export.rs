//! The measurands of all results as a table in Parquet: one row a measurand.

use super::error::StoreError;
use super::index::{Attempt, Filter};
use super::opened::Store;
use crate::output::{Column, OutputError, StagedFile, write_table};
use crate::record::MeasurandRecord;
use parquet::errors::ParquetError;
use std::path::Path;

/// One row of the table.
struct Measured<'a> {
    of: &'a Attempt,
    what: &'a MeasurandRecord,
}

/// The columns, in their order.
fn columns<'a>() -> Vec<(&'static str, Column<Measured<'a>>)> {
    vec![
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
        (
            "superseded_by",
            Column::Text(|r| r.of.superseded.as_ref().map(|c| c.by.clone()).unwrap_or_default()),
        ),
        ("measurand", Column::Text(|r| r.what.id.clone())),
        ("channel", Column::Text(|r| r.what.channel.clone())),
        ("phase", Column::Text(|r| r.what.phase.clone().unwrap_or_default())),
        ("unit", Column::Text(|r| r.what.unit.clone())),
        ("value", Column::Number(|r| r.what.value)),
        ("low", Column::Number(|r| r.what.interval.map(|i| i.low))),
        ("high", Column::Number(|r| r.what.interval.map(|i| i.high))),
        ("coverage", Column::Number(|r| r.what.interval.map(|i| i.coverage))),
        ("upper_limit", Column::Number(|r| r.what.upper_limit.map(|u| u.value))),
        ("limit_min", Column::Number(|r| r.what.limits().min)),
        ("limit_max", Column::Number(|r| r.what.limits().max)),
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
    ]
}

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
    write_table(&rows, &columns(), staged.file()?).map_err(refused)?;
    staged.publish()?;
    Ok(rows.len())
}
