//! The tables of a limits file; limits and references may stand in a procedure too.

use super::derived::DerivedLimitKeys;
use crate::config::diagnostics::Span;
use crate::config::procedure::section::Section;
use crate::config::spec::{TableSpec, Word};
use crate::config::table::{Table, words};
use crate::estimate::Rule;
use crate::i18n::LocalText;
use crate::measurand::Measurand;

/// The limits file as a whole.
pub static LIMITS_FILE: TableSpec = *LimitsTables::SPEC;

/// Values by measurand, with the places of their names.
pub(crate) type TypicalValues = Vec<(&'static Measurand, f64, Span)>;

/// Limits and reference values of one family of devices. One procedure serves many devices; each family has its own
/// limits file.
#[derive(Table)]
#[table("", format = "limits/1")]
pub(crate) struct LimitsTables {
    /// Identity of the limits.
    #[key(name = "limits")]
    pub identity: LimitsIdentity,
    /// Typical noise of the family, by measurand id: what the power of the limits is computed from.
    #[key(optional)]
    pub expected: TypicalValues,
    /// Published or data-sheet values shown for comparison.
    #[key(name = "reference")]
    pub references: Vec<ReferenceKeys>,
    /// Limits, one table each.
    #[key(name = "limit")]
    pub limits: Vec<LimitKeys>,
    /// Limits of quantities by a formula (`[[derived]]` of a procedure).
    #[key(name = "derived_limit")]
    pub derived_limits: Vec<DerivedLimitKeys>,
}

/// Identity of the limits, shown in the header of every report.
#[derive(Table)]
#[table("limits")]
pub(crate) struct LimitsIdentity {
    /// Id of the limits.
    #[key(id, example = "oius-501")]
    pub id: String,
    /// Title of the file.
    #[key(example = "OIUS-501")]
    pub title: LocalText,
    /// Revision. Change it whenever anything else in the file changes.
    #[key(example = "A")]
    pub revision: String,
    /// Family of devices the limits are for.
    #[key(example = "OIUS-501")]
    pub family: Option<LocalText>,
    /// Where the values come from.
    #[key(example = "data sheet DS-501, rev. 3")]
    pub source: Option<LocalText>,
    /// Derives an upper limit, factor times the value, from every reference value whose measurand and channel have
    /// no limit of their own. With factor 1, a unit exactly at its typical value fails a guard-banded limit at least
    /// half the time.
    #[key(above = 0, example = 1.5)]
    pub factor: Option<f64>,
}

/// A published or data-sheet value, shown for comparison; it is not a limit. If a measurand has several, the first
/// is used.
#[derive(Table)]
#[table("reference")]
pub(crate) struct ReferenceKeys {
    /// Id of the measurand.
    #[key(required, example = "angle_random_walk")]
    pub measurand: Option<&'static Measurand>,
    /// Channel. Default: every channel.
    #[key(id, example = "x")]
    pub channel: Option<String>,
    /// Value with unit.
    #[key(unit_of = "measurand", required, example = "0.0023 deg/sqrt(h)")]
    pub value: Option<f64>,
    /// Where it was published.
    #[key(example = "data sheet DS-501, rev. 3")]
    pub source: LocalText,
    /// Conventions that apply to the value.
    #[key(example = "read at the minimum of the curve")]
    pub note: Option<LocalText>,
    #[key(section)]
    pub section: Section,
}

/// A limit with its decision rule: `min` or `max` or both, or `max_abs`, or `factor`.
#[derive(Table)]
#[table("limit")]
pub(crate) struct LimitKeys {
    /// Id of the measurand.
    #[key(required, example = "angle_random_walk")]
    pub measurand: Option<&'static Measurand>,
    /// Channel. Default: every channel.
    #[key(id, example = "x")]
    pub channel: Option<String>,
    /// Lowest value allowed.
    #[key(unit_of = "measurand", example = "0.5 deg/h")]
    pub min: Option<f64>,
    /// Highest value allowed.
    #[key(unit_of = "measurand", example = "0.0030 deg/sqrt(h)")]
    pub max: Option<f64>,
    /// Highest magnitude allowed, for a measurand that can be negative.
    #[key(unit_of = "measurand", example = "0.5 deg/h")]
    pub max_abs: Option<f64>,
    /// Upper limit as a multiple of the reference value of the same measurand in this file.
    #[key(above = 0, example = 1.5)]
    pub factor: Option<f64>,
    /// Decision rule.
    #[key(default = "guard_band", example = "guard_band")]
    pub rule: Rule,
    /// Risk of a wrong acceptance, and of a wrong rejection, that the guard band is set for.
    #[key(above = 0, max = 0.5, default = 0.05, example = 0.05)]
    pub risk: f64,
    #[key(section)]
    pub section: Section,
}

/// Decision rules.
pub const DECISION_RULES: &[Word] = &[
    ("guard_band", "the one-sided bound of the value at the stated risk is compared (JCGM 106, ISO 14253-1)"),
    ("simple", "the value itself is compared; up to 50 % risk at the limit (ILAC-G8)"),
];

words!(Rule, DECISION_RULES, |word: &str| match word {
    "guard_band" => Some(Rule::GuardBand),
    "simple" => Some(Rule::Simple),
    _ => None,
});
