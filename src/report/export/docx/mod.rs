//! A page for word processors: Office Open XML (ECMA-376), from the blocks that every form is made of.

mod blocks;
mod line;
mod package;
mod picture;
mod sign_off;
mod table;

use super::{ExportedFile, Exporter, Svg};
use crate::report::{Document, Renderer, ReportError};

/// A document for word processors, `report.docx`, with its figures inside and beside it.
pub struct Docx;

impl Exporter for Docx {
    fn id(&self) -> &'static str {
        "docx"
    }

    fn files(&self, document: &Document<'_>, renderer: &Renderer) -> Result<Vec<ExportedFile>, ReportError> {
        let mut files = Svg.files(document, renderer)?;
        files.push(ExportedFile::new(document.page("docx"), package::package(document, renderer)?));
        Ok(files)
    }
}
