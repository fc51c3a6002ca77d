//! Pairs and triples of explanations that one recording cannot tell apart: `studies/cases/planned.toml`.

use super::physics::Truth;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// Explanations of one cause with the model that they were found against.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ambiguous {
    /// What is confused.
    pub name: String,
    /// The text of the model; in the file the name of one.
    pub model: String,
    /// The explanations as `alternatives.toml` has them.
    pub alternatives: String,
    /// What each of them is, in the same order.
    pub truths: Vec<Truth>,
    /// Longest test, h.
    pub budget_h: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    models: BTreeMap<String, String>,
    case: Vec<Ambiguous>,
}

/// Every case.
pub static AMBIGUOUS: LazyLock<Vec<Ambiguous>> = LazyLock::new(|| {
    let table: Table = toml::from_str(include_str!("../../cases/planned.toml"))
        .unwrap_or_else(|wrong| panic!("studies/cases/planned.toml: {wrong}"));
    let with_model = |case: Ambiguous| Ambiguous { model: table.models[&case.model].clone(), ..case };
    table.case.into_iter().map(with_model).collect()
});
