//! Why a recording departs from a simulation.
//!
//! `sagnac-core` re-exports these modules. Those of [`sagnac_base`] and [`sagnac_noise`] stand here under the same paths.
//!
//! Modules, from the ground up; each uses those above it only:
//!
//! | module | what it has |
//! |---|---|
//! | [`effect`] | the catalogue of physical effects that a simulation can omit |
//! | [`claim`], [`series`] | a simulation as its author states it; a recording held in memory |
//! | [`schedule`] | what chamber and table do in a test |
//! | [`mismatch`], [`simulate`] | why a recording departs from a claim; recordings made from a claim |
//! | [`plan`] | the next test: which schedule tells the explanations that are left apart |
//!
//! Nothing here panics on any input: what cannot be computed is `None`, an error, or an estimate without a value.

pub use sagnac_base::{estimate, figure, local_text, message, numeric, recording, units};
pub use sagnac_noise::noise;

pub mod claim;
pub mod effect;
pub mod mismatch;
pub mod plan;
pub mod schedule;
pub mod series;
pub mod simulate;
