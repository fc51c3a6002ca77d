//! Sagnac: an automated acceptance-test harness for precision gyroscopes.
//!
//! A declarative procedure (TOML) and a unit's recording go in; a report comes out in which every quantity carries
//! its uncertainty and is set against its limit: pass, fail, or indeterminate.
//!
//! The analysis is in [`sagnac_core`], file formats and the clock in [`sagnac_ingest`]; both are re-exported here. This
//! crate is the harness around them: configuration, acceptance, records, reports, the command line.
#![forbid(unsafe_code)]

pub mod acceptance;
pub mod cli;
pub mod config;
pub mod i18n;
pub mod ingest;
pub mod output;
pub mod record;
pub mod report;
pub mod selftest;
pub mod series;
pub mod simulate;

pub use sagnac_core::{
    effect, estimate, figure, ids, influence, measurand, mismatch, noise, numeric, rate_table, temperature,
    units,
};

/// Channels, what they deliver, and what is found about them.
pub mod recording {
    pub use sagnac_core::recording::*;
    pub use sagnac_ingest::{faults, guess, timebase, value_checks};
}
