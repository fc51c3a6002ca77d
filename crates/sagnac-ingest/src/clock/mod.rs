//! The clock of a recording: interval, gaps, duplicate and backward stamps, jitter, roll-overs. Times in s.
//!
//! [`Clock::probe`] finds the clock from the first stamps, [`Tracker`] follows them through the recording, [`Fit`] measures
//! the interval by regression, [`Unwrapper`] undoes the roll-over of stamps and counters of limited width.

mod buffered;
mod bunched;
mod counter;
mod fit;
mod nominal;
mod probe;
mod refine;
mod rollover;
mod steps;
mod tracker;

pub use buffered::{AnchorRow, Batches, Loss, Uniform};
pub use counter::{CounterStep, CounterTracker};
pub use fit::{Fit, Measured};
pub use nominal::{Cadence, Clock, ClockError};
pub use rollover::{Rollover, Unwrapper, moduli};
pub use tracker::{SET_BACK_AFTER, Step, Tracker};

#[cfg(test)]
mod tests;
