//! Estimators, conditions and files against the same computed in extended precision.

mod conditions;
mod exact;
mod files;
#[path = "../support/long.rs"]
mod long;
mod precision;
#[path = "../support/mod.rs"]
mod support;
