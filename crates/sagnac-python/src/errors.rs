//! Errors of the library as exceptions of the package.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use sagnac::Error;
use sagnac::config::diagnostics::{Problem, Severity};

/// The place that an error is about.
#[derive(Default)]
struct Place {
    file: Option<String>,
    line: Option<u64>,
    column: Option<u64>,
}

impl Place {
    /// Of the first error in a file, or of the recording.
    fn of(error: &Error) -> Place {
        let wrong = |p: &&Problem| p.severity == Severity::Error;
        if let Some(problem) = error.problems().iter().find(wrong) {
            let known = |n: usize| (n > 0).then_some(n as u64);
            return Place {
                file: Some(problem.file.clone()),
                line: known(problem.line),
                column: known(problem.column),
            };
        }
        error.ingest().map_or_else(Place::default, |e| Place {
            file: Some(e.path().display().to_string()),
            line: e.line(),
            column: e.column(),
        })
    }
}

/// The exception for an error.
pub fn raised(py: Python<'_>, error: &Error) -> PyErr {
    let class = if error.is_configuration() {
        "ConfigurationError"
    } else if error.is_not_evaluable() {
        "NotEvaluableError"
    } else if error.is_argument() {
        "ArgumentError"
    } else if error.is_output() {
        "OutputError"
    } else {
        "RecordingError"
    };
    exception(py, class, &error.to_string(), Place::of(error))
}

/// The exception for an argument that cannot be used.
pub fn argument(py: Python<'_>, message: &str) -> PyErr {
    exception(py, "ArgumentError", message, Place::default())
}

fn exception(py: Python<'_>, class: &str, message: &str, place: Place) -> PyErr {
    let made = || -> PyResult<PyErr> {
        let class = py.import("sagnac._errors")?.getattr(class)?;
        let named = PyDict::new(py);
        named.set_item("file", place.file)?;
        named.set_item("line", place.line)?;
        named.set_item("column", place.column)?;
        Ok(PyErr::from_value(class.call((message,), Some(&named))?))
    };
    made().unwrap_or_else(|e| e)
}
