//! Formulas of a user over measured quantities: `sqrt(bias_repeatability^2 + (magnetic_sensitivity * 0.05 [mT])^2)`.
//!
//! A formula is parsed with the places of its parts, checked for its unit before there is any data, and evaluated with the
//! uncertainty of its inputs. Everything is computed in base units.

mod dimension;
mod evaluate;
mod expression;
mod interval;
mod lexer;
mod parse;

pub use evaluate::{Correlations, Input, Outcome};
pub use expression::{Channels, Formula, FormulaError, Reference};

use crate::units::Unit;

impl Formula {
    /// Reads a formula.
    ///
    /// # Errors
    /// [`FormulaError`] at the first part that does not follow the grammar.
    pub fn parse(text: &str) -> Result<Formula, FormulaError> {
        parse::formula(text)
    }

    /// Checks that every part has a unit, for the units of its quantities, in the order of `references`; gives the unit of the whole.
    ///
    /// # Errors
    /// [`FormulaError`] at the part whose units do not fit.
    pub fn unit(&self, units: &[Unit]) -> Result<Unit, FormulaError> {
        dimension::unit(&self.root, units)
    }

    /// The outcome for inputs in the order of `references`, in base units.
    pub fn evaluate(&self, inputs: &[Vec<Input>], correlations: &Correlations<'_>) -> Outcome {
        evaluate::outcome(&self.root, inputs, correlations)
    }
}
