//! How files get into a folder.

use super::Error;
use crate::i18n::Lang;
use crate::report::export::{Exporter, export};
use crate::report::{Document, Renderer, ReportError, Results};
use std::io::Write;
use std::path::Path;

/// Writes results of any kind in some forms into a folder, which is created where it is missing; parts of them stand in
/// folders below. Each file appears complete or not at all, and takes the place of one of the same name.
///
/// # Errors
/// [`Error::is_output`] when a file cannot be written.
pub fn write_results(
    results: &Results,
    folder: impl AsRef<Path>,
    exporters: &[&dyn Exporter],
    lang: Lang,
) -> Result<(), Error> {
    let folder = folder.as_ref();
    write(folder, &results.whole(lang), exporters)?;
    for (below, part) in results.parts(lang) {
        write(&folder.join(below), &part, exporters)?;
    }
    Ok(())
}

/// Writes a document in some forms into a folder, which is created where it is missing. Each file appears complete or not
/// at all, and takes the place of one of the same name.
pub(super) fn write(
    folder: &Path,
    document: &Document<'_>,
    exporters: &[&dyn Exporter],
) -> Result<(), Error> {
    for (name, contents) in export(document, exporters, &Renderer::new())? {
        let path = folder.join(name);
        let failed = |source| ReportError::Io { path: path.display().to_string(), source };
        let parent = path.parent().unwrap_or(folder);
        std::fs::create_dir_all(parent).map_err(failed)?;
        let mut file = tempfile::NamedTempFile::new_in(parent).map_err(failed)?;
        file.write_all(&contents).map_err(failed)?;
        file.persist(&path).map_err(|e| failed(e.error))?;
    }
    Ok(())
}
