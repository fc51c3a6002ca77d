//! Units and what they are tested on, from physics alone: nothing here uses the program under test.
//!
//! The shipped samples come from these generators, so what they draw, and in which order, stays as it is.

pub mod bench_check;
pub mod chamber;
pub mod chance;
mod drift;
pub mod frequency;
pub mod gravity;
pub mod influence;
pub mod noise_source;
pub mod rate_table;
pub mod small_rates;
pub mod soaks;
pub mod start_up;
pub mod two_axes;
pub mod vibration;

/// Rotation of the Earth, deg/h (7.292115e-5 rad/s).
pub const EARTH: f64 = 15.041_067;
