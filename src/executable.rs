//! The file that starts this program: for tests that run in processes of their own.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

static STATED: OnceLock<PathBuf> = OnceLock::new();

/// States the file that starts the program, for a process that an interpreter runs. Only the first statement counts.
pub fn state(path: PathBuf) {
    let _ = STATED.set(path);
}

/// Where Linux keeps the file that this process was started from, even after another one took its place.
const OF_THIS_PROCESS: &str = "/proc/self/exe";

/// The file that starts the program: the stated one, else that of this process. A test of a watcher or a server that runs while the program
/// is updated is one of the version that began.
///
/// # Errors
/// The system does not tell it.
pub fn path() -> io::Result<PathBuf> {
    if let Some(stated) = STATED.get() {
        return Ok(stated.clone());
    }
    let kept = Path::new(OF_THIS_PROCESS);
    if cfg!(target_os = "linux") && kept.exists() { Ok(kept.to_path_buf()) } else { std::env::current_exe() }
}
