//! A recording as a whole, in the units of the contract of explanations: time, rate, and the further columns.
//!
//! Acceptance never holds a recording; an explanation looks at it many times and does.

mod channels;
mod collect;
mod options;

pub use collect::{load_series, load_series_of};
pub use options::{SeriesError, SeriesOptions};
pub use sagnac_core::series::{Faults, ReadFrom, Series, smooth};

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
