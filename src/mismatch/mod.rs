//! The mismatch of a claimed simulation and a recording: located, named, modelled, and the fit shown to improve.

mod assemble;
pub mod candidates;
pub mod coarse;
pub mod columns;
pub mod departures;
pub mod draw;
pub mod driver;
pub mod engine;
pub mod estimates;
pub mod figures;
pub mod heldout;
pub mod hypothesis;
mod identify;
mod improvement;
pub mod impute;
mod instant;
mod lags;
pub mod lattice;
pub mod local;
pub mod noise_fit;
pub mod options;
pub mod outcome;
pub mod problem;
mod process;
pub mod regular;
pub mod samples;
pub mod scene;
pub mod select;
mod single_cause;
pub mod tiles;

pub use crate::record::explanation as finding;
pub use engine::explain;
pub use identify::identify;
pub use options::{Options, Progress};
pub use outcome::Outcome;
