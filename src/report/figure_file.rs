//! The data of figures beside a result.

use crate::figure::Figure;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// File with the data of the figures, relative to the folder of a result.
pub const FIGURES_FILE: &str = "figures/data.json";

/// Version of [`FIGURES_FILE`].
pub const FIGURES_FORMAT: &str = "figures/1";

/// The data of the figures, from which they are drawn anew.
#[derive(Debug, Serialize, Deserialize)]
pub struct FigureFile<'a> {
    /// Always `figures/1`.
    pub format: Cow<'a, str>,
    /// The figures, in the order of the report.
    pub figures: Cow<'a, [Figure]>,
}

/// The text of the file for some figures.
///
/// # Errors
/// What keeps them from being written as JSON.
pub fn text(figures: &[Figure]) -> Result<String, serde_json::Error> {
    serde_json::to_string(&FigureFile { format: FIGURES_FORMAT.into(), figures: figures.into() })
}
