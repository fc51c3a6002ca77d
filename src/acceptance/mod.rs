//! A procedure applied to a recording: conditions, the run, the record that comes of it, and what is done with records.

pub mod compare;
pub mod condition;
pub mod inspect;
pub mod record;
pub mod run;
