//! What a result is written as, and how files get into a folder.

use super::Error;
use crate::figure::Figure;
use crate::i18n::Lang;
use crate::report::{ReportError, file_name, svg};
use std::io::Write;
use std::path::Path;

/// A form in which a result is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// `report.html`: one page with its figures inside.
    Html,
    /// `report.md`, with its figures as `figures/*.svg` beside it.
    Markdown,
    /// `result.json`, or `explain.json` for an explanation: every number to the last digit.
    Json,
    /// Tables such as `sigma_tau.csv`.
    Csv,
    /// `figures/*.svg`.
    Svg,
}

/// Writes a file into a folder, which is created where it is missing. The file appears complete or not at all, and takes
/// the place of one of the same name.
pub(super) fn put(folder: &Path, name: &str, contents: &[u8]) -> Result<(), Error> {
    let path = folder.join(name);
    let failed = |source| ReportError::Io { path: path.display().to_string(), source };
    let parent = path.parent().unwrap_or(folder);
    std::fs::create_dir_all(parent).map_err(failed)?;
    let mut file = tempfile::NamedTempFile::new_in(parent).map_err(failed)?;
    file.write_all(contents).map_err(failed)?;
    file.persist(&path).map_err(|e| failed(e.error))?;
    Ok(())
}

/// Writes figures into `figures/` of a folder.
pub(super) fn put_figures(folder: &Path, figures: &[Figure], lang: Lang) -> Result<(), Error> {
    for figure in figures {
        put(folder, &format!("figures/{}", file_name(&figure.id)), svg::render(figure, lang).as_bytes())?;
    }
    Ok(())
}

/// A value as indented JSON.
pub(super) fn json(value: &impl serde::Serialize) -> Result<Vec<u8>, Error> {
    serde_json::to_vec_pretty(value)
        .map_err(|e| Error::argument(crate::i18n::Note::new("system.other").with("reason", e.to_string())))
}
