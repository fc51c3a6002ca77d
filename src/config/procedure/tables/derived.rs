//! The tables of quantities by a formula, and of their limits.

use crate::config::procedure::section::Section;
use crate::config::table::Table;
use crate::estimate::Rule;
use crate::units::Unit;

/// A quantity by a formula over quantities of this procedure. It has a row of its own, and limits.
#[derive(Table)]
#[table("derived")]
pub(in crate::config::procedure) struct DerivedKeys {
    /// Id of the quantity in results and limits; no id of a measurand.
    #[key(id, required, example = "bias_budget")]
    pub id: Option<String>,
    /// Unit of the value.
    #[key(required, example = "deg/h")]
    pub unit: Option<Unit>,
    /// Formula: ids of measurands and of earlier formulas, `@` and a channel, numbers with units, `+ - * / ^`, `sqrt`, `abs`, `min`,
    /// `max`, `rss`, `mean`, and `worst(id)` for the largest magnitude of all axes. A formula that names an id without a channel is
    /// evaluated for every gyro channel.
    #[key(required, example = "rss(bias_repeatability, magnetic_sensitivity * 0.05 mT)")]
    pub value: Option<String>,
    #[key(section)]
    pub section: Section,
}

/// A limit of a quantity by a formula.
#[derive(Table)]
#[table("derived_limit")]
pub(crate) struct DerivedLimitKeys {
    /// Id of the quantity.
    #[key(id, required, example = "bias_budget")]
    pub derived: Option<String>,
    /// Lowest value allowed, with its unit.
    #[key(example = "0.5 deg/h")]
    pub min: Option<String>,
    /// Highest value allowed, with its unit.
    #[key(example = "0.5 deg/h")]
    pub max: Option<String>,
    /// Decision rule.
    #[key(default = "guard_band", example = "guard_band")]
    pub rule: Rule,
    /// Risk of a wrong acceptance, and of a wrong rejection, that the guard band is set for.
    #[key(above = 0, max = 0.5, default = 0.05, example = 0.05)]
    pub risk: f64,
    #[key(section)]
    pub section: Section,
}
