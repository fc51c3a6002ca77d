//! Where the public recordings of real instruments stand.

use std::io::Write as _;
use std::path::PathBuf;

/// The folder of a data set in the folder named by `SAGNAC_REAL_DATA`, or `None` with a visible line.
pub fn set(name: &str) -> Option<PathBuf> {
    let Some(folder) = std::env::var_os("SAGNAC_REAL_DATA") else {
        let _ = writeln!(std::io::stderr(), "SKIPPED: {name}: SAGNAC_REAL_DATA is not set");
        return None;
    };
    let path = std::path::absolute(folder).unwrap().join(name);
    assert!(path.is_dir(), "SAGNAC_REAL_DATA is set, but {} is not there", path.display());
    Some(path)
}
