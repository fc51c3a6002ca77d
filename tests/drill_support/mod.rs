//! The drill: samples, corruptions, what must catch each, and the table of what did.

pub mod corruptions;
pub mod expected;
pub mod recording;
pub mod run;

/// The samples, in the order of every table.
pub const SAMPLES: [&str; 4] = ["pass", "fail", "indeterminate", "faults"];
