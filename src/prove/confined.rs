//! A process that can open nothing but one folder and what the system needs to start it.

use std::io;
use std::path::Path;
use std::process::{Command, Output, Stdio};

/// Where programs, libraries and their settings are that any program needs in order to start.
#[cfg(target_os = "linux")]
const SYSTEM_FOLDERS: [&str; 7] =
    ["/bin", "/usr/bin", "/lib", "/lib64", "/usr/lib", "/usr/lib64", "/etc/ld.so.cache"];

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
            let kept = confine(folder, program);
            command.output().map(|output| (output, kept))
        });
        confined.join().unwrap_or_else(|_| Err(io::ErrorKind::Other.into()))
    })
}

/// Confines this thread, and gives whether the kernel does it in full.
#[cfg(target_os = "linux")]
fn confine(folder: &Path, program: &Path) -> bool {
    use landlock::{
        ABI, Access, AccessFs, Ruleset, RulesetAttr, RulesetCreatedAttr, RulesetStatus, path_beneath_rules,
    };
    // The first version that also confines truncation; a newer kernel offers it all the same.
    let abi = ABI::V3;
    let rules = || -> Result<RulesetStatus, landlock::RulesetError> {
        let status = Ruleset::default()
            .handle_access(AccessFs::from_all(abi))?
            .create()?
            .add_rules(path_beneath_rules(SYSTEM_FOLDERS, AccessFs::from_read(abi)))?
            .add_rules(path_beneath_rules([program], AccessFs::from_read(abi)))?
            .add_rules(path_beneath_rules(["/dev/null"], AccessFs::from_file(abi)))?
            .add_rules(path_beneath_rules([folder], AccessFs::from_all(abi)))?
            .restrict_self()?;
        Ok(status.ruleset)
    };
    rules().is_ok_and(|status| status == RulesetStatus::FullyEnforced)
}

#[cfg(not(target_os = "linux"))]
fn confine(_folder: &Path, _program: &Path) -> bool {
    false
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
