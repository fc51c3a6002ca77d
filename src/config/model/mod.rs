//! Model files: a claimed simulation read from TOML and written back.

mod read;
pub mod tables;
mod write;

pub use read::{load, load_model, parse};
pub use sagnac_core::claim::{Claim, ModelFile, Profile, SimulationPlan, Stated, Uncertainty};
pub(crate) use tables::EffectKeys;
pub(crate) use write::effect as write_effect;
pub use write::write;

#[cfg(test)]
mod tests;

/// Seed of a simulation where neither its file nor its user states one.
pub const DEFAULT_SEED: u64 = 1;
