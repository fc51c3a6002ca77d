//! Russian against Allan values over any set of units: the founding paper's Table 2, with what explains each ratio; and two results of
//! one unit ([`laboratories`]).
//!
//! A unit comes from a fresh analysis or from a `result.json`; both go through the same reading of the result, so that
//! a figure cannot depend on where it came from. Nothing is measured here.

mod faults;
pub mod figures;
pub mod laboratories;
mod of_result;
mod parts;
pub mod published;
pub mod published_checks;
mod rules;
mod summary;
mod unit;

pub use of_result::{mark_repeated, name_apart, not_compared, units_of};
pub use parts::{part_key, part_name};
pub use unit::{Origin, ReadOutRule, RuleRow, Unit};

use crate::record::Program;
use serde::{Deserialize, Serialize};

/// Version of `comparison.json`.
pub const COMPARISON_FORMAT: &str = "comparison/1";

/// A whole comparison: of units, or of the published tables.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// Always `comparison/1`.
    pub format: String,
    /// The program that wrote this.
    pub program: Program,
    /// When it was made, RFC 3339, UTC.
    pub compared_at: String,
    /// The units, one entry a channel.
    pub units: Vec<Unit>,
    /// The published tables with their checks.
    pub published: Option<published::Checked>,
    /// Whether two results of one unit agree, and why not; absent for any other results.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub laboratories: Option<laboratories::Laboratories>,
}

impl Comparison {
    /// A comparison of units.
    pub fn of_units(units: Vec<Unit>, compared_at: String) -> Comparison {
        Comparison { units, ..Comparison::empty(compared_at) }
    }

    /// The published tables.
    pub fn of_published(checked: published::Checked, compared_at: String) -> Comparison {
        Comparison { published: Some(checked), ..Comparison::empty(compared_at) }
    }

    fn empty(compared_at: String) -> Comparison {
        Comparison {
            format: COMPARISON_FORMAT.to_owned(),
            program: Program::this(),
            compared_at,
            units: vec![],
            published: None,
            laboratories: None,
        }
    }
}
