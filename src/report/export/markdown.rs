//! Markdown.

use super::{ExportedFile, Exporter, Svg};
use crate::report::{Document, PageForm, Renderer, ReportError};

/// A page, `report.md`, with its figures beside it.
pub struct Markdown;

impl Exporter for Markdown {
    fn id(&self) -> &'static str {
        "md"
    }

    fn files(&self, document: &Document<'_>, renderer: &Renderer) -> Result<Vec<ExportedFile>, ReportError> {
        let page = document.text(PageForm::Markdown, renderer)?;
        let mut files = Svg.files(document, renderer)?;
        files.push(ExportedFile::new(document.page("md"), page));
        Ok(files)
    }
}
