//! A procedure applied to a recording, and what is done with its record.
//!
//! | module | what it does |
//! |---|---|
//! | `pipeline` | the way from a recording to its record: collect, judge, measure, record |
//! | `analysis`, `column_choice` | what stands in for a procedure where there is none |
//! | `kinds` | what each kind of test adds to that way; one file or folder a kind, one list |
//! | `clock_component` | what the clocks of files beside the recording add to uncertainties |
//! | `bench`, `thermometer_pairs` | whether the bench was released for the test; what two of its thermometers differ by |
//! | `interim` | a growing recording by a plan of looks |
//! | `derived` | rows by a formula over others |
//! | `programs`, `handed` | rows that programs of the user give, and the channels that are handed to them |
//! | `condition` | whether the test was done as required; one condition a file |
//! | `figures` | plots as data |
//! | `lot` | a lot from the records of its units |
//! | `phases`, `explained` | several procedures as one test; a recording against the model of its family |
//! | `datasheet`, `history`, `siblings` | what results of many units tell: of their population, over time, of one beside the others |
//! | `compare`, `inspect` | results side by side; what a file holds and which tests it can support |

pub mod analysis;
pub mod bench;
mod build_record;
pub mod changes;
pub mod claimed;
mod clock_component;
pub mod column_choice;
pub mod compare;
mod compensation_files;
pub mod condition;
pub mod datasheet;
mod derived;
pub mod explained;
mod external;
pub mod figures;
mod handed;
pub mod history;
pub mod inspect;
mod interim;
mod interval_means;
mod kinds;
pub mod lot;
mod missing_rows;
pub mod phases;
mod pipeline;
pub mod power;
mod programs;
mod reading;
mod request;
pub mod siblings;
mod sinks;
pub mod tables;
mod test_kind;
mod thermometer_pairs;
pub mod verdict;

pub use request::{Outcome, Request, RunError, Table, session};

use crate::record::RunRecord;

/// Runs a procedure on a recording. `progress` gets bytes read and bytes in all.
///
/// # Errors
/// [`RunError`] when there is nothing to evaluate. Everything else, a missing serial number included, is a verdict.
pub fn execute(request: &Request<'_>, progress: &mut dyn FnMut(u64, u64)) -> Result<Outcome, RunError> {
    kinds::of_request(request).run(request, progress)
}

/// The record of a run whose recording could not be evaluated: the verdict is `error` and the reason is in the record, so
/// that no earlier report survives a failed run.
pub fn failed(request: &Request<'_>, error: &RunError) -> RunRecord {
    build_record::failed(request, kinds::of_request(request).checks(), error)
}
