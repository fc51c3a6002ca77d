//! Why a unit could not be read or converted.

use crate::message::{Arg, Note};
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
        /// What was wrong with it: a key of the locale tables.
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
        /// What is needed, in words.
        to_dimension: Box<Arg>,
    },
}

impl UnitError {
    /// What is wrong, as a note.
    pub fn note(&self) -> Note {
        match self {
            UnitError::Unknown { symbol, suggestion: None } => {
                Note::new("unit_error.unknown").with("symbol", symbol.as_str())
            }
            UnitError::Unknown { symbol, suggestion: Some(near) } => {
                Note::new("unit_error.misspelt").with("symbol", symbol.as_str()).with("near", near.as_str())
            }
            UnitError::Grammar { text, reason } => {
                Note::new("unit_error.grammar").with("text", text.as_str()).with("reason", Note::new(*reason))
            }
            UnitError::Dimension { from, to, from_dimension, to_dimension } => {
                Note::new("unit_error.dimension")
                    .with("from", from.as_str())
                    .with("to", to.as_str())
                    .with("from_dimension", (**from_dimension).clone())
                    .with("to_dimension", (**to_dimension).clone())
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
