//! Estimators, conditions and files against the same computed in extended precision.

mod conditions;
mod exact;
mod files;
mod precision;
