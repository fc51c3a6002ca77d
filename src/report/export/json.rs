//! JSON: the record, and the data of the figures beside it.

use super::{ExportedFile, Exporter};
use crate::report::figure_file::{FIGURES_FILE, text};
use crate::report::{Document, Renderer, ReportError};

/// The record, such as `result.json`, with every number to the last digit; the data of its figures in
/// [`FIGURES_FILE`].
pub struct Json;

impl Exporter for Json {
    fn id(&self) -> &'static str {
        "json"
    }

    fn files(&self, document: &Document<'_>, _: &Renderer) -> Result<Vec<ExportedFile>, ReportError> {
        let mut files = vec![ExportedFile::new(document.kind().record_file(), record_bytes(document)?)];
        let figures = document.own_figures();
        if !figures.is_empty() {
            files.push(ExportedFile::new(FIGURES_FILE, text(figures).map_err(ReportError::Json)?));
        }
        Ok(files)
    }
}

/// The record of a document as its file holds it.
///
/// # Errors
/// [`ReportError::Json`].
pub fn record_bytes(document: &Document<'_>) -> Result<Vec<u8>, ReportError> {
    serde_json::to_vec_pretty(&document.record()).map_err(ReportError::Json)
}
