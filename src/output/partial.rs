//! Folders and files in the making: hidden, locked while their process lives, removed when it does not.
//!
//! A process holds a lock on what it makes, so that another can tell what was left by one that was killed. The name
//! holds the boot of the machine that made it: on a shared disk, where a lock of another machine need not be seen, only
//! age tells.

use super::kind::Kind;
use sagnac_ingest::open_file;
use std::fs::{self, File, TryLockError};
use std::ops::Deref;
use std::path::{Path, PathBuf};
use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, SystemTime};

/// Where no lock tells, what killed runs left is removed after this time: no run lasts as long.
const ABANDONED_AFTER: Duration = Duration::from_secs(24 * 3600);

/// Attempts to make something that no other run takes for abandoned before it is locked.
const MAX_ATTEMPTS: usize = 10;

/// Files that this process is making.
static LIVE_PATHS: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

static BOOT_ID: LazyLock<String> = LazyLock::new(|| {
    let id = fs::read_to_string("/proc/sys/kernel/random/boot_id").unwrap_or_default();
    let id: String = id.chars().filter(char::is_ascii_hexdigit).take(8).collect();
    if id.len() == 8 { id.to_lowercase() } else { "00000000".to_owned() }
});

/// The beginning of the name of what will be `name`.
pub(super) fn prefix(name: &str) -> String {
    format!(".{name}.partial-{}-", *BOOT_ID)
}

/// While this lives, [`abandon_all`] waits.
pub(super) fn quiet() -> MutexGuard<'static, Vec<PathBuf>> {
    LIVE_PATHS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes everything that this process is making. For the end of the process by a signal: nothing can be made
/// afterwards.
pub fn abandon_all() {
    let mut live = quiet();
    for path in live.drain(..) {
        let _ = if path.is_dir() { fs::remove_dir_all(&path) } else { fs::remove_file(&path) };
    }
    // Whoever would write on waits for the end.
    std::mem::forget(live);
}

/// A lock on a file or folder; `None` where it is taken or the system has none. It ends with the value.
pub(super) fn lock(path: &Path) -> Option<File> {
    let file = open_file(path).ok()?;
    file.try_lock().ok().map(|()| file)
}

/// Something in the making, known to [`abandon_all`] and locked against [`remove_abandoned`].
#[derive(Debug)]
pub(super) struct Partial<T: AsRef<Path>> {
    // The thing goes before its entry and lock.
    thing: T,
    entry: Entry,
}

/// What this process knows of something in the making. It must not end under [`quiet`].
#[derive(Debug)]
pub(super) struct Entry {
    path: PathBuf,
    _lock: Option<File>,
}

impl Drop for Entry {
    fn drop(&mut self) {
        quiet().retain(|path| *path != self.path);
    }
}

impl<T: AsRef<Path>> Partial<T> {
    /// Makes it.
    pub(super) fn begin(make: impl Fn() -> std::io::Result<T>) -> std::io::Result<Partial<T>> {
        let mut live = quiet();
        let mut attempt = 0;
        loop {
            attempt += 1;
            let thing = make()?;
            let path = thing.as_ref().to_owned();
            // Between making and locking it, another run may have taken it for abandoned: it is gone, or locked to be removed.
            let held = open_file(&path).map(|file| file.try_lock().map(|()| file));
            let doomed = matches!(held, Ok(Err(TryLockError::WouldBlock)));
            let lock = held.ok().and_then(Result::ok);
            if path.exists() && !doomed || attempt == MAX_ATTEMPTS {
                live.push(path.clone());
                return Ok(Partial { thing, entry: Entry { path, _lock: lock } });
            }
        }
    }

    /// Its path.
    pub(super) fn path(&self) -> &Path {
        self.thing.as_ref()
    }

    /// The thing, and what was known of it.
    pub(super) fn into_parts(self) -> (T, Entry) {
        (self.thing, self.entry)
    }
}

impl<T: AsRef<Path>> Deref for Partial<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.thing
    }
}

/// True for a partial name made since this machine booted; `None` for a name that is not of the program's form.
fn made_here(name: &str) -> Option<bool> {
    let (before, rest) = name.rsplit_once(".partial-")?;
    let boot = rest.split_once('-').map(|(boot, _)| boot);
    let random = rest.rsplit('-').next()?;
    let of = |text: &str, n| text.len() == n && text.chars().all(|c| c.is_ascii_alphanumeric());
    let ours = before.len() > 1
        && before.starts_with('.')
        && of(random, 6)
        && boot.is_none_or(|b| of(b, 8))
        && rest.matches('-').count() <= 1;
    ours.then(|| boot == Some(BOOT_ID.as_str()))
}

/// True for the name of something in the making, or of what a killed run left of it.
pub fn is_partial(name: &str) -> bool {
    made_here(name).is_some()
}

/// Removes what killed runs left in a folder. Best effort: it is clutter and harms nobody.
pub fn remove_abandoned(parent: &Path) {
    for entry in fs::read_dir(parent).into_iter().flatten().flatten() {
        let Some(here) = made_here(&entry.file_name().to_string_lossy()) else { continue };
        let Ok(kind) = entry.file_type() else { continue };
        let path = entry.path();
        if kind.is_symlink() || kind.is_dir() && !holds_only_ours(&path) {
            continue;
        }
        // The lock is held while it is removed, so that nobody begins to use it.
        let held = open_file(&path).map(|file| file.try_lock().map(|()| file));
        let dead = match &held {
            Ok(Ok(_)) if here => true,
            Ok(Err(TryLockError::WouldBlock)) => false,
            _ => old(&path),
        };
        if dead {
            let _ = if kind.is_dir() { fs::remove_dir_all(&path) } else { fs::remove_file(&path) };
        }
    }
}

fn old(path: &Path) -> bool {
    let modified = path.symlink_metadata().and_then(|m| m.modified()).ok();
    modified.and_then(|m| SystemTime::now().duration_since(m).ok()).is_some_and(|age| age > ABANDONED_AFTER)
}

/// True when every entry of a folder is one that a folder in the making has.
fn holds_only_ours(folder: &Path) -> bool {
    let Ok(entries) = fs::read_dir(folder) else { return false };
    let names: Vec<String> =
        entries.flatten().map(|e| e.file_name().to_string_lossy().into_owned()).collect();
    Kind::ALL
        .iter()
        .any(|k| names.iter().all(|n| k.owns(n) || *k == Kind::Lot && holds_a_result(&folder.join(n))))
}

/// True for the folder of a unit in a lot: every entry is one that a result has.
fn holds_a_result(folder: &Path) -> bool {
    let Ok(entries) = fs::read_dir(folder) else { return false };
    let is_link = folder.symlink_metadata().is_ok_and(|m| m.file_type().is_symlink());
    !is_link && entries.flatten().all(|e| Kind::Result.owns(&e.file_name().to_string_lossy()))
}
