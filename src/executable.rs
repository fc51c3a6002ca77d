//! The file that starts this program: for tests that run in processes of their own.

use std::io;
use std::path::PathBuf;
use std::sync::OnceLock;

static STATED: OnceLock<PathBuf> = OnceLock::new();

/// States the file that starts the program, for a process that an interpreter runs. Only the first statement counts.
pub fn state(path: PathBuf) {
    let _ = STATED.set(path);
}

/// The file that starts the program: the stated one, else that of this process.
///
/// # Errors
/// The system does not tell it.
pub fn path() -> io::Result<PathBuf> {
    STATED.get().map_or_else(std::env::current_exe, |stated| Ok(stated.clone()))
}
