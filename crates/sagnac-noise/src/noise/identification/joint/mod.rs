//! Joint maximum likelihood of every kind of part: N, B, K, Q, R, Markov processes, quasi-periodic disturbances and the
//! bandwidth of the measurement.
//!
//! Variances enter the expected power linearly, correlation times, frequencies and filter times do not. Fisher scoring
//! over both, variances bounded at zero. The search adds one part at a time while one is worth its parameters; the
//! revision removes those that a later part has made superfluous.

mod columns;
mod ends;
mod fit;
mod identify;
mod interval;
mod model;
mod peaks;
mod plateau;
mod revise;
mod search;
mod slow;

pub(super) use columns::expected_power;
pub(super) use identify::identify_joint;
pub use model::Extras;
pub use plateau::Plateau;
