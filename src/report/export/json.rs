//! JSON: the record, and the data of the figures beside it.

use super::{ExportedFile, Exporter};
use crate::figure::Figure;
use crate::report::{Document, Renderer, ReportError};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// File with the data of the figures, relative to the folder of a result.
pub const FIGURES_FILE: &str = "figures/data.json";

/// Version of [`FIGURES_FILE`].
pub const FIGURES_FORMAT: &str = "figures/1";

/// The data of the figures, from which they are drawn anew.
#[derive(Debug, Serialize, Deserialize)]
pub struct FigureFile<'a> {
    /// Always `figures/1`.
    pub format: Cow<'a, str>,
    /// The figures, in the order of the report.
    pub figures: Cow<'a, [Figure]>,
}

/// The record, such as `result.json`, with every number to the last digit; the data of its figures in
/// [`FIGURES_FILE`].
pub struct Json;

impl Exporter for Json {
    fn id(&self) -> &'static str {
        "json"
    }

    fn files(&self, document: &Document<'_>, _: &Renderer) -> Result<Vec<ExportedFile>, ReportError> {
        let record = serde_json::to_vec_pretty(&document.record()).map_err(ReportError::Json)?;
        let mut files = vec![ExportedFile::new(document.kind().record_file(), record)];
        let figures = document.own_figures();
        if !figures.is_empty() {
            let file = FigureFile { format: FIGURES_FORMAT.into(), figures: figures.into() };
            files
                .push(ExportedFile::new(FIGURES_FILE, serde_json::to_vec(&file).map_err(ReportError::Json)?));
        }
        Ok(files)
    }
}
