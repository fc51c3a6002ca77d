//! The tables of a sheet file.

use crate::config::spec::{Kind, TableSpec, optional, required};

/// Version of the format.
pub const SHEET_FORMAT: &str = "sheet/1";

/// A sheet file as a whole.
pub static SHEET_FILE: TableSpec = TableSpec {
    name: "",
    doc: "Which rows a data sheet has. Without such a file it has every quantity of the results.",
    keys: &[
        required("format", Kind::Format(SHEET_FORMAT), "\"sheet/1\"", "Version of the format."),
        optional("title", Kind::LocalText, "\"OIUS-501\"", "Title of the sheet. Default: the model."),
        required("row", Kind::Tables(&ROW), "", "The rows in their order, one table each."),
    ],
};

static ROW: TableSpec = TableSpec {
    name: "row",
    doc: "One row. A quantity of which there is no row is left out.",
    keys: &[
        required("measurand", Kind::Measurand, "\"angle_random_walk\"", "The quantity."),
        optional("channel", Kind::Text, "\"rate\"", "Channel. Default: every channel."),
        optional("phase", Kind::Text, "\"warm\"", "Phase of a test of several. Default: every phase."),
        optional("name", Kind::LocalText, "\"ARW\"", "Name on the sheet. Default: that of the quantity."),
        optional(
            "unit",
            Kind::UnitText,
            "\"deg/h/sqrt(Hz)\"",
            "Unit on the sheet, of the same dimension. Default: that of the results.",
        ),
        optional("footnote", Kind::LocalText, "\"At 20 °C.\"", "Footnote of the row."),
    ],
};
