//! The tables of a procedure of several phases.

use super::{CLAUSE, PROCEDURE, UNIT_UNDER_TEST};
use crate::config::spec::{Kind, TableSpec, optional, required};

/// A procedure of several phases as a whole.
pub static PHASES_FILE: TableSpec = TableSpec {
    name: "",
    doc: "A procedure of several phases, each with its own procedure and its own recordings, named by a \
          manifest. One report covers them all.",
    keys: &[
        required("format", Kind::Format("procedure/1"), "\"procedure/1\"", "Version of the format."),
        required("procedure", Kind::Table(&PROCEDURE), "", "Identity of the whole."),
        optional("unit_under_test", Kind::Table(&UNIT_UNDER_TEST), "", "The unit that all phases are for."),
        required(
            "phase",
            Kind::Tables(&PHASE),
            "",
            "The phases, one table each, in the order of the report.",
        ),
        optional("clause", Kind::Tables(&CLAUSE), "", "Clauses of the standard and where each is covered."),
    ],
};

static PHASE: TableSpec = TableSpec {
    name: "phase",
    doc: "One phase.",
    keys: &[
        required(
            "id",
            Kind::Id,
            "\"repeatability\"",
            "Id. Files of the manifest with this phase belong to it; so do those whose phase begins with it and a point, \
             `positions.up`, and the procedure of the phase then sees the rest, `up`.",
        ),
        optional(
            "title",
            Kind::LocalText,
            "\"Repeatability of the bias\"",
            "Title. Default: that of its procedure.",
        ),
        required(
            "procedure",
            Kind::Text,
            "\"bias-repeatability.toml\"",
            "Its procedure, relative to this file.",
        ),
        optional(
            "limits",
            Kind::Text,
            "\"limits/sample-unit.toml\"",
            "Its limits file, relative to this file.",
        ),
    ],
};
