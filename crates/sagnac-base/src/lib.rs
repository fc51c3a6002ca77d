//! Units, estimates and verdicts, messages, numerical methods, blocks of samples: what every analysis of a gyroscope stands on.
//!
//! The crate knows no test and no noise. `sagnac-core` re-exports its modules, so that a user of the analysis needs no second name.
//!
//! Modules, from the ground up; each uses those above it only:
//!
//! | module | what it has |
//! |---|---|
//! | [`local_text`], [`message`], [`render`], [`visible`], [`spelling`] | texts of users by language; messages as a key with arguments; a table that the caller brings turns them into text |
//! | [`numeric`], [`units`] | numerical methods; units and their conversion |
//! | [`estimate`] | an estimate with its confidence distribution, limits, decision rules, verdicts |
//! | [`figure`] | plots as data |
//! | [`recording`] | channels, their roles and units, and the blocks of samples that they deliver |
//!
//! Nothing here panics on any input: what cannot be computed is `None`, an error, or an estimate without a value.

pub mod estimate;
pub mod figure;
pub mod local_text;
pub mod message;
pub mod numeric;
mod real;
pub mod recording;
pub mod render;
pub mod spelling;
pub mod units;
pub mod visible;
