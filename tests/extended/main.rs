//! Estimators, conditions and files against the same computed in extended precision.

mod conditions;
mod files;
mod precision;
mod reference;
#[path = "../support/mod.rs"]
mod support;
