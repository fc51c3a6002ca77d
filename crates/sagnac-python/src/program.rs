//! The program itself, run by the interpreter.

use pyo3::prelude::*;
use std::ffi::OsString;
use std::path::PathBuf;

/// Runs the program; gives its exit code. `executable` is the file that starts it, for tests in processes of their own.
#[pyfunction]
pub fn main(py: Python<'_>, arguments: Vec<OsString>, executable: PathBuf) -> u8 {
    sagnac::executable::state(executable);
    sagnac::cli::begin();
    py.detach(|| sagnac::cli::run(&arguments))
}
