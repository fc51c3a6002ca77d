//! Recordings that may be read: files below the configured folders, wherever a path or a link seems to lead.

use std::ffi::OsStr;
use std::io::Result;
use std::path::{Component, Path, PathBuf};
use std::time::SystemTime;

/// Deepest folder that is listed.
const MAX_DEPTH: usize = 6;
/// Most entries that are looked at for a list.
const MAX_ENTRIES: usize = 20_000;

/// Folders with recordings, where they really are.
#[derive(Debug, Clone, Default)]
pub struct Roots(Vec<PathBuf>);

/// A recording that was found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Found {
    /// Name: that of its folder, and the path below it.
    pub name: String,
    /// Size, bytes.
    pub bytes: u64,
    /// Time of change.
    pub modified: SystemTime,
}

/// Why a name is none of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NotFound {
    /// No file.
    Missing,
    /// Outside of the folders.
    Outside,
}

impl Roots {
    /// Folders as they were named.
    ///
    /// # Errors
    /// The first one that cannot be opened.
    pub fn new(folders: &[PathBuf]) -> std::result::Result<Roots, (PathBuf, std::io::Error)> {
        let real = |folder: &PathBuf| -> Result<PathBuf> {
            let real = folder.canonicalize()?;
            if real.is_dir() { Ok(real) } else { Err(std::io::ErrorKind::NotADirectory.into()) }
        };
        let mut roots = vec![];
        for folder in folders {
            let real = real(folder).map_err(|e| (folder.clone(), e))?;
            if !roots.contains(&real) {
                roots.push(real);
            }
        }
        Ok(Roots(roots))
    }

    /// The file of a name: an absolute path, a path below a folder, or one that begins with the name of a folder.
    ///
    /// # Errors
    /// No file, or one that is really elsewhere.
    pub fn resolve(&self, name: &str) -> std::result::Result<PathBuf, NotFound> {
        let path = Path::new(name);
        if path.is_absolute() {
            return self.inside(path);
        }
        let is_plain = |part: Component<'_>| matches!(part, Component::Normal(_));
        if name.is_empty() || !path.components().all(is_plain) {
            return Err(NotFound::Outside);
        }
        let mut outside = false;
        let named = self.0.iter().filter_map(|root| Some((root, path.strip_prefix(root.file_name()?).ok()?)));
        let plain = self.0.iter().map(|root| (root, path));
        for (root, below) in named.chain(plain) {
            match self.inside(&root.join(below)) {
                Ok(path) => return Ok(path),
                Err(why) => outside |= why == NotFound::Outside,
            }
        }
        Err(if outside { NotFound::Outside } else { NotFound::Missing })
    }

    /// The name of a file below the folders, as [`Roots::newest`] names it.
    pub fn name_of(&self, path: &Path) -> Option<String> {
        self.0.iter().find_map(|root| {
            let below = path.strip_prefix(root).ok()?;
            Some(Path::new(root.file_name()?).join(below).to_string_lossy().into_owned())
        })
    }

    fn inside(&self, path: &Path) -> std::result::Result<PathBuf, NotFound> {
        // Nothing is told of a file that lies elsewhere, not even whether it is there.
        let Ok(real) = path.canonicalize() else {
            return Err(if self.holds(path) { NotFound::Missing } else { NotFound::Outside });
        };
        if !self.holds(&real) {
            return Err(NotFound::Outside);
        }
        if real.is_file() { Ok(real) } else { Err(NotFound::Missing) }
    }

    fn holds(&self, path: &Path) -> bool {
        let climbs = path.components().any(|part| part == Component::ParentDir);
        !climbs && self.0.iter().any(|root| path.starts_with(root))
    }

    /// The recordings that changed last, the newest first, at the most so many. Hidden files, links and markers are left out.
    pub fn newest(&self, most: usize) -> Vec<Found> {
        let mut found = vec![];
        let mut left = MAX_ENTRIES;
        for root in &self.0 {
            let name = root.file_name().unwrap_or(OsStr::new("")).to_string_lossy().into_owned();
            collect(root, &name, MAX_DEPTH, &mut left, &mut found);
        }
        found.sort_by(|a, b| b.modified.cmp(&a.modified).then_with(|| a.name.cmp(&b.name)));
        found.truncate(most);
        found
    }

