//! Recordings as users name them: a file, several files, a pattern, a manifest, a layout.

pub mod manifest;
pub mod manifest_tables;
pub mod raw;
pub mod read_words;
pub(crate) mod reading;
pub(crate) mod reading_tables;
mod recording;

pub use recording::{Recording, RecordingError, each_of, files_read, open_files, open_recording, open_with};
pub use sagnac_ingest::*;
