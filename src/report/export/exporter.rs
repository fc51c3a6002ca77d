//! A form of results.

use crate::report::{Document, Renderer, ReportError};

/// A form in which results are written.
pub trait Exporter: Sync {
    /// The word that selects it: `--format html`.
    fn id(&self) -> &'static str;

    /// The files of a document, named relative to its folder.
    ///
    /// # Errors
    /// [`ReportError`] when a template is wrong.
    fn files(&self, document: &Document<'_>, renderer: &Renderer) -> Result<Vec<ExportedFile>, ReportError>;
}

/// A file to be written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExportedFile {
    /// Name relative to the folder, with `/` between folders.
    pub name: String,
    /// What it holds.
    pub contents: Vec<u8>,
}

impl ExportedFile {
    /// A file with a text or bytes.
    pub fn new(name: impl Into<String>, contents: impl Into<Vec<u8>>) -> ExportedFile {
        ExportedFile { name: name.into(), contents: contents.into() }
    }
}
