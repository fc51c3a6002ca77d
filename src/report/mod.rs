//! Documents: a record as a page of blocks, shown as HTML, Markdown, PDF and text for a terminal; figures as SVG.
//!
//! A module for each document turns its record into blocks ([`view`] that of a run), [`page`] lays them out in each form,
//! [`render`] has the templates, [`svg`] draws the figures. Nothing is measured or decided here, and no recording is needed.

#[cfg(feature = "serve")]
pub mod bench;
pub mod compare;
pub mod datasheet;
mod day;
mod document;
pub mod explain;
pub mod export;
mod figure_file;
mod files;
pub mod history;
pub mod joint;
pub mod lot;
pub mod methods;
pub mod number;
pub mod page;
pub mod paper;
pub mod parameters;
pub mod pdf;
pub mod plan;
pub mod proof;
mod prose;
mod rehearsal;
pub mod render;
mod results;
pub mod signatures;
pub mod svg;
pub mod terminal;
mod translator;
pub mod unit;
pub mod view;

pub use document::{Document, Documented, PageForm, Record, render_html, render_markdown};
pub use figure_file::FIGURES_FILE;
pub use render::{Renderer, ReportError};
pub use results::{
    ALTERNATIVES_FILE, ExplanationResults, JointResults, OtherResults, Results, RunResults, SCHEDULE_FILE,
    StoredResults,
};

use crate::figure::Figure;
use crate::i18n::Lang;
use std::path::Path;

/// Writes every figure as `<id>.svg` into a folder, which must exist.
///
/// # Errors
/// The file that could not be written, with the reason.
pub fn write_figures(folder: &Path, figures: &[Figure], lang: Lang) -> Result<(), ReportError> {
    for figure in figures {
        let path = folder.join(file_name(&figure.id));
        std::fs::write(&path, svg::render(figure, lang))
            .map_err(|source| ReportError::Io { path: path.display().to_string(), source })?;
    }
    Ok(())
}

/// Name of the file of a figure: its id with `.svg`. What could lead out of the folder, or is forbidden in names on
/// one of the common systems, is replaced.
pub fn file_name(id: &str) -> String {
    let stem: String = id
        .chars()
        .map(|c| if c.is_alphanumeric() || matches!(c, '_' | '-' | '.' | '@') { c } else { '-' })
        .collect();
    format!("{}.svg", stem.trim_start_matches('.'))
}

/// The program with its version.
fn generator() -> String {
    format!("{} {}", env!("CARGO_PKG_NAME"), env!("CARGO_PKG_VERSION"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_names_stay_in_their_folder() {
        assert_eq!(file_name("sigma_tau"), "sigma_tau.svg");
        assert_eq!(file_name("../../etc/x"), "-..-etc-x.svg");
        assert_eq!(file_name("a<b:c"), "a-b-c.svg");
    }
}
