//! Output folders that appear whole or not at all.
//!
//! Everything is written into a hidden folder beside the target, synced to disk, and put in place by one rename. A
//! run that is killed, or a disk that fills up, leaves the earlier result or none, never half of a new one.
//!
//! A result lists its inputs and its files. It takes the place of an earlier one unasked only where both have the same
//! inputs, and only files that the earlier one lists are ever removed.

mod addressed;
mod archive;
mod checksums;
mod contained;
mod csv;
mod earlier;
mod error;
mod file;
mod kind;
mod parquet;
mod part;
mod partial;
mod stores;
mod transfer;

pub use addressed::AddressedFolder;
pub use archive::archive;
pub use checksums::{
    CHECKSUMS_FILE, UNREAD_HASH, checksums, read_checksums, sha256, sha256_of_beginning, sha256_of_file,
    sha256_of_several,
};
pub use contained::{Found, NotRead, found_below, open_below, read_below, sha256_below};
pub use csv::csv_line;
pub use error::OutputError;
pub use file::StagedFile;
pub use kind::{CERTIFICATE_STEM, Kind, LIMITS_FILE, MAX_RECORD_BYTES, PROCEDURE_FILE, SIGNATURES_FOLDER};
pub use parquet::{Column, Doubles, write_table};
pub use part::StagedPart;
pub use partial::{abandon_all, is_partial, remove_abandoned};
pub use stores::{STORE_MARKER, outside_stores};
pub use transfer::{ProvenCopy, TransferError};

