//! Procedures and limits as data: what is recorded, under which conditions, what is determined, by which limits it is
//! judged. TOML in, typed values in inside units out; every problem of a file is reported at once with its place.

pub mod bench;
pub(crate) mod channel;
pub mod check;
pub mod derived;
pub mod derived_rows;
pub mod differences;
pub mod guide;
mod instrument;
pub mod interim_plan;
pub mod limit_set;
pub mod limits;
mod load;
pub mod missing_columns;
pub mod model;
mod named_channel;
pub mod obtainable;
pub mod pairs;
mod parse;
pub mod phases;
pub mod power;
pub mod recording_options;
pub mod scale_factor_unit;
pub mod schema;
pub mod site;
pub mod slips;
pub mod tables;
pub mod thermometer_pair;
pub mod unit_facts;
mod validate;
mod validate_bench;

pub use crate::config::diagnostics;
pub use crate::config::quantity;
pub use crate::config::spec;
use crate::config::{reader, section};
pub use diagnostics::{Problem, Problems, Severity};
pub use limits::{EffectiveLimits, LimitsFile, effective};
pub use load::{load, load_limits, parse_limits, parse_procedure};
pub use model::{Loaded, Procedure};
