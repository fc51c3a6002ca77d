//! Schedule files: what chamber and table do in a test, read from TOML and written back.

mod read;
pub mod tables;
mod write;

pub use read::{load, parse};
pub use sagnac_core::schedule::{Leg, Schedule, Start, Step};
pub use write::write;

#[cfg(test)]
mod tests;
