//! The page of a run: the record as blocks. Every section of the page is a module, which says what it shows of the record
//! in words and printed numbers.

mod budget;
mod certificate;
mod checks;
mod common;
mod comparison;
mod conditions;
mod deviations;
mod evidence;
mod explained;
mod faults;
mod figures;
mod further;
mod instruments;
mod interim;
mod interval_means;
mod limits;
mod lines;
mod models;
mod page;
mod part;
mod phases;
mod rows;
mod table_steps;

pub(super) use certificate::{certificate, refusal};
pub(super) use conditions::{Condition, conditions, declared};
pub(super) use faults::FaultKinds;
pub use figures::FigureView;
pub(super) use figures::caption;
pub(super) use lines::sentences as line_sentences;
pub(super) use page::page;
pub(super) use part::{Part, Phase};
pub(super) use rows::{
    Row, bound_alone, interval, limit_text, place, reason as row_reason, rounding, summary, value,
    verdict_word,
};
