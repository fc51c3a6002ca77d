//! JUnit XML, for systems of continuous integration.

use super::{ExportedFile, Exporter};
use crate::report::{Document, Renderer, ReportError, lot};

/// The verdicts of a lot as `junit.xml`; of other results nothing.
pub struct Junit;

impl Exporter for Junit {
    fn id(&self) -> &'static str {
        "junit"
    }

    fn files(&self, document: &Document<'_>, _: &Renderer) -> Result<Vec<ExportedFile>, ReportError> {
        let Some(record) = document.lot() else { return Ok(vec![]) };
        let text = lot::junit(record).map_err(|e| ReportError::Xml(e.to_string()))?;
        Ok(vec![ExportedFile::new("junit.xml", text)])
    }
}