    /// The newest recording whose file name has a serial number in it as a whole.
    pub fn of_serial(&self, serial: &str) -> Option<Found> {
        self.newest(MAX_ENTRIES).into_iter().find(|found| {
            let file = found.name.rsplit('/').next().unwrap_or_default();
            names(file, serial)
        })
    }
}

fn collect(folder: &Path, name: &str, depth: usize, left: &mut usize, found: &mut Vec<Found>) {
    let Ok(entries) = folder.read_dir() else { return };
    for entry in entries.flatten() {
        if *left == 0 {
            return;
        }
        *left -= 1;
        let file = entry.file_name().to_string_lossy().into_owned();
        // Of a link, this is the type of the link itself.
        let Ok(kind) = entry.file_type() else { continue };
        if file.starts_with('.') || file.ends_with(".done") {
            continue;
        }
        let name = format!("{name}/{file}");
        if kind.is_dir() && depth > 0 {
            collect(&entry.path(), &name, depth - 1, left, found);
        } else if kind.is_file()
            && let Ok(data) = entry.metadata()
            && let Ok(modified) = data.modified()
        {
            found.push(Found { name, bytes: data.len(), modified });
        }
    }
}

/// True where a serial number stands in a name, and neither a letter nor a digit beside it.
fn names(file: &str, serial: &str) -> bool {
    let borders = |c: Option<char>| c.is_none_or(|c| !c.is_alphanumeric());
    !serial.is_empty()
        && file.match_indices(serial).any(|(at, _)| {
            let (before, rest) = file.split_at(at);
            borders(before.chars().next_back())
                && borders(rest.strip_prefix(serial).unwrap_or_default().chars().next())
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_really_lies_below_a_folder_is_found() {
        let outer = tempfile::tempdir().unwrap();
        let root = outer.path().join("bench");
        std::fs::create_dir_all(root.join("deep")).unwrap();
        for file in ["secret.csv", "bench/a.csv", "bench/deep/b.csv", "bench/.hidden"] {
            std::fs::write(outer.path().join(file), "x").unwrap();
        }
        let roots = Roots::new(std::slice::from_ref(&root)).unwrap();
        let real = root.canonicalize().unwrap();
        for name in ["a.csv", "bench/a.csv", real.join("a.csv").to_str().unwrap()] {
            assert_eq!(roots.resolve(name), Ok(real.join("a.csv")), "{name}");
        }
        assert_eq!(roots.resolve("bench/deep/b.csv"), Ok(real.join("deep/b.csv")));
        let climbing = format!("{}/../secret.csv", real.display());
        for name in
            ["../secret.csv", "bench/../../secret.csv", "/etc/passwd", "/etc/none", &climbing, "", "./a.csv"]
        {
            assert_eq!(roots.resolve(name), Err(NotFound::Outside), "{name}");
        }
        for name in ["none.csv", "deep", "bench", "a.csv/b"] {
            assert_eq!(roots.resolve(name), Err(NotFound::Missing), "{name}");
        }
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(outer.path().join("secret.csv"), root.join("link.csv")).unwrap();
            std::os::unix::fs::symlink(outer.path(), root.join("out")).unwrap();
            assert_eq!(roots.resolve("link.csv"), Err(NotFound::Outside));
            assert_eq!(roots.resolve("out/secret.csv"), Err(NotFound::Outside));
        }
        assert_eq!(roots.name_of(&real.join("deep/b.csv")).as_deref(), Some("bench/deep/b.csv"));
        let names: Vec<String> = roots.newest(10).into_iter().map(|f| f.name).collect();
        assert_eq!(names.len(), 2, "{names:?}");
        assert!(Roots::new(&[root.join("none")]).is_err());
    }

    #[test]
    fn a_serial_number_stands_alone_in_a_name() {
        assert!(names("20270301_SN-1_static.csv", "SN-1") && names("SN-1.csv", "SN-1"));
        assert!(!names("SN-12.csv", "SN-1") && !names("XSN-1.csv", "SN-1") && !names("a.csv", ""));
        assert!(names("SN-12_SN-1.csv", "SN-1"));
    }
}
