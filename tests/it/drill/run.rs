//! A spoilt recording under the static procedure, by the library.

use crate::support::tested::tested;
use sagnac::config::procedure::load;
use sagnac::record::RunRecord;
use std::path::Path;

/// The record, or what was said instead.
pub fn run(folder: &Path, recording: &Path, change: impl Fn(String) -> String) -> Result<RunRecord, String> {
    let shipped = std::fs::read_to_string(crate::support::procedure()).unwrap();
    let own = folder.join("procedure.toml");
    std::fs::write(&own, change(shipped)).unwrap();
    let procedure = load(&own).map_err(|e| e.to_string())?;
    tested(&procedure, recording).map_err(|e| e.to_string())
}
