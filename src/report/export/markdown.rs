//! Markdown.

use super::{ExportedFile, Exporter, Svg};
use crate::report::{Document, Renderer, ReportError};

/// A page, `report.md`, with its figures beside it.
pub struct Markdown;

impl Exporter for Markdown {
    fn id(&self) -> &'static str {
        "md"
    }

    fn files(&self, document: &Document<'_>, renderer: &Renderer) -> Result<Vec<ExportedFile>, ReportError> {
        let page = renderer.render(&document.template("md"), document.context(), document.lang)?;
        let mut files = Svg.files(document, renderer)?;
        files.push(ExportedFile::new(document.page("md"), page));
        Ok(files)
    }
}
