//! The view: the run record as words and printed numbers, ready for a template.
//!
//! Everything a template shows by default is a string here, so that HTML and Markdown cannot differ and no template
//! computes. The record itself is handed to the templates as well, for those that users write.

mod checks;
mod common;
mod comparison;
mod conditions;
mod deviations;
mod evidence;
mod explained;
mod faults;
mod figures;
mod goodness;
mod interval_means;
mod matrix;
mod page;
mod rows;
mod table_steps;

pub use comparison::{Comparison, Pair, Side};
pub use conditions::Condition;
pub use deviations::{DeviationCell, DeviationRow, Deviations};
pub use evidence::{Clause, Evidence, Excluded, Instrument, Line, Model, ModelRemark, Power, Waiver};
pub use explained::Explained;
pub use faults::{Fault, FaultKind, Faults};
pub use figures::FigureView;
pub use goodness::Goodness;
pub use interval_means::{IntervalMean, IntervalMeans};
pub use matrix::{Matrix, MatrixRow};
pub(super) use page::summary;
pub use page::{FileView, MethodView, PhasePart, PhaseView, View};
pub use rows::Row;
pub(super) use rows::{limit_text, reason as row_reason, rounding};
pub use table_steps::{TableStep, TableSteps};
