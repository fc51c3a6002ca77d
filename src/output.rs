//! Output folders that appear whole or not at all.
//!
//! Everything is written into a hidden folder beside the target, synced to disk, and put in place by one rename. A
//! run that is killed, or a disk that fills up, leaves the earlier result or none, never half of a new one.

use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Why an output folder could not be written.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// The operating system refused.
    #[error("failed to {action} {}: {source}", path.display())]
    Io {
        /// What was attempted.
        action: &'static str,
        /// On which path.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// Something that is no earlier result stands in the way.
    #[error("{} exists and is no result folder of this program; choose another --out or remove it", .0.display())]
    InTheWay(PathBuf),
}

fn io(action: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> OutputError + use<> {
    let path = path.to_owned();
    move |source| OutputError::Io { action, path, source }
}

/// A folder in the making. Dropped without [`StagedFolder::publish`], it leaves nothing behind.
#[derive(Debug)]
pub struct StagedFolder {
    target: PathBuf,
    staging: tempfile::TempDir,
}

impl StagedFolder {
    /// Begins a folder that will appear at `target`. An earlier result there is replaced on publication; anything
    /// else there is refused now, before any work is done.
    ///
    /// # Errors
    /// [`OutputError`] when the place cannot be written or is taken.
    pub fn begin(target: &Path) -> Result<StagedFolder, OutputError> {
        if target.symlink_metadata().is_ok() && !replaceable(target) {
            return Err(OutputError::InTheWay(target.to_owned()));
        }
        let parent = match target.parent() {
            Some(p) if !p.as_os_str().is_empty() => p.to_owned(),
            _ => PathBuf::from("."),
        };
        fs::create_dir_all(&parent).map_err(io("create the folder", &parent))?;
        let name = target.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let prefix = format!(".{name}.partial-");
        let mut builder = tempfile::Builder::new();
        builder.prefix(&prefix);
        // A result is read by colleagues: the usual rights under the user's umask, not those of a private scratch.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o777));
        let staging = builder.tempdir_in(&parent).map_err(io("write into", &parent))?;
        Ok(StagedFolder { target: target.to_owned(), staging })
    }

    /// Writes one file into the folder; `name` may hold sub-folders.
    ///
    /// # Errors
    /// [`OutputError::Io`] when it cannot be written.
    pub fn write(&self, name: &str, contents: &[u8]) -> Result<(), OutputError> {
        let path = self.staging.path().join(name);
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent).map_err(io("create the folder", parent))?;
        }
        let mut file = File::create(&path).map_err(io("create", &path))?;
        file.write_all(contents).map_err(io("write", &path))?;
        file.sync_all().map_err(io("sync", &path))
    }

    /// Puts the folder in its place in one step and gives its path back.
    ///
    /// # Errors
    /// [`OutputError::Io`] when the place cannot be written.
    pub fn publish(self) -> Result<PathBuf, OutputError> {
        sync_folder(self.staging.path())?;
        let staged = self.staging.keep();
        let outcome = put_in_place(&staged, &self.target);
        if outcome.is_err() {
            // Best effort: what could not be published must not stay behind as clutter.
            let _ = fs::remove_dir_all(&staged);
        }
        outcome?;
        if let Some(parent) = self.target.parent().filter(|p| !p.as_os_str().is_empty()) {
            sync_folder(parent)?;
        }
        Ok(self.target)
    }
}

/// An empty folder, or one that holds an earlier result.
fn replaceable(target: &Path) -> bool {
    match fs::read_dir(target) {
        Ok(mut entries) => entries.next().is_none() || target.join("result.json").is_file(),
        Err(_) => false,
    }
}

fn sync_folder(path: &Path) -> Result<(), OutputError> {
    let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
    File::open(path).and_then(|f| f.sync_all()).map_err(io("sync", path))
}

#[cfg(target_os = "linux")]
fn put_in_place(staged: &Path, target: &Path) -> Result<(), OutputError> {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    if target.symlink_metadata().is_err() {
        return fs::rename(staged, target).map_err(io("put in place", target));
    }
    // An exchange is one step: at no moment is there neither the old folder nor the new one.
    match renameat_with(CWD, staged, CWD, target, RenameFlags::EXCHANGE) {
        Ok(()) => {
            fs::remove_dir_all(staged).map_err(io("remove the replaced folder", staged))?;
            Ok(())
        }
        Err(_) => replace_in_two_steps(staged, target),
    }
}

#[cfg(not(target_os = "linux"))]
fn put_in_place(staged: &Path, target: &Path) -> Result<(), OutputError> {
    if target.symlink_metadata().is_err() {
        return fs::rename(staged, target).map_err(io("put in place", target));
    }
    replace_in_two_steps(staged, target)
}

/// For file systems without an exchange: the old folder steps aside first.
fn replace_in_two_steps(staged: &Path, target: &Path) -> Result<(), OutputError> {
    let aside = staged.with_extension("replaced");
    fs::rename(target, &aside).map_err(io("set aside", target))?;
    if let Err(e) = fs::rename(staged, target) {
        let _ = fs::rename(&aside, target);
        return Err(io("put in place", target)(e));
    }
    fs::remove_dir_all(&aside).map_err(io("remove the replaced folder", &aside))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_appears_whole_and_replaces_an_earlier_result() {
        let dir = tempfile::tempdir().unwrap();
        let target = dir.path().join("result");
        for round in ["first", "second"] {
            let staged = StagedFolder::begin(&target).unwrap();
            staged.write("result.json", round.as_bytes()).unwrap();
            staged.write("figures/a.svg", b"<svg/>").unwrap();
            staged.publish().unwrap();
            assert_eq!(fs::read_to_string(target.join("result.json")).unwrap(), round);
        }
        let left: Vec<_> = fs::read_dir(dir.path()).unwrap().collect();
        assert_eq!(left.len(), 1, "nothing but the result stays: {left:?}");
    }

    #[test]
    fn abandoned_work_leaves_nothing_and_foreign_folders_are_safe() {
        let dir = tempfile::tempdir().unwrap();
        let target = dir.path().join("result");
        let staged = StagedFolder::begin(&target).unwrap();
        staged.write("result.json", b"half").unwrap();
        drop(staged);
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 0);

        fs::create_dir(&target).unwrap();
        fs::write(target.join("thesis.txt"), "do not touch").unwrap();
        assert!(matches!(StagedFolder::begin(&target), Err(OutputError::InTheWay(_))));
        assert!(target.join("thesis.txt").is_file());
    }
}
