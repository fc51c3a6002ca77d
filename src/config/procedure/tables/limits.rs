//! The tables of a limits file; limits and references may stand in a procedure too.

use crate::config::spec::{Kind, Range, TableSpec, Word, optional, required, with_default};

/// The limits file as a whole.
pub static LIMITS_FILE: TableSpec = TableSpec {
    name: "",
    doc: "Limits and reference values of one family of devices. One procedure serves many devices; each \
          family has its own limits file.",
    keys: &[
        required("format", Kind::Format("limits/1"), "\"limits/1\"", "Version of the format."),
        required("limits", Kind::Table(&LIMITS), "", "Identity of the limits."),
        optional(
            "expected",
            Kind::QuantityMap,
            "",
            "Typical noise of the family, by measurand id: what the power of the limits is computed from.",
        ),
        optional(
            "reference",
            Kind::Tables(&REFERENCE),
            "",
            "Published or data-sheet values shown for comparison.",
        ),
        optional("limit", Kind::Tables(&LIMIT), "", "Limits, one table each."),
    ],
};

static LIMITS: TableSpec = TableSpec {
    name: "limits",
    doc: "Identity of the limits, shown in the header of every report.",
    keys: &[
        required("id", Kind::Id, "\"oius-501\"", "Id of the limits."),
        required("title", Kind::LocalText, "\"OIUS-501\"", "Title of the file."),
        required(
            "revision",
            Kind::Text,
            "\"A\"",
            "Revision. Change it whenever anything else in the file changes.",
        ),
        optional("family", Kind::LocalText, "\"OIUS-501\"", "Family of devices the limits are for."),
        optional("source", Kind::LocalText, "\"data sheet DS-501, rev. 3\"", "Where the values come from."),
        optional(
            "factor",
            Kind::Number(Range::POSITIVE),
            "1.5",
            "Derives an upper limit, factor times the value, from every reference value whose measurand and \
             channel have no limit of their own. With factor 1, a unit exactly at its typical value fails a \
             guard-banded limit at least half the time.",
        ),
    ],
};

/// A published value.
pub static REFERENCE: TableSpec = TableSpec {
    name: "reference",
    doc: "A published or data-sheet value, shown for comparison; it is not a limit. If a measurand has \
          several, the first is used.",
    keys: &[
        required("measurand", Kind::Measurand, "\"angle_random_walk\"", "Id of the measurand."),
        optional("channel", Kind::Id, "\"x\"", "Channel. Default: every channel."),
        required("value", Kind::QuantityBy("measurand"), "\"0.0023 deg/sqrt(h)\"", "Value with unit."),
        required("source", Kind::LocalText, "\"data sheet DS-501, rev. 3\"", "Where it was published."),
        optional(
            "note",
            Kind::LocalText,
            "\"read at the minimum of the curve\"",
            "Conventions that apply to the value.",
        ),
    ],
};

/// A limit.
pub static LIMIT: TableSpec = TableSpec {
    name: "limit",
    doc: "A limit with its decision rule: `min` or `max` or both, or `max_abs`, or `factor`.",
    keys: &[
        required("measurand", Kind::Measurand, "\"angle_random_walk\"", "Id of the measurand."),
        optional("channel", Kind::Id, "\"x\"", "Channel. Default: every channel."),
        optional("min", Kind::QuantityBy("measurand"), "\"0.5 deg/h\"", "Lowest value allowed."),
        optional("max", Kind::QuantityBy("measurand"), "\"0.0030 deg/sqrt(h)\"", "Highest value allowed."),
        optional(
            "max_abs",
            Kind::QuantityBy("measurand"),
            "\"0.5 deg/h\"",
            "Highest magnitude allowed, for a measurand that can be negative.",
        ),
        optional(
            "factor",
            Kind::Number(Range::POSITIVE),
            "1.5",
            "Upper limit as a multiple of the reference value of the same measurand in this file.",
        ),
        with_default("rule", Kind::Choice(RULES), "\"guard_band\"", "\"guard_band\"", "Decision rule."),
        with_default(
            "risk",
            Kind::Number(Range::above_up_to(0.0, 0.5)),
            "0.05",
            "0.05",
            "Risk of a wrong acceptance, and of a wrong rejection, that the guard band is set for.",
        ),
    ],
};

/// Decision rules.
pub const RULES: &[Word] = &[
    ("guard_band", "the one-sided bound of the value at the stated risk is compared (JCGM 106, ISO 14253-1)"),
    ("simple", "the value itself is compared; up to 50 % risk at the limit (ILAC-G8)"),
];
