//! A store of results: folders that never change, addressed by their contents, and an index of them.
//!
//! The folders and statements are what there is; the index is made from them, and can be made anew at any time. A folder
//! appears whole by one rename, and its rows by one transaction; an address between the two is listed as pending, and whoever
//! opens the store next completes it.

mod add;
pub mod address;
mod attempt;
mod database;
mod entry;
mod error;
mod export;
mod finding;
mod folders;
mod import;
mod index;
mod layout;
mod lock;
mod maintenance;
mod marker;
mod opened;
mod recordings;
mod reservation;
mod statement;
mod verify;

pub use add::Added;
pub use attempt::attempt_of;
pub use entry::{Entry, EntryRecording, EntryTest, EntryUnit, Reason, ReasonKind};
pub use error::StoreError;
pub use export::export;
pub use finding::{Finding, Part};
pub use import::{RecordingSearch, result_folders};
pub use index::{Attempt, Correction, Counted, Filter};
pub use layout::{Layout, STORE_FORMAT};
pub use maintenance::{Rebuilt, rebuild};
pub use marker::init;
pub use opened::Store;
pub use reservation::Reservation;
pub use verify::{Verified, verify};