use crate::i18n::{Note, note};
use earlier::{Earlier, starts_with_format};
use error::io;
use partial::Partial;
use sagnac_ingest::read_file;
use serde::Serialize;
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io::Write;
use std::path::{Component, Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Attempts to put a folder in place while other runs put theirs there.
const RENAME_ATTEMPTS: usize = 100;

/// A folder in the making. Dropped without [`StagedFolder::publish`], it leaves nothing behind.
#[derive(Debug)]
pub struct StagedFolder {
    target: PathBuf,
    staging: Partial<tempfile::TempDir>,
    kind: Kind,
    order: Order,
    replaces: Option<Note>,
    /// Names of the files that were written, and their hashes.
    written: Mutex<BTreeMap<String, String>>,
}

/// The inputs of a folder, and whether it may replace a result of other inputs.
#[derive(Debug, Clone, Default)]
pub struct Order {
    /// The inputs: their names, such as `recording`, and what tells each from others, such as a hash.
    pub inputs: BTreeMap<String, String>,
    /// Inputs that are files, by their names. Their hashes come from reading them ([`StagedFolder::were_read`]). If a result already
    /// stands at the place, they are hashed first, to compare them with its inputs.
    pub files: BTreeMap<String, Vec<PathBuf>>,
    /// Files and folders that are read, which the result must not take away.
    pub read: Vec<PathBuf>,
    /// Replaces a result of other inputs too.
    pub force: bool,
    /// The place was named by the program, not by the user: whatever stands there stays, and the next free name is taken.
    pub fresh: bool,
}

impl Order {
    /// Identifies the inputs that are files by their hashes, of which those of files that were read are known.
    pub fn identify_files(&mut self, known: &BTreeMap<PathBuf, String>) {
        for (name, paths) in std::mem::take(&mut self.files) {
            let hash = |path: &PathBuf| {
                let read = path.canonicalize().ok().and_then(|p| known.get(&p).cloned());
                read.or_else(|| sha256_of_file(path)).unwrap_or_else(|| UNREAD_HASH.to_owned())
            };
            self.inputs.insert(name, sha256_of_several(paths.iter().map(hash)));
        }
    }
}

/// A record with what it was made from and the files of its folder.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(title = "RunRecord"))]
pub struct Listed<T> {
    #[serde(flatten)]
    record: T,
    /// What the result was made from: SHA-256 of `recording`, `procedure`, `limits`, `model` and `options`, and the
    /// serial number of the `unit`, as far as there are any.
    #[cfg_attr(feature = "schema", schemars(default))]
    inputs: BTreeMap<String, String>,
    /// Every file of the folder, this one among them. Nothing else in it is ever removed by the program.
    #[cfg_attr(feature = "schema", schemars(default))]
    files: Vec<String>,
}

impl StagedFolder {
    /// Begins a folder that will appear at `target`. What stands there is looked at now, before any work is done: an
    /// earlier result of the same inputs is replaced on publication, one of others where the order says so; anything
    /// else is refused. An order for a fresh place leaves all of these alone: publication takes the next free name. What
    /// killed runs left in the folder of `target` is removed.
    ///
    /// # Errors
    /// [`OutputError`] when the place cannot be written or is taken.
    pub fn begin(target: &Path, kind: Kind, mut order: Order) -> Result<StagedFolder, OutputError> {
        let Some(name) = target.file_name() else {
            return Err(OutputError::NoName(target.to_owned()));
        };
        outside_stores(target)?;
        // A folder of another kind is refused for what it is.
        if !order.fresh && earlier::is_of(target, kind) {
            outside(target, &order.read)?;
        }
        let replaces = match target.symlink_metadata() {
            Ok(_) if !order.fresh => {
                order.identify_files(&BTreeMap::new());
                replaceable(target, kind, &order)?.filter(|e| e.inputs != order.inputs).map(|e| e.what())
            }
            _ => None,
        };
        let parent = parent(target);
        fs::create_dir_all(parent).map_err(io("output_error.create_folder", parent))?;
        partial::remove_abandoned(parent);
        let mut builder = tempfile::Builder::new();
        let prefix = partial::prefix(&name.to_string_lossy());
        builder.prefix(&prefix);
        // A result is read by colleagues: the usual rights under the user's umask, not those of a private scratch.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o777));
        let staging =
            Partial::begin(|| builder.tempdir_in(parent)).map_err(io("output_error.write_into", parent))?;
        let written = Mutex::default();
        Ok(StagedFolder { target: target.to_owned(), staging, kind, order, replaces, written })
    }

    /// The result of other inputs that publication will take away, where the order allows it.
    pub fn replaces(&self) -> Option<Note> {
        let what = self.replaces.clone()?;
        let path = self.target.display().to_string();
        Some(note!("output_error.replaces", path, what))
    }

    /// Takes the hashes of files that were read, as they were read, for those of the inputs.
    pub fn were_read(&mut self, files: impl IntoIterator<Item = (PathBuf, String)>) {
        let place = |(path, hash): (PathBuf, String)| Some((path.canonicalize().ok()?, hash));
        self.order.identify_files(&files.into_iter().filter_map(place).collect());
    }

    /// Writes one file into the folder; `name` may hold sub-folders.
    ///
    /// # Errors
    /// As [`StagedPart::write`].
    pub fn write(&self, name: &str, contents: &[u8]) -> Result<(), OutputError> {
        StagedPart::all_of(self).write(name, contents)
    }

    /// Writes one file whose name is known to be one of the folder.
    fn put(&self, name: &str, contents: &[u8]) -> Result<(), OutputError> {
        // A signal waits until the file is there: what is written after its cleaning would stay.
        let _quiet = partial::quiet();
        let path = self.staging.path().join(name);
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent).map_err(io("output_error.create_folder", parent))?;
        }
        let mut file = File::create(&path).map_err(io("output_error.create", &path))?;
        file.write_all(contents).map_err(io("output_error.write", &path))?;
        file.sync_all().map_err(io("output_error.sync", &path))?;
        self.written.lock().unwrap_or_else(PoisonError::into_inner).insert(name.to_owned(), sha256(contents));
        Ok(())
    }

    /// The identities of the inputs; files that were not read are hashed.
    fn inputs(&self) -> Cow<'_, BTreeMap<String, String>> {
        if self.order.files.is_empty() {
            return Cow::Borrowed(&self.order.inputs);
        }
        let mut order = self.order.clone();
        order.identify_files(&BTreeMap::new());
        Cow::Owned(order.inputs)
    }

    /// Writes the record with the list of everything that the folder holds, and the hashes of all of it; puts the folder in its place in one step
    /// and gives its path back.
    ///
    /// # Errors
    /// [`OutputError::Io`] when the place cannot be written, [`OutputError::InTheWay`] or [`OutputError::Other`] when
    /// it was taken meanwhile.
    pub fn publish(mut self, record: impl Serialize) -> Result<PathBuf, OutputError> {
        self.order.identify_files(&BTreeMap::new());
        let marks = self.kind.record_file();
        let json = StagedPart::all_of(&self).finish(record)?;
        let quiet = partial::quiet();
        let StagedFolder { mut target, staging, kind, order, .. } = self;
        let (folder, entry) = staging.into_parts();
        let staged = folder.keep();
        let reserved = if order.fresh { reserve(&target).map(|free| target = free) } else { Ok(()) };
        let outcome = reserved.and_then(|()| put_in_place(&staged, &target, kind, &order));
        if outcome.is_err() && order.fresh {
            // Goes only while it is empty.
            let _ = fs::remove_dir(&target);
        }
        if outcome.is_err() && staged.join(marks).exists() && is_own(&staged, &json) {
            // Best effort: what could not be published must not stay behind as clutter.
            let _ = fs::remove_dir_all(&staged);
        }
        drop(quiet);
        drop(entry);
        outcome?;
        sync_folder(parent(&target))?;
        Ok(target)
    }
}

