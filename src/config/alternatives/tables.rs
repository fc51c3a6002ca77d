//! The tables of alternatives.

use crate::config::model::EffectKeys;
use crate::config::spec::TableSpec;
use crate::config::table::Table;

/// Alternatives as a whole.
pub static ALTERNATIVES_FILE: TableSpec = *AlternativesTables::SPEC;

/// What would explain a recording as well: for each cause that has equivalents the chosen explanation and the
/// others.
#[derive(Table)]
#[table("", format = "alternatives/1")]
pub(super) struct AlternativesTables {
    /// The explanations, one table each.
    #[key(name = "alternative")]
    pub alternatives: Vec<AlternativeKeys>,
}

/// One explanation of a cause.
#[derive(Table)]
#[table("alternative")]
pub(super) struct AlternativeKeys {
    /// The cause by its place among the effects of `explain.json`, counted from 1.
    #[key(min = 1, max = 1000, example = 1)]
    pub cause: usize,
    /// True for the effect that was chosen.
    #[key(default = false, example = true)]
    pub chosen: bool,
    /// Its effects as in a model: first the one that explains the cause, then those of the other causes.
    #[key(name = "effect", required)]
    pub effects: Vec<EffectKeys>,
}
