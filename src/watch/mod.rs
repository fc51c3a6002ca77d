//! A watched folder: which recordings are complete, which were tested, who is still to be told.
//!
//! Nothing in the folder is moved, changed or written beside. The results have a folder of their own:
//!
//! ```text
//! journal.jsonl           a line for each test, synced before the next begins
//! results/SERIAL/ID/      the result of a test, as `sagnac run` writes it; ID is the beginning of its id
//! days/2027-03-01/        the page of a day
//! ```
//!
//! A result appears whole or not at all, and its place follows from what it is made of. So a test that was killed is made
//! again; one whose result is there, and whose line in the journal is missing, is entered and not made again.

pub mod folder;
pub mod hook;
pub mod identity;
pub mod journal;
pub mod lock;
pub mod process;
pub mod recording;

/// File of the journal.
pub const JOURNAL_FILE: &str = "journal.jsonl";
/// Folder of the results.
pub const RESULTS_FOLDER: &str = "results";
/// Folder of the pages of days.
pub const DAYS_FOLDER: &str = "days";
/// Digits of the id of a test in the name of its folder.
pub const FOLDER_DIGITS: usize = 16;
