//! The tables of alternatives.

use crate::config::model::tables::EFFECT;
use crate::config::spec::{Kind, Range, TableSpec, optional, required, with_default};

/// Version of the format.
pub const ALTERNATIVES_FORMAT: &str = "alternatives/1";

/// Alternatives as a whole.
pub static ALTERNATIVES_FILE: TableSpec = TableSpec {
    name: "",
    doc: "What would explain a recording as well: for each cause that has equivalents the chosen explanation and the others.",
    keys: &[
        required("format", Kind::Format(ALTERNATIVES_FORMAT), "\"alternatives/1\"", "Version of the format."),
        optional("alternative", Kind::Tables(&ALTERNATIVE), "", "The explanations, one table each."),
    ],
};

static ALTERNATIVE: TableSpec = TableSpec {
    name: "alternative",
    doc: "One explanation of a cause.",
    keys: &[
        required(
            "cause",
            Kind::Number(Range::between(1.0, 1000.0)),
            "1",
            "The cause by its place among the effects of `explain.json`, counted from 1.",
        ),
        with_default("chosen", Kind::Flag, "false", "true", "True for the effect that was chosen."),
        required(
            "effect",
            Kind::Tables(&EFFECT),
            "",
            "Its effects as in a model: first the one that explains the cause, then those of the other causes.",
        ),
    ],
};