/// Makes an empty folder of a name, or of the next free one: `name_2`, `name_3` and so on. Only one of several runs can make
/// it, so that no two take the same name.
fn reserve(target: &Path) -> Result<PathBuf, OutputError> {
    let mut free = target.to_owned();
    for n in 2.. {
        match fs::create_dir(&free) {
            Err(e) if e.kind() == std::io::ErrorKind::AlreadyExists => {
                let mut name = target.as_os_str().to_owned();
                name.push(format!("_{n}"));
                free = PathBuf::from(name);
            }
            made => {
                made.map_err(io("output_error.put_in_place", &free))?;
                break;
            }
        }
    }
    Ok(free)
}

/// A record with its inputs and the list of the files beside it, itself and their hashes among them, as JSON.
fn listed(
    record: impl Serialize,
    inputs: &BTreeMap<String, String>,
    written: impl Iterator<Item = impl Into<String>>,
    marks: &str,
) -> Result<Vec<u8>, OutputError> {
    let own = [marks, CHECKSUMS_FILE].map(str::to_owned);
    let files: BTreeSet<String> = written.map(Into::into).chain(own).collect();
    let listed = Listed { record, inputs: inputs.clone(), files: files.into_iter().collect() };
    serde_json::to_vec_pretty(&listed).map_err(|e| OutputError::Unwritable(e.to_string()))
}

