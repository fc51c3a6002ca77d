//! Results of any kind, as the package holds them.

use crate::errors::raised;
use pyo3::prelude::*;
use sagnac::export::{EXPORTERS, Exporter, FURTHER};
use sagnac::figure::Figure;
use sagnac::report::{StoredResults, file_name, svg};
use sagnac::{Error, Lang, write_results};
use std::path::PathBuf;

/// Results that can be read, shown and written.
#[pyclass(frozen, module = "sagnac._native")]
pub struct Results {
    pub(crate) results: sagnac::report::Results,
}

/// A figure: id, file name, SVG.
pub type Drawn = (String, String, String);

/// Draws a figure in a language.
pub fn drawn(figure: &Figure, lang: Lang) -> Drawn {
    (figure.id.clone(), file_name(&figure.id), svg::render(figure, lang))
}

/// A language by its code.
pub fn language(py: Python<'_>, code: &str) -> PyResult<Lang> {
    let known = Lang::ALL.iter().copied().find(|l| l.code() == code);
    known.ok_or_else(|| crate::errors::argument(py, &format!("no language `{code}`: en and ru are known")))
}

#[pymethods]
impl Results {
    /// Reads results from their file or folder.
    #[staticmethod]
    fn open(py: Python<'_>, path: PathBuf) -> PyResult<Results> {
        let stored = py.detach(|| StoredResults::open(&path));
        let stored = stored.map_err(|note| raised(py, &Error::of_note(note)))?;
        Ok(Results { results: stored.results })
    }

    /// Name of the file of the record: it tells what the results are of.
    fn record_file(&self) -> &'static str {
        self.results.kind().record_file()
    }

    /// The record as JSON.
    fn json(&self, py: Python<'_>) -> PyResult<String> {
        let text = py.detach(|| serde_json::to_string(&self.results.whole(Lang::En).record()));
        text.map_err(|e| pyo3::exceptions::PyRuntimeError::new_err(e.to_string()))
    }

    /// Figures in the order of the report: (id, file name, SVG).
    fn figures(&self, py: Python<'_>, lang: &str) -> PyResult<Vec<Drawn>> {
        let lang = language(py, lang)?;
        Ok(py.detach(|| self.results.whole(lang).figures.iter().map(|f| drawn(f, lang)).collect()))
    }

    /// Tables beside the record: (file name, text).
    fn tables(&self) -> Vec<(String, String)> {
        self.results.whole(Lang::En).tables.to_vec()
    }

    /// Writes the results into a folder in some forms, those that the program writes unasked where none is named; files of the same
    /// names are replaced.
    fn write(&self, py: Python<'_>, folder: PathBuf, forms: Vec<String>, lang: &str) -> PyResult<()> {
        let lang = language(py, lang)?;
        let mut exporters: Vec<&dyn Exporter> = vec![];
        for form in &forms {
            let known = EXPORTERS.iter().chain(FURTHER).copied().find(|e| e.id() == form);
            let ids = || EXPORTERS.iter().chain(FURTHER).map(|e| e.id()).collect::<Vec<_>>().join(", ");
            exporters.push(known.ok_or_else(|| {
                crate::errors::argument(py, &format!("no form `{form}`: {} are known", ids()))
            })?);
        }
        if forms.is_empty() {
            exporters = EXPORTERS.to_vec();
        }
        let written = py.detach(|| write_results(&self.results, &folder, &exporters, lang));
        written.map_err(|e| raised(py, &e))
    }
}
