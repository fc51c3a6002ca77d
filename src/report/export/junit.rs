//! JUnit XML, for systems of continuous integration.

use super::{ExportedFile, Exporter};
use crate::report::{Document, Renderer, ReportError, lot};

/// The verdicts of a lot or of a run as `junit.xml`; of other results nothing.
pub struct Junit;

impl Exporter for Junit {
    fn id(&self) -> &'static str {
        "junit"
    }

    fn files(&self, document: &Document<'_>, _: &Renderer) -> Result<Vec<ExportedFile>, ReportError> {
        let text = match (document.lot(), document.run()) {
            (Some(record), _) => lot::junit(record),
            (None, Some(run)) if run.procedure.is_some() => lot::junit_of_run(run),
            _ => return Ok(vec![]),
        };
        let text = text.map_err(|e| ReportError::Xml(e.to_string()))?;
        Ok(vec![ExportedFile::new("junit.xml", text)])
    }
}
