//! What a Rust program uses: recordings, noise, procedures, explanations, without the command line.
//!
//! Everything here is a thin layer over the rooms below; `lib.rs` re-exports it at the root of the crate.

mod analysis;
mod comparison;
mod data_sheet;
mod error;
mod explain;
mod files;
mod noise;
mod procedure;
mod recording;

pub use analysis::Analysis;
pub use comparison::{Compared, compare};
pub use data_sheet::{SheetSource, data_sheet};
pub use error::Error;
pub use explain::{Explanation, Model, explain, explain_watched};
pub use files::write_results;
pub use noise::{AllanCurve, AllanPlan, Noise, allan, draw, identify, identify_in_memory};
pub use procedure::{Procedure, RunResult};
pub use recording::{Rate, Recording};
