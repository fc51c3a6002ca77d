//! Forms in which results are written, one file each: an [`Exporter`] and its line in [`EXPORTERS`].

mod atml;
mod csv;
mod dcc;
mod docx;
mod exporter;
mod html;
mod json;
mod junit;
mod markdown;
mod measurands;
mod svg;
mod xlsx;
mod xml;

pub use atml::Atml;
pub use csv::Csv;
pub use dcc::{CERTIFICATE_FORM, Dcc, missing};
pub use docx::Docx;
pub use exporter::{ExportedFile, Exporter};
pub use html::Html;
pub use json::{Json, record_bytes};
pub use junit::Junit;
pub use markdown::Markdown;
pub use measurands::Parquet;
pub use svg::Svg;
pub use xlsx::Xlsx;

use super::{Document, Renderer, ReportError};
use std::collections::BTreeMap;

/// Every form that is written unasked, in the order of the help.
pub static EXPORTERS: &[&dyn Exporter] = &[&Html, &Markdown, &Csv, &Json, &Svg, &Junit];

/// Forms that are written where they are asked for by name.
pub static FURTHER: &[&dyn Exporter] = &[&Docx, &Xlsx, &Parquet, &Atml];

/// The files of a document in some forms: contents by name.
///
/// # Errors
/// [`ReportError`] when a template is wrong.
pub fn export(
    document: &Document<'_>,
    exporters: &[&dyn Exporter],
    renderer: &Renderer,
) -> Result<BTreeMap<String, Vec<u8>>, ReportError> {
    let mut files = BTreeMap::new();
    for exporter in exporters {
        files.extend(exporter.files(document, renderer)?.into_iter().map(|f| (f.name, f.contents)));
    }
    Ok(files)
}
