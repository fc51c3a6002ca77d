//! Quantities by a formula and their limits, after reading.

use super::diagnostics::Span;
use crate::estimate::{Limit, Rule};
use crate::formula::Formula;
use crate::units::{Unit, UnitError};

/// A quantity by a formula.
#[derive(Debug, Clone, PartialEq)]
pub struct DerivedSpec {
    /// Id in results and limits.
    pub id: String,
    /// Unit of the value.
    pub unit: Unit,
    /// The formula.
    pub formula: Formula,
    /// Where the formula stands.
    pub span: Span,
    /// Where the id stands.
    pub id_span: Span,
}

/// A value with the unit that it is stated in.
#[derive(Debug, Clone, PartialEq)]
pub struct Stated {
    /// Number.
    pub value: f64,
    /// Its unit.
    pub unit: Unit,
    /// Where it stands.
    pub span: Span,
}

/// A limit of a quantity by a formula.
#[derive(Debug, Clone, PartialEq)]
pub struct DerivedLimit {
    /// Id of the quantity.
    pub derived: String,
    /// Lowest value allowed.
    pub min: Option<Stated>,
    /// Highest value allowed.
    pub max: Option<Stated>,
    /// Decision rule.
    pub rule: Rule,
    /// Risk that the guard band is set for.
    pub risk: f64,
    /// File that it stands in.
    pub source: String,
    /// Where its table stands.
    pub span: Span,
}

impl DerivedLimit {
    /// The limit in a unit.
    ///
    /// # Errors
    /// The bound that measures something else, with the reason.
    pub fn in_unit(&self, unit: &Unit) -> Result<Limit, (&Stated, UnitError)> {
        let (min, max) = (in_unit(self.min.as_ref(), unit)?, in_unit(self.max.as_ref(), unit)?);
        Ok(Limit { min, max, rule: self.rule, risk: self.risk, source: self.source.clone() })
    }
}

/// A bound in a unit.
fn in_unit<'s>(bound: Option<&'s Stated>, unit: &Unit) -> Result<Option<f64>, (&'s Stated, UnitError)> {
    let Some(stated) = bound else { return Ok(None) };
    let factor = stated.unit.factor_to(unit).map_err(|e| (stated, e))?;
    Ok(Some(stated.value * factor))
}
