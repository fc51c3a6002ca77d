//! Aggregate functions over results.
//!
//! | function | gives |
//! |---|---|
//! | `sagnac_tolerance_upper(value, proportion, confidence)` | the value below which the proportion of all units lies, with the confidence |
//! | `sagnac_tolerance_lower(value, proportion, confidence)` | the value above which it lies |
//! | `sagnac_drift(time, value, standard_uncertainty)` | change and slope of one unit over time |
//!
//! All keep the values of a group and sort them at the end: the result does not depend on how the rows were divided among
//! threads or machines, to the last bit.

mod drift;
mod numbers;
mod tolerance;

pub use drift::Drift;
pub use tolerance::{Side, Tolerance};

use datafusion::logical_expr::AggregateUDF;

/// Every aggregate function.
pub fn all() -> Vec<AggregateUDF> {
    vec![
        AggregateUDF::from(Tolerance::new(Side::Upper)),
        AggregateUDF::from(Tolerance::new(Side::Lower)),
        AggregateUDF::from(Drift::new()),
    ]
}
