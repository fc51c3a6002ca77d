//! The mismatch of a claimed simulation and a recording: located, named, modelled, and the fit shown to improve.

pub mod figures;
pub mod finding;
pub mod options;
pub mod outcome;

pub use options::{Options, Progress};
pub use outcome::Outcome;
