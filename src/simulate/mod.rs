//! Simulated recordings as files.

mod write;

pub use sagnac_core::simulate::*;
#[cfg(test)]
mod tests;

pub use write::{Format, WriteError, Written, write};
