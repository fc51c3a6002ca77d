//! Sheet files: which rows a data sheet has, in which order, under which names and in which units.

mod read;
pub mod tables;

pub use read::{load, parse};

use crate::i18n::LocalText;
use crate::measurand::Measurand;
use crate::units::Unit;

/// What a user wants of a data sheet.
#[derive(Debug, Clone)]
pub struct SheetFile {
    /// Title of the sheet.
    pub title: Option<LocalText>,
    /// Its rows, in their order.
    pub rows: Vec<SheetRow>,
}

/// One row.
#[derive(Debug, Clone)]
pub struct SheetRow {
    /// The quantity.
    pub measurand: &'static Measurand,
    /// Channel; all channels where none is named.
    pub channel: Option<String>,
    /// Phase of a test of several; all phases where none is named.
    pub phase: Option<String>,
    /// Name that the sheet prints.
    pub name: Option<LocalText>,
    /// Unit that the sheet prints.
    pub unit: Option<Unit>,
    /// Footnote of the row.
    pub footnote: Option<LocalText>,
}
