//! Sagnac: an automated acceptance-test harness for precision gyroscopes.
//!
//! A declarative procedure (TOML) and a unit's recording go in; a report comes out in which every quantity carries
//! its uncertainty and is set against its limit: pass, fail, or indeterminate.
//!
//! Data flows one way, and modules depend downwards only:
//!
//! ```text
//! numeric, units, text <- estimate, figure, output <- record, recording
//!     <- keyed <- ingest, noise <- measurand <- procedure <- condition <- run <- compare <- report <- cli
//! ```
#![forbid(unsafe_code)]

pub mod claim;
pub mod cli;
pub mod compare;
pub mod condition;
pub mod effect;
pub mod estimate;
pub mod figure;
pub mod ids;
pub mod influence;
pub mod ingest;
pub mod keyed;
pub mod measurand;
pub mod mismatch;
pub mod noise;
pub mod numeric;
pub mod output;
pub mod procedure;
pub mod rate_table;
pub mod record;
pub mod recording;
pub mod report;
pub mod run;
pub mod selftest;
pub mod series;
pub mod simulate;
pub mod temperature;
pub mod text;
pub mod units;
