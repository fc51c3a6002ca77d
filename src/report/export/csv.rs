//! Tables.

use super::measurands::csv;
use super::{ExportedFile, Exporter};
use crate::report::{Document, Renderer, ReportError};

/// Tables such as `sigma_tau.csv`, the quantities of a run as `measurands.csv`, and what else is written for other programs, such as compensation coefficients.
pub struct Csv;

impl Exporter for Csv {
    fn id(&self) -> &'static str {
        "csv"
    }

    fn files(&self, document: &Document<'_>, _: &Renderer) -> Result<Vec<ExportedFile>, ReportError> {
        let tables = document.tables.iter().map(|(name, text)| ExportedFile::new(name, text.as_str()));
        let measurands = document.run().map(|run| ExportedFile::new("measurands.csv", csv(&run.measurands)));
        Ok(tables.chain(measurands).collect())
    }
}
