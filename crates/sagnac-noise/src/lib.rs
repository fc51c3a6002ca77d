//! Noise of a gyroscope at rest: statistics, identification of noise terms, simulation.
//!
//! `sagnac-core` re-exports [`noise`]. Modules of [`sagnac_base`] stand here under the same paths.

pub use sagnac_base::{estimate, message, numeric, units};

pub mod noise;
