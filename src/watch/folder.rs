//! The files of a watched folder that rules fit, and how long each has stood still.

use crate::config::watch::{SERIAL_PLACE, WatchRule};
use crate::i18n::{Note, io_reason, note};
use crate::ingest::serial::fits;
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, Metadata};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

/// Size and time of change of a file; of several, their sum and the latest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stamp {
    /// Size, bytes.
    pub bytes: u64,
    /// Time of the last change.
    pub modified: SystemTime,
}

impl Stamp {
    fn of(metadata: &Metadata) -> Stamp {
        let modified = metadata.modified().unwrap_or(SystemTime::UNIX_EPOCH);
        Stamp { bytes: metadata.len(), modified }
    }

    /// The stamp of files together.
    ///
    /// # Errors
    /// A note on a file that is none, or a link.
    pub fn of_all(files: &[PathBuf]) -> Result<Stamp, Note> {
        let mut whole = Stamp { bytes: 0, modified: SystemTime::UNIX_EPOCH };
        for file in files {
            let metadata = file.symlink_metadata().map_err(|e| {
                note!("watch.unreadable", path = file.display().to_string(), reason = io_reason(&e))
            })?;
            if !metadata.is_file() {
                return Err(no_file(&metadata));
            }
            let one = Stamp::of(&metadata);
            whole = Stamp { bytes: whole.bytes + one.bytes, modified: whole.modified.max(one.modified) };
        }
        Ok(whole)
    }

    /// Time of change, ns since 1970; 0 for an earlier one.
    pub fn modified_ns(self) -> u64 {
        let since = self.modified.duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        u64::try_from(since.as_nanos()).unwrap_or(u64::MAX)
    }
}

/// The reason why something that is no ordinary file is not read.
fn no_file(metadata: &Metadata) -> Note {
    if metadata.is_symlink() { "watch.link".into() } else { "watch.no_file".into() }
}

/// A file that a rule fits.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Found {
    /// Path below the folder, with `/` between its parts.
    pub name: String,
    /// The file.
    pub path: PathBuf,
    /// Position of the rule.
    pub rule: usize,
}

/// The files of a folder, both lists sorted by name.
pub struct Listing {
    /// Files that rules fit.
    pub files: Vec<Found>,
    /// Files that rules fit but that cannot be read, with the reasons.
    pub refused: Vec<(String, Note)>,
}

/// The files that rules fit and those that cannot be read.
///
/// Links are not followed, hidden files and folders are passed over.
///
/// # Errors
/// A note where the folder itself cannot be read.
pub fn found(folder: &Path, rules: &[WatchRule]) -> Result<Listing, Note> {
    let patterns: Vec<String> = rules.iter().map(|r| r.pattern.replace(SERIAL_PLACE, "*")).collect();
    let depth = patterns.iter().map(|p| p.matches('/').count()).max().unwrap_or(0);
    let (mut files, mut refused) = (vec![], vec![]);
    let mut open = vec![(folder.to_owned(), String::new(), 0)];
    while let Some((at, below, level)) = open.pop() {
        let entries = match fs::read_dir(&at) {
            Ok(entries) => entries,
            Err(e) if level == 0 => {
                return Err(note!(
                    "watch.no_folder",
                    path = at.display().to_string(),
                    reason = io_reason(&e)
                ));
            }
            Err(e) => {
                refused.push((
                    below,
                    note!("watch.unreadable", path = at.display().to_string(), reason = io_reason(&e)),
                ));
                continue;
            }
        };
        for entry in entries.flatten() {
            let Ok(last) = entry.file_name().into_string() else {
                refused.push((entry.file_name().to_string_lossy().into_owned(), "watch.name".into()));
                continue;
            };
            if last.starts_with('.') {
                continue;
            }
            let name = if below.is_empty() { last } else { format!("{below}/{last}") };
            let Ok(kind) = entry.file_type() else { continue };
            if kind.is_dir() {
                if level < depth {
                    open.push((entry.path(), name, level + 1));
                }
                continue;
            }
            let Some(rule) = patterns.iter().position(|pattern| fits(pattern, &name)) else { continue };
            if name.chars().any(char::is_control) {
                refused.push((name, "watch.name".into()));
            } else if !kind.is_file() {
                let why = if kind.is_symlink() { "watch.link" } else { "watch.no_file" };
                refused.push((name, why.into()));
            } else {
                files.push(Found { name, path: entry.path(), rule });
            }
        }
    }
    files.sort();
    refused.sort_by(|a, b| a.0.cmp(&b.0));
    Ok(Listing { files, refused })
}

