//! HTML.

use super::{ExportedFile, Exporter};
use crate::report::{Document, PageForm, Renderer, ReportError};

/// One page with its figures inside, `report.html`.
pub struct Html;

impl Exporter for Html {
    fn id(&self) -> &'static str {
        "html"
    }

    fn files(&self, document: &Document<'_>, renderer: &Renderer) -> Result<Vec<ExportedFile>, ReportError> {
        let page = document.text(PageForm::Html, renderer)?;
        Ok(vec![ExportedFile::new(document.page("html"), page)])
    }
}
