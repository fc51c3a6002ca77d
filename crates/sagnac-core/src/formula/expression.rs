//! A formula as it is parsed: its parts with their places, and the quantities that it names.

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
    pub(super) root: Expression,
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
pub(super) struct Expression {
    pub(super) node: Node,
    pub(super) span: Range<usize>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Node {
    Number { value: f64, unit: Unit },
    Quantity(usize),
    Negative(Box<Expression>),
    Binary { sign: Sign, left: Box<Expression>, right: Box<Expression> },
    Power { base: Box<Expression>, exponent: f64 },
    Call { function: Function, arguments: Vec<Expression> },
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Sign {
    Plus,
    Minus,
    Times,
    Over,
}

/// The functions; `worst` of one quantity stands in its [`Reference`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Function {
    Sqrt,
    Abs,
    Min,
    Max,
    Rss,
    Mean,
}

impl Function {
    pub(super) const ALL: [(&'static str, Function); 6] = [
        ("sqrt", Function::Sqrt),
        ("abs", Function::Abs),
        ("min", Function::Min),
        ("max", Function::Max),
        ("rss", Function::Rss),
        ("mean", Function::Mean),
    ];

    pub(super) fn of(name: &str) -> Option<Function> {
        Function::ALL.iter().find(|(n, _)| *n == name).map(|(_, f)| *f)
    }

    pub(super) fn takes_one(self) -> bool {
        matches!(self, Function::Sqrt | Function::Abs)
    }
}