/// How long files have stood still, as far as this process has seen.
#[derive(Debug, Default)]
pub struct Stillness {
    seen: BTreeMap<PathBuf, (Stamp, Instant)>,
}

impl Stillness {
    /// How long a file has had its stamp.
    pub fn since(&mut self, path: &Path, stamp: Stamp, now: Instant) -> Duration {
        let entry = self.seen.entry(path.to_owned()).or_insert((stamp, now));
        if entry.0 != stamp {
            *entry = (stamp, now);
        }
        now.saturating_duration_since(entry.1)
    }

    /// Forgets files that are not there any more.
    pub fn keep(&mut self, there: &BTreeSet<&Path>) {
        self.seen.retain(|path, _| there.contains(path.as_path()));
    }
}

/// How long a file has stood still by the clock of this computer, for a single look; `None` where it was changed in the future.
pub fn age(stamp: Stamp) -> Option<Duration> {
    SystemTime::now().duration_since(stamp.modified).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rule(pattern: &str) -> WatchRule {
        WatchRule { pattern: pattern.to_owned(), ..WatchRule::of_every_file("p.toml".into(), None) }
    }

    #[test]
    fn files_are_found_by_the_first_rule_that_fits() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["b.csv", "a.csv", "a.csv.done", ".hidden.csv"] {
            fs::write(folder.path().join(name), "x").unwrap();
        }
        fs::create_dir_all(folder.path().join("SN-1/deep")).unwrap();
        fs::write(folder.path().join("SN-1/a.csv"), "x").unwrap();
        fs::write(folder.path().join("SN-1/deep/a.csv"), "x").unwrap();
        #[cfg(unix)]
        std::os::unix::fs::symlink("a.csv", folder.path().join("link.csv")).unwrap();
        let rules = [rule("a.*"), rule("*.csv"), rule("{serial}/*.csv")];
        let Listing { files, refused } = found(folder.path(), &rules).unwrap();
        let found: Vec<(&str, usize)> = files.iter().map(|f| (f.name.as_str(), f.rule)).collect();
        assert_eq!(found, [("SN-1/a.csv", 2), ("a.csv", 0), ("a.csv.done", 0), ("b.csv", 1)]);
        let links: Vec<&str> = refused.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(links, if cfg!(unix) { vec!["link.csv"] } else { vec![] });
        assert!(super::found(&folder.path().join("none"), &rules).is_err());
    }

    #[test]
    fn a_file_stands_still_from_its_last_change() {
        let (mut seen, began) = (Stillness::default(), Instant::now());
        let stamp = Stamp { bytes: 1, modified: SystemTime::UNIX_EPOCH };
        let (path, later) = (Path::new("a"), |s| began + Duration::from_secs(s));
        assert_eq!(seen.since(path, stamp, began), Duration::ZERO);
        assert_eq!(seen.since(path, stamp, later(30)), Duration::from_secs(30));
        let grown = Stamp { bytes: 2, ..stamp };
        assert_eq!(seen.since(path, grown, later(40)), Duration::ZERO);
        assert_eq!(seen.since(path, grown, later(100)), Duration::from_secs(60));
        seen.keep(&BTreeSet::new());
        assert_eq!(seen.since(path, grown, later(101)), Duration::ZERO);
    }
}
