//! Analysis of precision gyroscopes, without files, clocks, languages or a program around it.
//!
//! What this crate takes is numbers: samples of a rate, columns beside it, blocks of a recording that somebody else has
//! read. What it gives are estimates with their whole distribution of confidence.
//!
//! From the ground up:
//!
//! - [`message`]: what there is to say, as a key with arguments; words are the business of the program.
//! - [`numeric`], [`units`]: numbers and units, no gyro yet.
//! - [`estimate`], [`figure`], [`ids`]: an estimate with its spread, limits and verdicts; plots as data; the measurands.
//! - [`recording`]: channels and the samples that they deliver.
//! - [`noise`]: statistics and identification of a gyro at rest.
//! - [`rate_table`], [`temperature`], [`influence`]: tests other than the one at rest.
//! - [`measurand`]: one quantity a file.
//! - [`effect`]: the catalogue of physics that a simulation can leave out.
//! - [`claim`], [`series`]: a simulation as its author believes it; a recording as a whole.
//! - [`mismatch`], [`simulate`]: what a recording has that its claim has not; recordings made from a claim.

pub mod claim;
pub mod effect;
pub mod estimate;
pub mod figure;
pub mod ids;
pub mod influence;
pub mod measurand;
pub mod message;
pub mod mismatch;
pub mod noise;
pub mod numeric;
pub mod rate_table;
pub mod recording;
pub mod render;
pub mod series;
pub mod simulate;
pub mod spelling;
pub mod temperature;
pub mod units;
pub mod visible;
