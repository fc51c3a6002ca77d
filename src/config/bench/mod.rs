//! The file of a bench: its devices, how they are reached, what they may be asked to move and how far.

mod read;
pub mod tables;

pub use read::{load, parse};
