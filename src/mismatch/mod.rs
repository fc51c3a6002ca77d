//! The mismatch of a claimed simulation and a recording: located, named, modelled, and the fit shown to improve.

pub mod figures;
pub mod finding;
mod identify;
pub mod options;
pub mod outcome;

pub use identify::identify;
pub use options::{Options, Progress};
pub use outcome::Outcome;

use crate::claim::Claim;
use crate::series::Series;
use crate::text::Note;

/// Explains a recording against a claim.
///
/// # Errors
/// What keeps the two from being compared.
pub fn explain(
    _recording: &Series,
    _claim: &Claim,
    _options: &Options,
    _progress: &mut dyn FnMut(Progress),
) -> Result<Outcome, Note> {
    Err("explain.error.engine".into())
}
