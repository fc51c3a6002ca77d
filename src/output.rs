//! Output folders that appear whole or not at all.
//!
//! Everything is written into a hidden folder beside the target, synced to disk, and put in place by one rename. A
//! run that is killed, or a disk that fills up, leaves the earlier result or none, never half of a new one.

mod csv;
mod file;

pub use csv::quoted;
pub use file::StagedFile;

use crate::text::{Note, io_reason};
use std::fmt;
use std::fs::{self, File};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

/// Why an output folder could not be written.
#[derive(Debug)]
pub enum OutputError {
    /// The operating system refused.
    Io {
        /// What failed: a key of the locale tables.
        action: &'static str,
        /// On which path.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// Something that is no earlier result stands in the way.
    InTheWay {
        /// Where.
        path: PathBuf,
        /// What is the matter with it.
        why: Note,
    },
    /// The target is `..`, the root or the like.
    NoName(PathBuf),
    /// A file that no result folder holds.
    Unforeseen(String),
}

impl OutputError {
    /// What is wrong, as a note.
    pub fn note(&self) -> Note {
        let at = |path: &Path| path.display().to_string();
        match self {
            OutputError::Io { action, path, source } => {
                Note::new(action).with("path", at(path)).with("reason", io_reason(source))
            }
            OutputError::InTheWay { path, why } => {
                Note::new("output_error.in_the_way").with("path", at(path)).with("why", why.clone())
            }
            OutputError::NoName(path) => Note::new("output_error.no_name").with("path", at(path)),
            OutputError::Unforeseen(name) => Note::new("output_error.unforeseen").with("name", name.as_str()),
        }
    }
}

impl fmt::Display for OutputError {
    /// In English.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.note().fmt(f)
    }
}

impl std::error::Error for OutputError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            OutputError::Io { source, .. } => Some(source),
            _ => None,
        }
    }
}

fn io(action: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> OutputError + use<> {
    let path = path.to_owned();
    move |source| OutputError::Io { action, path, source }
}

/// What killed runs leave is removed after this time: no run lasts as long.
const ABANDONED_AFTER: Duration = Duration::from_secs(24 * 3600);

/// Attempts to put a folder in place while other runs put theirs there.
const ATTEMPTS: usize = 100;

/// A folder in the making. Dropped without [`StagedFolder::publish`], it leaves nothing behind.
#[derive(Debug)]
pub struct StagedFolder {
    target: PathBuf,
    staging: tempfile::TempDir,
    kind: Kind,
}

/// What a folder holds; one kind never takes the place of another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The result of a run or an analysis.
    Result,
    /// A comparison.
    Comparison,
    /// The explanation of a mismatch.
    Explanation,
}

impl Kind {
    /// The file that tells the folder, and how its format begins.
    fn marks(self) -> (&'static str, &'static str) {
        match self {
            Kind::Result => ("result.json", "{\"format\":\"result/"),
            Kind::Comparison => ("comparison.json", "{\"format\":\"comparison/"),
            Kind::Explanation => ("explain.json", "{\"format\":\"explain/"),
        }
    }

    /// Names that stand in a folder of this kind.
    fn owns(self, name: &str) -> bool {
        name == "figures"
            || match self {
                Kind::Result => {
                    matches!(name, "result.json" | "report.html" | "report.md" | "explain")
                        || (name.starts_with("sigma_tau") && name.ends_with(".csv"))
                        || matches!(name, "table_steps.csv" | "interval_means.csv" | "phases")
                        || (name.starts_with("compensation")
                            && [".toml", ".json", ".h"].iter().any(|ext| name.ends_with(ext)))
                }
                Kind::Comparison => name
                    .strip_prefix("comparison.")
                    .is_some_and(|ext| matches!(ext, "json" | "html" | "md" | "csv")),
                Kind::Explanation => matches!(
                    name,
                    "explain.json" | "correction.csv" | "augmented.toml" | "report.html" | "report.md"
                ),
            }
    }
}

