//! Sagnac: an acceptance-test harness for precision gyroscopes.
//!
//! A test procedure (TOML) and a recording of a unit go in; a report comes out in which every quantity has its
//! uncertainty and is judged against its limit: pass, fail, or indeterminate.
//!
//! # As a library
//!
//! ```
//! # fn main() -> Result<(), sagnac::Error> {
//! use sagnac::export::{Html, Json};
//! use sagnac::{Lang, Procedure, Recording, UnitUnderTest};
//!
//! let recording = Recording::open("samples/scale-factor-pass.csv")?;
//! let result = Procedure::load("procedures/scale-factor.toml")?
//!     .run(&recording, &UnitUnderTest::with_serial("SN-1"))?;
//! assert_eq!(result.verdict(), sagnac::estimate::Verdict::Pass);
//! # let folder = std::env::temp_dir().join("sagnac-doctest-run");
//! result.write(&folder, &[&Html, &Json], Lang::Ru)?;
//! # Ok(())
//! # }
//! ```
//!
//! - [`Recording`]: a file of any format that is read, or columns in memory; [`Recording::rate`] gives the samples.
//! - [`noise::identify`]: noise terms with their intervals, Allan deviation, spectral lines; [`noise::allan`]: deviations alone.
//! - [`Analysis`]: every quantity of a gyro at rest, without a procedure.
//! - [`Procedure`]: a test procedure with its limits, run on a recording; [`RunResult`] is what comes of it, and is read
//!   back from its folder.
//! - [`export`]: the forms in which results are written, and the trait of an own one.
//! - [`compare()`], [`data_sheet`]: results side by side; what they promise of the population of the units.
//! - [`explain()`]: why a recording departs from a [`Model`] of it.
//! - [`Error`]: the one error of all of these.
//!
//! # Inside
//!
//! | crate or module | what it has |
//! |---|---|
//! | [`sagnac_core`] | the analysis: no file, no clock, no language |
//! | [`sagnac_ingest`] | file formats, the time base, faults of a recording |
//! | [`config`] | procedures, limits, manifests, layouts and models (TOML), with diagnostics |
//! | [`ingest`] | from what a user names to an opened recording |
//! | [`series`], [`simulate`] | recordings as a whole in memory; recordings made from a model |
//! | [`record`] | what a run leaves behind, as `result.json` holds it |
//! | [`acceptance`] | conditions, the run, comparisons, inspection |
//! | [`report`] | views of a record as HTML, Markdown and SVG |
//! | [`prove`] | what the engine says of a recording of which something is concealed |
//! | [`rehearse`] | a test on simulated units before one is recorded |
//! | [`watch`] | a watched folder: what is complete, what was tested |
//! | [`store`] | results that are kept, and their index |
//! | [`i18n`] | sentences in English and Russian |
//! | [`manual`] | the documents that the program carries |
//! | [`executable`] | the file that starts this program |
//! | [`output`] | folders that appear complete or not at all |
//! | [`cli`] | the program |
#![forbid(unsafe_code)]

pub mod acceptance;
pub mod cli;
pub mod config;
mod confined;
pub mod executable;
pub mod i18n;
pub mod ingest;
mod library;
pub mod manual;
pub mod moment;
pub mod output;
pub mod prove;
pub mod record;
pub mod rehearse;
pub mod report;
pub mod selftest;
pub mod series;
pub mod signing;
pub mod simulate;
pub mod store;
pub mod verify;
pub mod watch;

pub use i18n::Lang;
pub use library::{
    Analysis, Compared, Error, Explanation, Model, Noise, Procedure, Rate, Recording, RunResult, SheetSource,
    compare, data_sheet, explain, explain_watched, write_results,
};
pub use record::UnitUnderTest;
pub use report::export;
pub use sagnac_core::{
    claim, criticism, effect, estimate, evidence, figure, formula, influence, lot, measurand, mismatch,
    numeric, plan, rate_table, schedule, start_up, temperature, units,
};

/// Noise of a gyro at rest: [`allan`](fn@allan) and [`identify`](fn@identify) for samples in memory, and the methods that it is made of.
pub mod noise {
    pub use crate::library::{AllanCurve, AllanPlan, Noise, allan, draw, identify, identify_in_memory};
    pub use sagnac_core::noise::*;
}

/// Channels, what they deliver, and what is found about them.
pub mod recording {
    pub use sagnac_core::recording::*;
    pub use sagnac_ingest::{clock, column_inference, faults, value_checks};
}
