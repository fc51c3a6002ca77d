//! The files that a pattern of names matches.
//!
//! `**` goes into no folder by a link, and a folder that a link leads back to is not entered again: a walk ends.

use glob::{MatchOptions, Pattern};
use sagnac_core::message::Note;
use std::path::{Component, Path, PathBuf, is_separator};

/// Most entries of folders that are looked at.
const MAX_ENTRIES: usize = 1 << 20;

/// Why a file name pattern cannot be expanded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PatternError {
    /// It is no pattern.
    Bad(&'static str),
    /// It takes in more folders than are looked through.
    TooWide(usize),
}

impl PatternError {
    /// The error as a note, under the given keys for an invalid pattern and for one that matches too much.
    pub fn note(&self, bad: &'static str, wide: &'static str) -> Note {
        match self {
            PatternError::Bad(reason) => Note::new(bad).with("reason", *reason),
            PatternError::TooWide(most) => Note::new(wide).with("most", *most),
        }
    }
}

/// One piece of a pattern between separators.
enum Piece {
    /// A name as it is.
    Name(PathBuf),
    /// A pattern of names.
    Names(Pattern),
    /// Any number of folders.
    Folders,
}

/// True when a text is more than a name.
fn is_pattern(text: &str) -> bool {
    text.contains(['*', '?', '['])
}

/// The regular files that a pattern matches below `folder`, unsorted; the search ends once there are more than `most`.
pub fn files(folder: &Path, pattern: &str, most: usize) -> Result<Vec<PathBuf>, PatternError> {
    Pattern::new(pattern).map_err(|e| PatternError::Bad(e.msg))?;
    let (mut base, mut pieces) = (folder.to_owned(), Vec::new());
    for component in Path::new(pattern).components() {
        let text = component.as_os_str().to_str().unwrap_or_default();
        match component {
            Component::Normal(_) if text == "**" => pieces.push(Piece::Folders),
            Component::Normal(_) if is_pattern(text) => {
                pieces.push(Piece::Names(Pattern::new(text).map_err(|e| PatternError::Bad(e.msg))?));
            }
            _ if pieces.is_empty() => base.push(component),
            _ => pieces.push(Piece::Name(PathBuf::from(component.as_os_str()))),
        }
    }
    if matches!(pieces.last(), Some(Piece::Folders)) {
        pieces.push(Piece::Names(Pattern::new("*").map_err(|e| PatternError::Bad(e.msg))?));
    }
    if pattern.ends_with(is_separator) {
        return Ok(vec![]);
    }
    let mut walk = Walk { found: Vec::new(), most, entries: 0 };
    walk.go(base, &pieces, &mut Vec::new())?;
    walk.found.sort();
    walk.found.dedup();
    Ok(walk.found)
}

struct Walk {
    found: Vec<PathBuf>,
    most: usize,
    entries: usize,
}

impl Walk {
    /// Follows the pieces from a path. `above` holds the folders on the way, as they really are.
    fn go(&mut self, at: PathBuf, pieces: &[Piece], above: &mut Vec<PathBuf>) -> Result<(), PatternError> {
        if self.found.len() > self.most {
            return Ok(());
        }
        let Some((piece, rest)) = pieces.split_first() else {
            if at.is_file() {
                self.found.push(at);
            }
            return Ok(());
        };
        match piece {
            Piece::Name(name) => self.go(at.join(name), rest, above),
            Piece::Names(_) | Piece::Folders => self.enter(&at, piece, pieces, rest, above),
        }
    }

    fn enter(
        &mut self,
        at: &Path,
        piece: &Piece,
        pieces: &[Piece],
        rest: &[Piece],
        above: &mut Vec<PathBuf>,
    ) -> Result<(), PatternError> {
        let folder = if at.as_os_str().is_empty() { Path::new(".") } else { at };
        let Ok(real) = folder.canonicalize() else { return Ok(()) };
        if above.contains(&real) {
            return Ok(());
        }
        if matches!(piece, Piece::Folders) {
            self.go(at.to_owned(), rest, above)?;
        }
        let Ok(entries) = std::fs::read_dir(folder) else { return Ok(()) };
        above.push(real);
        for entry in entries.flatten() {
            self.entries += 1;
            if self.entries > MAX_ENTRIES {
                return Err(PatternError::TooWide(MAX_ENTRIES));
            }
            let name = entry.file_name();
            let next = at.join(&name);
            match piece {
                Piece::Names(wanted) => {
                    let fits = name.to_str().is_some_and(|n| wanted.matches_with(n, MatchOptions::new()));
                    if fits {
                        self.go(next, rest, above)?;
                    }
                }
                _ => {
                    if entry.file_type().is_ok_and(|t| t.is_dir()) {
                        self.go(next, pieces, above)?;
                    }
                }
            }
        }
        above.pop();
        Ok(())
    }
}

