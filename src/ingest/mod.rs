//! Recordings as users name them: a file, several files, a pattern, a manifest.

pub mod lot;
mod recording;
pub mod result_table;
pub mod serial;
pub mod unit_data;

pub use recording::{
    Recording, RecordingError, are_several, each_of, files_read, open_files, open_recording, open_with,
};
pub use sagnac_ingest::*;
