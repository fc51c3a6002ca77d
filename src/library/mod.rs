//! What a Rust program uses: recordings, noise, procedures, explanations, without the command line.
//!
//! Everything here is a thin layer over the rooms below; `lib.rs` re-exports it at the root of the crate.

mod error;
mod explain;
mod files;
mod noise;
mod procedure;
mod recording;

pub use error::Error;
pub use explain::{Explanation, Model, explain};
pub use noise::{Noise, identify};
pub use procedure::{Procedure, RunResult};
pub use recording::{Rate, Recording};
