//! Recordings as users name them: a file, several files, a pattern, a manifest.

mod recording;

pub use recording::{Recording, RecordingError, each_of, files_read, open_files, open_recording, open_with};
pub use sagnac_ingest::*;
