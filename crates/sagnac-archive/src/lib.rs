//! Sagnac over an archive: every recording of a share or an object store, on one machine or on several.
//!
//! DataFusion plans and runs the queries, Ballista distributes them. This crate adds what only Sagnac can: scalar functions
//! that evaluate one recording, aggregate functions over results, and a run that can be stopped and resumed.
//!
//! | module | what it has |
//! |---|---|
//! | [`evaluate`] | one recording through Sagnac; whatever happens is an [`outcome::Outcome`] |
//! | [`outcome`] | what an evaluation gives, as a value and as an Arrow struct |
//! | [`functions`] | `sagnac_analyze`, `sagnac_run`, `sagnac_explain`, `sagnac_key`, `sagnac_measurand` |
//! | [`aggregates`] | `sagnac_tolerance_upper`, `sagnac_tolerance_lower`, `sagnac_drift` |
//! | [`stores`] | files and s3-compatible object stores by their address |
//! | [`session`] | sessions of DataFusion that know all of these |
//! | [`job_list`] | the table of recordings, and how a folder becomes one |
//! | [`job`] | `job.toml` |
//! | [`query`] | what of a query is run for each recording |
//! | [`results`] | the table of results, and how its files are written |
//! | [`run`] | what is left to do, in portions, with retries |
//! | [`cluster`] | scheduler, worker and client of Ballista |
#![forbid(unsafe_code)]

pub mod aggregates;
pub mod cluster;
pub mod evaluate;
pub mod functions;
pub mod job;
pub mod job_list;
pub mod outcome;
pub mod query;
pub mod results;
pub mod run;
pub mod session;
pub mod stores;

/// Version of the engine that results are of.
pub const ENGINE_VERSION: &str = env!("CARGO_PKG_VERSION");
