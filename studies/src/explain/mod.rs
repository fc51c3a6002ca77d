//! Explanations of concealed effects: a generator of cases with physics of its own, scorer, oracle, studies.
//!
//! Only `by_library`, which explains the cases, imports the library: a fit to one's own model proves nothing.

mod angular;
mod by_library;
pub mod case;
pub mod claim;
pub mod classes;
pub mod draw;
mod drivers;
pub mod effect;
mod faults;
pub mod files;
pub mod kinds;
pub mod modes;
pub mod noise;
pub mod oracle;
pub mod plan;
pub mod profile;
mod rates;
pub mod rows;
pub mod run;
pub mod scenario;
pub mod score;
pub mod setting;
mod slow;
mod stochastic;
pub mod strength;
pub mod studies;
pub mod table;
pub mod thermal;
pub mod unknowns;
mod unknowns_more;
