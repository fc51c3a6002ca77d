//! TOML files whose keys are described once, as data: reading with every problem placed, and the parts of schema and
//! guide that follow from the description. Knows no particular file.

pub mod diagnostics;
pub(crate) mod file;
pub(crate) mod inside;
pub mod quantity;
pub(crate) mod reader;
pub(crate) mod section;
pub mod spec;
mod syntax;
pub(crate) mod values;