/// The folder that holds a path.
fn parent(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// True for a name that stays in its folder, and may have folders in it.
pub fn is_plain(name: &str) -> bool {
    !name.is_empty() && Path::new(name).components().all(|c| matches!(c, Component::Normal(_)))
}

/// Refuses a place that holds something that is read.
fn outside(target: &Path, read: &[PathBuf]) -> Result<(), OutputError> {
    let Ok(place) = target.canonicalize() else { return Ok(()) };
    let inside = |input: &&PathBuf| {
        // A file that is a link has two places: its own and that of what it leads to.
        let own = input.parent().map(|p| if p.as_os_str().is_empty() { Path::new(".") } else { p });
        let own = own.and_then(|p| p.canonicalize().ok());
        own.is_some_and(|p| p.starts_with(&place))
            || input.canonicalize().is_ok_and(|i| i.starts_with(&place))
    };
    match read.iter().find(inside) {
        Some(input) => Err(OutputError::InputInside { path: target.to_owned(), input: input.clone() }),
        None => Ok(()),
    }
}

/// Refuses a file that is read.
fn outside_file(target: &Path, read: &[PathBuf]) -> Result<(), OutputError> {
    let Ok(place) = target.canonicalize() else { return Ok(()) };
    match read.iter().find(|input| input.canonicalize().is_ok_and(|i| i == place)) {
        Some(input) => Err(OutputError::InputInside { path: target.to_owned(), input: input.clone() }),
        None => Ok(()),
    }
}

/// The earlier result that may be replaced; `None` for an empty folder. Whatever else stands there is refused.
fn replaceable(target: &Path, kind: Kind, order: &Order) -> Result<Option<Earlier>, OutputError> {
    let Some(earlier) = Earlier::at(target, kind)? else { return Ok(None) };
    if order.force || earlier.inputs == order.inputs {
        return Ok(Some(earlier));
    }
    let differ = earlier.differing(&order.inputs);
    Err(OutputError::Other { path: target.to_owned(), what: earlier.what(), differ })
}

/// True when a folder holds the record that was just written.
fn is_own(folder: &Path, json: &[u8]) -> bool {
    Kind::ALL
        .iter()
        .any(|k| read_file(&folder.join(k.record_file()), MAX_RECORD_BYTES).is_ok_and(|found| found == json))
}

/// Waits until the names in a folder are on the disk.
pub(crate) fn sync_folder(path: &Path) -> Result<(), OutputError> {
    File::open(path).and_then(|f| f.sync_all()).map_err(io("output_error.sync", path))
}

#[cfg(target_os = "linux")]
fn put_in_place(staged: &Path, target: &Path, kind: Kind, order: &Order) -> Result<(), OutputError> {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    use rustix::io::Errno;
    let rename = |flags| renameat_with(CWD, staged, CWD, target, flags);
    for _ in 0..RENAME_ATTEMPTS {
        match rename(RenameFlags::NOREPLACE) {
            Ok(()) => return Ok(()),
            Err(Errno::EXIST) => {}
            Err(_) => break,
        }
        replaceable(target, kind, order)?;
        // Another run that tidies up must not take the old folder, once it stands aside, for one that was left.
        let _lock = partial::lock(target);
        // An exchange is one step: at no moment is there neither the old folder nor the new one.
        match rename(RenameFlags::EXCHANGE) {
            Ok(()) => {
                // What came between the look and the exchange goes back.
                return match replaceable(staged, kind, order) {
                    Ok(old) => earlier::remove(staged, old.as_ref()),
                    Err(e) => {
                        let _ = rename(RenameFlags::EXCHANGE);
                        Err(e)
                    }
                };
            }
            // Another run has just taken the old folder away.
            Err(Errno::NOENT) => {}
            Err(_) => break,
        }
    }
    replace_in_two_steps(staged, target, kind, order)
}

#[cfg(not(target_os = "linux"))]
fn put_in_place(staged: &Path, target: &Path, kind: Kind, order: &Order) -> Result<(), OutputError> {
    replace_in_two_steps(staged, target, kind, order)
}

/// For file systems without an exchange: the old folder steps aside first.
fn replace_in_two_steps(staged: &Path, target: &Path, kind: Kind, order: &Order) -> Result<(), OutputError> {
    if target.symlink_metadata().is_err() {
        return fs::rename(staged, target).map_err(io("output_error.put_in_place", target));
    }
    let old = replaceable(target, kind, order)?;
    let mut aside = staged.as_os_str().to_owned();
    aside.push(".replaced");
    let aside = PathBuf::from(aside);
    fs::rename(target, &aside).map_err(io("output_error.set_aside", target))?;
    if let Err(e) = fs::rename(staged, target) {
        let _ = fs::rename(&aside, target);
        return Err(io("output_error.put_in_place", target)(e));
    }
    earlier::remove(&aside, old.as_ref())
}

#[cfg(test)]
mod tests;
