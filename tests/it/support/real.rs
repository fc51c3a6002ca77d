//! Where the public recordings of real instruments stand.

use std::fs::File;
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};

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

/// The text of a packed file.
pub fn unpacked(path: &Path) -> String {
    let mut text = String::new();
    flate2::read::GzDecoder::new(File::open(path).unwrap()).read_to_string(&mut text).unwrap();
    text
}