impl StagedFolder {
    /// Begins a folder that will appear at `target`. An earlier result there is replaced on publication; anything
    /// else there is refused now, before any work is done. What killed runs left beside `target` more than a day ago
    /// is removed.
    ///
    /// # Errors
    /// [`OutputError`] when the place cannot be written or is taken.
    pub fn begin(target: &Path) -> Result<StagedFolder, OutputError> {
        StagedFolder::begin_kind(target, Kind::Result)
    }

    /// The same for a folder of a kind.
    ///
    /// # Errors
    /// As [`StagedFolder::begin`].
    pub fn begin_kind(target: &Path, kind: Kind) -> Result<StagedFolder, OutputError> {
        let Some(name) = target.file_name() else {
            return Err(OutputError::NoName(target.to_owned()));
        };
        if target.symlink_metadata().is_ok() {
            replaceable(target, kind)?;
        }
        let parent = parent(target);
        fs::create_dir_all(parent).map_err(io("output_error.create_folder", parent))?;
        let prefix = format!(".{}.partial-", name.to_string_lossy());
        remove_abandoned(parent, &prefix);
        let mut builder = tempfile::Builder::new();
        builder.prefix(&prefix);
        // A result is read by colleagues: the usual rights under the user's umask, not those of a private scratch.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o777));
        let staging = builder.tempdir_in(parent).map_err(io("output_error.write_into", parent))?;
        Ok(StagedFolder { target: target.to_owned(), staging, kind })
    }

    /// Writes one file into the folder; `name` may hold sub-folders.
    ///
    /// # Errors
    /// [`OutputError::Io`] when it cannot be written, [`OutputError::Unforeseen`] for a name that a later run would
    /// not know as its own.
    pub fn write(&self, name: &str, contents: &[u8]) -> Result<(), OutputError> {
        if !self.kind.owns(name.split('/').next().unwrap_or_default()) {
            return Err(OutputError::Unforeseen(name.to_owned()));
        }
        let path = self.staging.path().join(name);
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent).map_err(io("output_error.create_folder", parent))?;
        }
        let mut file = File::create(&path).map_err(io("output_error.create", &path))?;
        file.write_all(contents).map_err(io("output_error.write", &path))?;
        file.sync_all().map_err(io("output_error.sync", &path))
    }

    /// Puts the folder in its place in one step and gives its path back.
    ///
    /// # Errors
    /// [`OutputError::Io`] when the place cannot be written, [`OutputError::InTheWay`] when it was taken meanwhile.
    pub fn publish(self) -> Result<PathBuf, OutputError> {
        let figures = self.staging.path().join("figures");
        if figures.is_dir() {
            sync_folder(&figures)?;
        }
        sync_folder(self.staging.path())?;
        let staged = self.staging.keep();
        let outcome = put_in_place(&staged, &self.target, self.kind);
        if outcome.is_err() {
            // Best effort: what could not be published must not stay behind as clutter.
            let _ = fs::remove_dir_all(&staged);
        }
        outcome?;
        sync_folder(parent(&self.target))?;
        Ok(self.target)
    }
}

