//! Rules of a watched folder: which files are recordings of which test, when one is complete, who is told of its verdict.

mod read;
mod rules;
pub mod tables;

pub use read::{load, parse};
pub use rules::{Completeness, DEFAULT_POLL, SERIAL_PLACE, WatchRule, WatchRules};
