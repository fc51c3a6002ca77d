//! Results as text for a terminal: the verdict, a table of quantities, the reasons, and where the report is.
//!
//! Texts from files are made visible before they are styled, so that only this module writes control sequences.

mod results;
mod run;
mod screen;
pub(super) mod table;
mod wrap;

pub use results::{results, verdict};
pub use screen::Terminal;
pub(super) use screen::verdict_style;
pub use wrap::wrapped;
