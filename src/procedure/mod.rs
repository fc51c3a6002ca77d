//! Procedures and limits as data: what is recorded, under which conditions, what is determined, by which limits it is
//! judged. TOML in, typed values in inside units out; every problem of a file is reported at once with its place.

mod channel;
pub mod check;
pub mod diagnostics;
pub mod guide;
pub mod limits;
mod load;
pub mod model;
mod parse;
pub mod power;
pub mod quantity;
mod reader;
pub mod schema;
mod section;
pub mod spec;
pub mod tables;
mod tables_conditions;
pub mod tables_limits;
mod tables_site;
mod validate;
mod values;

pub use diagnostics::{Problem, Problems, Severity};
pub use limits::{EffectiveLimits, LimitsFile, effective};
pub use load::{load, load_limits, parse_limits, parse_procedure};
pub use model::{Loaded, Procedure};
