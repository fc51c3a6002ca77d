//! The measured quantities of a run as a table: a row each, the same in every language.

use super::{ExportedFile, Exporter};
use crate::output::{Column, csv_line, write_table};
use crate::record::MeasurandRecord;
use crate::report::{Document, Renderer, ReportError};

/// The columns, in their order.
const COLUMNS: &[(&str, Column<MeasurandRecord>)] = &[
    ("measurand", Column::Text(|m| m.id.clone())),
    ("channel", Column::Text(|m| m.channel.clone())),
    ("phase", Column::Text(|m| m.phase.clone().unwrap_or_default())),
    ("unit", Column::Text(|m| m.unit.clone())),
    ("value", Column::Number(|m| m.value)),
    ("low", Column::Number(|m| Some(m.interval?.low))),
    ("high", Column::Number(|m| Some(m.interval?.high))),
    ("coverage", Column::Number(|m| Some(m.interval?.coverage))),
    ("upper_limit", Column::Number(|m| Some(m.upper_limit?.value))),
    ("upper_limit_coverage", Column::Number(|m| Some(m.upper_limit?.coverage))),
    ("limit_min", Column::Number(|m| m.limit.as_ref()?.min)),
    ("limit_max", Column::Number(|m| m.limit.as_ref()?.max)),
    ("acceptance_min", Column::Number(|m| m.limit.as_ref()?.acceptance_min)),
    ("acceptance_max", Column::Number(|m| m.limit.as_ref()?.acceptance_max)),
    ("margin", Column::Number(|m| m.margin)),
    ("specific_risk", Column::Number(|m| m.specific_risk)),
    ("verdict", Column::Text(|m| m.verdict.id().to_owned())),
    ("method", Column::Text(|m| m.method.clone())),
];

/// The table as CSV, every number to the last digit.
pub fn csv(rows: &[MeasurandRecord]) -> String {
    let mut out = csv_line(COLUMNS.iter().map(|(name, _)| *name));
    for row in rows {
        let field = |(_, column): &(&str, Column<MeasurandRecord>)| match column {
            Column::Count(of) => of(row).to_string(),
            Column::Text(of) => of(row),
            Column::Number(of) => of(row).map(|v| format!("{v:?}")).unwrap_or_default(),
        };
        out.push_str(&csv_line(COLUMNS.iter().map(field)));
    }
    out
}

/// The table as `measurands.parquet`; of other results nothing.
pub struct Parquet;

impl Exporter for Parquet {
    fn id(&self) -> &'static str {
        "parquet"
    }

    fn files(&self, document: &Document<'_>, _: &Renderer) -> Result<Vec<ExportedFile>, ReportError> {
        let Some(run) = document.run() else { return Ok(vec![]) };
        let mut bytes = vec![];
        write_table(&run.measurands, COLUMNS, &mut bytes).map_err(|e| ReportError::Parquet(e.to_string()))?;
        Ok(vec![ExportedFile::new("measurands.parquet", bytes)])
    }
}
