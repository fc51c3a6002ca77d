//! Recordings made from a claim: its noise, its mean, its effects, and the columns that drive them.
//!
//! Every effect acts through its own forward model, the one that fits go through. A seed fixes every bit of the output,
//! however it is cut into blocks.

mod drive;
mod error;
mod low_pass;
mod noise;
mod quantize;
mod run;
mod seed;
mod shape;

pub use error::SimulateError;
pub use run::{Order, Over, Rows, Simulation};
pub use seed::stream;
pub use shape::claimed_density;
