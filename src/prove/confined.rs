//! A process that can open nothing but one folder and what the system needs to start it.

use crate::confined::{Reach, confine};
use std::io;
use std::path::Path;
use std::process::{Command, Output, Stdio};

/// Runs a program in a folder, without the environment of the caller. True beside its output where the kernel kept it from
/// everything else; elsewhere nothing but its own honesty does.
///
/// # Errors
/// A program that cannot be started.
pub(super) fn run(folder: &Path, program: &Path, args: &[&str]) -> io::Result<(Output, bool)> {
    let mut command = Command::new(program);
    command.args(args).current_dir(folder).env_clear().stdin(Stdio::null());
    // The rules bind the thread that sets them and what it starts.
    std::thread::scope(|scope| {
        let confined = scope.spawn(|| {
            let kept = confine(&Reach { read: &[program], write: &[folder] });
            command.output().map(|output| (output, kept.files))
        });
        confined.join().unwrap_or_else(|_| Err(io::ErrorKind::Other.into()))
    })
}

#[cfg(test)]
mod tests {
    #[cfg(target_os = "linux")]
    use super::*;

    #[cfg(target_os = "linux")]
    #[test]
    fn a_process_opens_its_folder_and_nothing_else() {
        let (inside, outside) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        std::fs::write(inside.path().join("shown"), "shown").unwrap();
        let hidden = outside.path().join("hidden");
        std::fs::write(&hidden, "hidden").unwrap();
        let cat = |path: &str| run(inside.path(), Path::new("/bin/cat"), &[path]).unwrap();
        let (said, kept) = cat("shown");
        assert_eq!((said.stdout.as_slice(), said.status.success()), (b"shown".as_slice(), true));
        let (said, _) = cat(hidden.to_str().unwrap());
        if kept {
            assert!(!said.status.success() && said.stdout.is_empty(), "{said:?}");
        } else {
            println!("skipped: this kernel confines nothing");
        }
        // The caller itself is as free as before.
        assert_eq!(std::fs::read_to_string(hidden).unwrap(), "hidden");
    }
}
