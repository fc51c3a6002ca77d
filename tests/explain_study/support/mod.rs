//! The study of the mismatch engine: a generator of concealed cases with physics of its own, scorer, oracle, tables.
//!
//! Nothing here imports the library: a fit to one's own model proves nothing.

pub mod angular;
pub mod case;
pub mod claim;
pub mod classes;
pub mod draw;
pub mod drivers;
pub mod effect;
pub mod faults;
pub mod files;
pub mod modes;
pub mod noise;
pub mod oracle;
pub mod plan;
pub mod profile;
pub mod rates;
pub mod run;
pub mod score;
pub mod setting;
pub mod slow;
pub mod stochastic;
pub mod strength;
pub mod table;
pub mod thermal;
pub mod unknowns;
pub mod unknowns_more;
