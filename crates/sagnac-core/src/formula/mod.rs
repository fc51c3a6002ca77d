//! Formulas of a user over measured quantities: `sqrt(bias_repeatability^2 + (magnetic_sensitivity * 0.05 [mT])^2)`.
//!
//! A formula is parsed with the places of its parts, checked for its unit before there is any data, and evaluated with the
//! uncertainty of its inputs. Everything is computed in base units.

mod dimension;
mod evaluate;
mod interval;
mod lexer;
mod parse;

pub use evaluate::{Correlations, Input, Outcome};

use crate::message::Note;
use crate::units::Unit;
use std::ops::Range;

/// A formula.
#[derive(Debug, Clone, PartialEq)]
pub struct Formula {
    /// The text as it was written.
    pub text: String,
    /// The quantities that it names, each once, with the place of the first mention.
    pub references: Vec<(Reference, Range<usize>)>,
    root: Expression,
}

/// A quantity that a formula names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reference {
    /// Id of a measurand, or of another formula.
    pub id: String,
    /// Which channels.
    pub of: Channels,
}

/// The channels of a reference.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Channels {
    /// The channel that the formula is evaluated for.
    Own,
    /// A named one.
    Named(String),
    /// Every gyro channel: the largest magnitude of them is taken.
    Worst,
}

/// What is wrong with a formula.
#[derive(Debug, Clone, PartialEq)]
pub struct FormulaError {
    /// The part that is wrong, in bytes.
    pub span: Range<usize>,
    /// What is wrong.
    pub message: Note,
}

/// A part of a formula and its place.
#[derive(Debug, Clone, PartialEq)]
struct Expression {
    node: Node,
    span: Range<usize>,
}

#[derive(Debug, Clone, PartialEq)]
enum Node {
    Number { value: f64, unit: Unit },
    Quantity(usize),
    Negative(Box<Expression>),
    Binary { sign: Sign, left: Box<Expression>, right: Box<Expression> },
    Power { base: Box<Expression>, exponent: f64 },
    Call { function: Function, arguments: Vec<Expression> },
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sign {
    Plus,
    Minus,
    Times,
    Over,
}

/// The functions; `worst` of one quantity stands in its [`Reference`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Function {
    Sqrt,
    Abs,
    Min,
    Max,
    Rss,
    Mean,
}

impl Function {
    const ALL: [(&'static str, Function); 6] = [
        ("sqrt", Function::Sqrt),
        ("abs", Function::Abs),
        ("min", Function::Min),
        ("max", Function::Max),
        ("rss", Function::Rss),
        ("mean", Function::Mean),
    ];

    fn of(name: &str) -> Option<Function> {
        Function::ALL.iter().find(|(n, _)| *n == name).map(|(_, f)| *f)
    }

    fn takes_one(self) -> bool {
        matches!(self, Function::Sqrt | Function::Abs)
    }
}

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
