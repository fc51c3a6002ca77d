//! A folder whose place is found only when all of it is written: the address of its contents.

use super::error::{OutputError, io};
use super::kind::Kind;
use super::partial::{self, Partial};
use super::{is_plain, parent, sync_folder};
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Beginning of the names of such folders in the making.
const STAGING_NAME: &str = "result";

/// A result folder in the making. Dropped without [`AddressedFolder::publish`], it leaves nothing behind.
#[derive(Debug)]
pub struct AddressedFolder {
    staging: Partial<tempfile::TempDir>,
}

impl AddressedFolder {
    /// Begins a folder inside `within`, on the disk that it will stay on. What killed processes left there is removed.
    ///
    /// # Errors
    /// [`OutputError::Io`] when the place cannot be written.
    pub fn begin(within: &Path) -> Result<AddressedFolder, OutputError> {
        fs::create_dir_all(within).map_err(io("output_error.create_folder", within))?;
        partial::remove_abandoned(within);
        let mut builder = tempfile::Builder::new();
        let prefix = partial::prefix(STAGING_NAME);
        builder.prefix(&prefix);
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o777));
        let staging =
            Partial::begin(|| builder.tempdir_in(within)).map_err(io("output_error.write_into", within))?;
        Ok(AddressedFolder { staging })
    }

    /// Writes one file; `name` may hold sub-folders.
    ///
    /// # Errors
    /// [`OutputError::Unforeseen`] for a name that no result has, [`OutputError::Io`] when it cannot be written.
    pub fn write(&self, name: &str, contents: &[u8]) -> Result<(), OutputError> {
        if !is_plain(name) || !Kind::Result.owns(name.split('/').next().unwrap_or_default()) {
            return Err(OutputError::Unforeseen(name.to_owned()));
        }
        let _quiet = partial::quiet();
        let path = self.staging.path().join(name);
        let folder = parent(&path);
        fs::create_dir_all(folder).map_err(io("output_error.create_folder", folder))?;
        let mut file = File::create(&path).map_err(io("output_error.create", &path))?;
        file.write_all(contents).map_err(io("output_error.write", &path))?;
        file.sync_all().map_err(io("output_error.sync", &path))
    }

    /// Puts the folder in its place in one step. `false` where a folder stands there already: one with the same address has
    /// the same contents, and it stays.
    ///
    /// # Errors
    /// [`OutputError::Io`] when the place cannot be written.
    pub fn publish(self, target: &Path) -> Result<bool, OutputError> {
        let folder = parent(target);
        fs::create_dir_all(folder).map_err(io("output_error.create_folder", folder))?;
        sync_all_below(self.staging.path())?;
        let quiet = partial::quiet();
        let (staging, entry) = self.staging.into_parts();
        let staged = staging.keep();
        // A folder with something in it is never replaced by a rename.
        let outcome = fs::rename(&staged, target);
        if outcome.is_err() {
            // Best effort: what could not be published must not stay behind as clutter.
            let _ = fs::remove_dir_all(&staged);
        }
        drop(quiet);
        drop(entry);
        match outcome {
            Ok(()) => {
                sync_folder(folder)?;
                Ok(true)
            }
            Err(_) if target.is_dir() => Ok(false),
            Err(e) => Err(io("output_error.put_in_place", target)(e)),
        }
    }
}

/// Syncs a folder and the folders in it.
fn sync_all_below(folder: &Path) -> Result<(), OutputError> {
    let mut open: Vec<PathBuf> = vec![folder.to_owned()];
    while let Some(next) = open.pop() {
        for entry in fs::read_dir(&next).map_err(io("output_error.look_into", &next))?.flatten() {
            if entry.file_type().is_ok_and(|t| t.is_dir()) {
                open.push(entry.path());
            }
        }
        sync_folder(&next)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_appears_whole_once() {
        let disk = tempfile::tempdir().unwrap();
        let target = disk.path().join("ab/abcd");
        for (text, new) in [("first", true), ("second", false)] {
            let folder = AddressedFolder::begin(disk.path()).unwrap();
            folder.write("figures/a.svg", text.as_bytes()).unwrap();
            assert_eq!(folder.publish(&target).unwrap(), new);
            assert_eq!(fs::read_to_string(target.join("figures/a.svg")).unwrap(), "first");
        }
        drop(AddressedFolder::begin(disk.path()).unwrap());
        let names: Vec<_> = fs::read_dir(disk.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
        assert_eq!(names, ["ab"]);
    }

    #[test]
    fn names_lead_nowhere_else() {
        let disk = tempfile::tempdir().unwrap();
        let folder = AddressedFolder::begin(disk.path()).unwrap();
        for name in ["../result.json", "figures/../../x", "/result.json", "notes.txt", ""] {
            assert!(matches!(folder.write(name, b""), Err(OutputError::Unforeseen(_))), "{name}");
        }
    }
}