/// A sort key by which `part2` comes before `part10`.
pub fn natural(name: &str) -> Vec<(String, u128, String)> {
    let mut key = Vec::new();
    // Without what follows the first dot of the name, so that part.csv comes before part1.csv.
    let file = name.rfind('/').map_or(0, |slash| slash + 1);
    let dot = name.get(file..).and_then(|n| n.find('.')).map_or(name.len(), |dot| file + dot);
    let (mut rest, extension) = name.split_at(dot);
    while !rest.is_empty() {
        let words = rest.find(|c: char| c.is_ascii_digit()).unwrap_or(rest.len());
        let (word, after) = rest.split_at(words);
        let length = after.find(|c: char| !c.is_ascii_digit()).unwrap_or(after.len());
        let (digits, after) = after.split_at(length);
        // Numbers of more than 38 digits sort as text.
        let value = digits.parse().unwrap_or(if digits.is_empty() { 0 } else { u128::MAX });
        key.push((word.to_owned(), value, digits.to_owned()));
        rest = after;
    }
    key.push((extension.to_owned(), 0, String::new()));
    key
}

#[cfg(test)]
mod tests {
    use super::*;
    use tempfile::tempdir;

    fn names(folder: &Path, pattern: &str) -> Vec<String> {
        let shown = |p: PathBuf| p.strip_prefix(folder).unwrap().to_string_lossy().replace('\\', "/");
        files(folder, pattern, 1000).unwrap().into_iter().map(shown).collect()
    }

    fn tree() -> tempfile::TempDir {
        let dir = tempdir().unwrap();
        for name in ["a1.csv", "a2.csv", "b.txt", "x/a3.csv", "x/y/a4.csv", "x/y/c.txt"] {
            let path = dir.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, "1").unwrap();
        }
        dir
    }

    #[test]
    fn patterns_match_names_piece_by_piece() {
        let dir = tree();
        for (pattern, wanted) in [
            ("a*.csv", &["a1.csv", "a2.csv"][..]),
            ("a[!2].csv", &["a1.csv"]),
            ("?.txt", &["b.txt"]),
            ("*/*.csv", &["x/a3.csv"]),
            ("**/*.csv", &["a1.csv", "a2.csv", "x/a3.csv", "x/y/a4.csv"]),
            ("x/**/*.csv", &["x/a3.csv", "x/y/a4.csv"]),
            ("x/**", &["x/a3.csv", "x/y/a4.csv", "x/y/c.txt"]),
            ("*/y/a4.csv", &["x/y/a4.csv"]),
            ("none*/a.csv", &[]),
            ("x", &[]),
        ] {
            assert_eq!(names(dir.path(), pattern), wanted, "{pattern}");
        }
        assert!(matches!(files(dir.path(), "a**b", 10), Err(PatternError::Bad(_))));
        assert_eq!(files(dir.path(), "**/*", 2).unwrap().len(), 3);
    }

    #[cfg(unix)]
    #[test]
    fn links_in_circles_end() {
        let dir = tree();
        for name in ["x/up", "x/y/up", "x/y/upper", "x/twin"] {
            std::os::unix::fs::symlink(dir.path(), dir.path().join(name)).unwrap();
        }
        let started = std::time::Instant::now();
        assert_eq!(names(dir.path(), "**/*.csv"), ["a1.csv", "a2.csv", "x/a3.csv", "x/y/a4.csv"]);
        assert!(names(dir.path(), "*/*/*/*/*/*/*/*/*/*/*/*/*/*/*/*/*.csv").is_empty());
        assert!(started.elapsed().as_secs() < 5);
        // A folder that is a link is looked into by its name, and by `*` once.
        assert_eq!(names(dir.path(), "x/up/a1.csv"), ["x/up/a1.csv"]);
    }

    #[test]
    fn numbers_in_names_sort_by_value() {
        let mut names = ["part10.csv", "part2.csv", "part1.csv", "part02.csv", "a.csv", "part.csv"];
        names.sort_by_cached_key(|n| natural(n));
        assert_eq!(names, ["a.csv", "part.csv", "part1.csv", "part02.csv", "part2.csv", "part10.csv"]);
    }
}
