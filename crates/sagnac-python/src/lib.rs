//! The compiled part of the Python package `sagnac`: thin calls of the library. The package itself, with its types and
//! documentation, is written in Python and stands in `python/sagnac`.
//!
//! Records cross the boundary as JSON, in which numbers keep every bit; samples cross it as Arrow arrays, without a copy.

mod calls;
mod columns;
mod errors;
mod program;
mod results;
mod watch;

use pyo3::prelude::*;

/// The module `sagnac._native`.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<results::Results>()?;
    module.add_function(wrap_pyfunction!(program::main, module)?)?;
    calls::add_to(module)
}
