//! The mismatch of a claimed simulation and a recording: located, named, modelled, and the fit shown to improve.

pub mod candidates;
pub mod columns;
pub mod departures;
pub mod finding;
pub mod hypothesis;
pub mod impute;
pub mod lattice;
pub mod local;
pub mod noise_fit;
pub mod problem;
pub mod regular;
pub mod scene;
pub mod select;