/// The folder that holds a path.
fn parent(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// The first entry of a folder that no result folder holds.
fn foreign(folder: &Path, kind: Kind) -> std::io::Result<Option<String>> {
    for entry in fs::read_dir(folder)? {
        let name = entry?.file_name().to_string_lossy().into_owned();
        if !kind.owns(&name) {
            return Ok(Some(name));
        }
    }
    Ok(None)
}

/// Refuses whatever is neither an empty folder nor an earlier result and nothing else.
fn replaceable(target: &Path, kind: Kind) -> Result<(), OutputError> {
    let in_the_way = |why: Note| Err(OutputError::InTheWay { path: target.to_owned(), why });
    let found = target.symlink_metadata().map_err(io("output_error.look_at", target))?.file_type();
    if !found.is_dir() {
        let why = if found.is_symlink() { "output_error.why.link" } else { "output_error.why.file" };
        return in_the_way(why.into());
    }
    if fs::read_dir(target).map_err(io("output_error.look_into", target))?.next().is_none() {
        return Ok(());
    }
    if !is_of(target, kind) {
        return in_the_way(match kind {
            Kind::Result => "output_error.why.foreign".into(),
            Kind::Comparison => "compare.more.foreign_folder".into(),
            Kind::Explanation => "explain.error.foreign_folder".into(),
        });
    }
    match foreign(target, kind).map_err(io("output_error.look_into", target))? {
        Some(name) => in_the_way(Note::new("output_error.why.holds").with("name", name)),
        None => Ok(()),
    }
}

/// True when a folder holds the file that tells its kind.
fn is_of(folder: &Path, kind: Kind) -> bool {
    let (name, start) = kind.marks();
    let mut head = String::new();
    let read = File::open(folder.join(name)).and_then(|f| f.take(64).read_to_string(&mut head));
    read.is_ok() && head.split_whitespace().collect::<String>().starts_with(start)
}

/// Removes what killed runs left beside a target long ago. Best effort: it is clutter and harms nobody.
fn remove_abandoned(parent: &Path, prefix: &str) {
    let old = |path: &Path| {
        let modified = path.symlink_metadata().and_then(|m| m.modified()).ok();
        modified
            .and_then(|m| SystemTime::now().duration_since(m).ok())
            .is_some_and(|age| age > ABANDONED_AFTER)
    };
    for entry in fs::read_dir(parent).into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let ours = name
            .strip_prefix(prefix)
            .is_some_and(|rest| rest.len() == 6 && rest.chars().all(|c| c.is_ascii_alphanumeric()));
        let path = entry.path();
        let folder = entry.file_type().is_ok_and(|t| t.is_dir());
        if ours
            && folder
            && old(&path)
            && [Kind::Result, Kind::Comparison, Kind::Explanation]
                .iter()
                .any(|k| matches!(foreign(&path, *k), Ok(None)))
        {
            let _ = fs::remove_dir_all(&path);
        }
    }
}

fn sync_folder(path: &Path) -> Result<(), OutputError> {
    File::open(path).and_then(|f| f.sync_all()).map_err(io("output_error.sync", path))
}

#[cfg(target_os = "linux")]
fn put_in_place(staged: &Path, target: &Path, kind: Kind) -> Result<(), OutputError> {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    use rustix::io::Errno;
    let rename = |flags| renameat_with(CWD, staged, CWD, target, flags);
    for _ in 0..ATTEMPTS {
        match rename(RenameFlags::NOREPLACE) {
            Ok(()) => return Ok(()),
            Err(Errno::EXIST) => {}
            Err(_) => break,
        }
        replaceable(target, kind)?;
        // An exchange is one step: at no moment is there neither the old folder nor the new one.
        match rename(RenameFlags::EXCHANGE) {
            Ok(()) => return fs::remove_dir_all(staged).map_err(io("output_error.remove", staged)),
            // Another run has just taken the old folder away.
            Err(Errno::NOENT) => {}
            Err(_) => break,
        }
    }
    replace_in_two_steps(staged, target, kind)
}

#[cfg(not(target_os = "linux"))]
fn put_in_place(staged: &Path, target: &Path, kind: Kind) -> Result<(), OutputError> {
    replace_in_two_steps(staged, target, kind)
}

/// For file systems without an exchange: the old folder steps aside first.
fn replace_in_two_steps(staged: &Path, target: &Path, kind: Kind) -> Result<(), OutputError> {
    if target.symlink_metadata().is_err() {
        return fs::rename(staged, target).map_err(io("output_error.put_in_place", target));
    }
    replaceable(target, kind)?;
    let mut aside = staged.as_os_str().to_owned();
    aside.push(".replaced");
    let aside = PathBuf::from(aside);
    fs::rename(target, &aside).map_err(io("output_error.set_aside", target))?;
    if let Err(e) = fs::rename(staged, target) {
        let _ = fs::rename(&aside, target);
        return Err(io("output_error.put_in_place", target)(e));
    }
    fs::remove_dir_all(&aside).map_err(io("output_error.remove", &aside))
}

#[cfg(test)]
mod tests;
