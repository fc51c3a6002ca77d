//! The tables of a sheet file.

use crate::config::section::Section;
use crate::config::spec::TableSpec;
use crate::config::table::Table;
use crate::i18n::LocalText;
use crate::measurand::Measurand;
use crate::units::Unit;

/// A sheet file as a whole.
pub static SHEET_FILE: TableSpec = *SheetTables::SPEC;

/// Which rows a data sheet has. Without such a file it has every quantity of the results.
#[derive(Table)]
#[table("", format = "sheet/1")]
pub(super) struct SheetTables {
    /// Title of the sheet. Default: the model.
    #[key(example = "OIUS-501")]
    pub title: Option<LocalText>,
    /// The rows in their order, one table each.
    #[key(name = "row", required)]
    pub rows: Vec<RowKeys>,
}

/// One row. A quantity of which there is no row is left out.
#[derive(Table)]
#[table("row")]
pub(super) struct RowKeys {
    /// The quantity.
    #[key(required, example = "angle_random_walk")]
    pub measurand: Option<&'static Measurand>,
    /// Channel. Default: every channel.
    #[key(example = "rate")]
    pub channel: Option<String>,
    /// Phase of a test of several. Default: every phase.
    #[key(example = "warm")]
    pub phase: Option<String>,
    /// Name on the sheet. Default: that of the quantity.
    #[key(example = "ARW")]
    pub name: Option<LocalText>,
    /// Unit on the sheet, of the same dimension. Default: that of the results.
    #[key(example = "deg/h/sqrt(Hz)")]
    pub unit: Option<Unit>,
    /// Footnote of the row.
    #[key(example = "At 20 °C.")]
    pub footnote: Option<LocalText>,
    #[key(section)]
    pub section: Section,
}
