//! Figures as drawings.

use super::{ExportedFile, Exporter};
use crate::report::{Document, Renderer, ReportError, file_name, svg};

/// Each figure as `figures/<id>.svg`.
pub struct Svg;

impl Exporter for Svg {
    fn id(&self) -> &'static str {
        "svg"
    }

    fn files(&self, document: &Document<'_>, _: &Renderer) -> Result<Vec<ExportedFile>, ReportError> {
        let drawings = document.figures.iter().map(|figure| {
            ExportedFile::new(
                format!("figures/{}", file_name(&figure.id)),
                svg::render(figure, document.lang),
            )
        });
        Ok(drawings.collect())
    }
}
