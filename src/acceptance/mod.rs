//! A procedure applied to a recording: conditions, the run, and what is done with its record.

pub mod compare;
pub mod condition;
pub mod inspect;
pub mod run;
