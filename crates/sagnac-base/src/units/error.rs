//! Why a unit could not be read or converted.

use crate::message::{Arg, Note, note};
use std::fmt;

/// Why a unit text could not be read, or could not be converted.
#[derive(Debug, Clone, PartialEq)]
pub enum UnitError {
    /// The text holds a symbol that is no unit.
    Unknown {
        /// The symbol that was not understood.
        symbol: String,
        /// A known symbol that is spelt nearly the same.
        suggestion: Option<String>,
    },
    /// The text does not follow the grammar of units.
    Grammar {
        /// The whole text.
        text: String,
        /// The mistake: a key of the locale tables.
        reason: &'static str,
    },
    /// Two units measure different things.
    Dimension {
        /// The unit given.
        from: String,
        /// A unit of the dimension needed.
        to: String,
        /// What the given unit measures, in words.
        from_dimension: Box<Arg>,
        /// The expected unit, in words.
        to_dimension: Box<Arg>,
    },
}

impl UnitError {
    /// The error as a note.
    pub fn note(&self) -> Note {
        match self {
            UnitError::Unknown { symbol, suggestion: None } => {
                note!("unit_error.unknown", symbol = symbol.as_str())
            }
            UnitError::Unknown { symbol, suggestion: Some(near) } => {
                note!("unit_error.misspelt", symbol = symbol.as_str(), near = near.as_str())
            }
            UnitError::Grammar { text, reason } => {
                note!("unit_error.grammar", text = text.as_str(), reason = Note::new(*reason))
            }
            UnitError::Dimension { from, to, from_dimension, to_dimension } => {
                note!(
                    "unit_error.dimension",
                    from = from.as_str(),
                    to = to.as_str(),
                    from_dimension = (**from_dimension).clone(),
                    to_dimension = (**to_dimension).clone()
                )
            }
        }
    }
}

impl fmt::Display for UnitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.note().plain())
    }
}

impl std::error::Error for UnitError {}
