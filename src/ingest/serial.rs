//! Serial numbers: one number written in several ways, and the part of a file name that is one.

use crate::i18n::{Note, note};
use std::path::{Component, Path};

/// A serial number without what is written before it, and without punctuation, case and leading zeros: `S/N 0043` and
/// `sn-43` are one unit.
pub fn plain(serial: &str) -> String {
    let upper = serial.trim().to_uppercase();
    let bare = ["S/N", "SN", "№", "NO.", "ЗАВ."].iter().find_map(|p| upper.strip_prefix(p)).unwrap_or(&upper);
    let groups = bare.split(|c: char| !c.is_alphanumeric()).filter(|g| !g.is_empty());
    let without = |g: &str| {
        let rest = g.trim_start_matches('0');
        if rest.is_empty() { "0".to_owned() } else { rest.to_owned() }
    };
    groups.map(without).collect::<Vec<_>>().join("-")
}

/// The name of a file without its endings: `unit-7` of `lot/unit-7.csv.gz`.
pub fn stem(path: &Path) -> String {
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let packed = [".gz", ".zst", ".bz2", ".xz"];
    let bare = packed.iter().find_map(|e| name.strip_suffix(e)).unwrap_or(&name);
    match bare.rsplit_once('.') {
        Some((stem, _)) if !stem.is_empty() => stem.to_owned(),
        _ => bare.to_owned(),
    }
}

/// A file name in which one part is the serial number: `unit-{serial}_*`.
///
/// `{serial}` stands for the serial number, `*` for any characters, `?` for a single one. The pattern is compared with
/// the name without its endings, and where that does not match, with the whole name. With a `/` in it, it is compared
/// with as many folders before the name as it has: `{serial}/*`. `{stem}` is the whole name without its endings.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SerialPattern {
    text: String,
    before: Vec<Token>,
    after: Vec<Token>,
    folders: usize,
}

/// What one place of a pattern matches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Token {
    Exactly(char),
    One,
    Any,
}

/// Place of the serial number in a pattern.
const SERIAL_PLACE: &str = "{serial}";
/// The whole name without its endings.
const STEM_PLACE: &str = "{stem}";

impl SerialPattern {
    /// Reads a pattern.
    ///
    /// # Errors
    /// A note that says what is wrong with it.
    pub fn parse(text: &str) -> Result<SerialPattern, Note> {
        let wrong = || note!("lot.pattern", given = text);
        let whole = text.replace(STEM_PLACE, SERIAL_PLACE);
        let (before, after) = whole.split_once(SERIAL_PLACE).ok_or_else(wrong)?;
        let braces = |part: &str| part.contains(['{', '}']);
        if braces(before) || braces(after) || (text.contains(STEM_PLACE) && text != STEM_PLACE) {
            return Err(wrong());
        }
        let tokens = |part: &str| part.chars().map(token).collect();
        let folders = whole.matches('/').count();
        Ok(SerialPattern { text: text.to_owned(), before: tokens(before), after: tokens(after), folders })
    }

    /// The serial number in the name of a file.
    ///
    /// # Errors
    /// A note that names the file where the pattern does not match it, or matches in more than one way.
    pub fn serial_of(&self, path: &Path) -> Result<String, Note> {
        let note = |key: &'static str| {
            Note::new(key).with("path", path.display().to_string()).with("pattern", self.text.as_str())
        };
        let mut folders: Vec<String> = path
            .parent()
            .into_iter()
            .flat_map(Path::components)
            .filter_map(|c| match c {
                Component::Normal(name) => Some(name.to_string_lossy().into_owned()),
                _ => None,
            })
            .collect();
        let folders = folders.split_off(folders.len().saturating_sub(self.folders));
        let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        for last in [stem(path), name] {
            let name: Vec<String> = folders.iter().cloned().chain([last]).collect();
            let found = self.captures(&name.join("/").chars().collect::<Vec<_>>());
            match found.as_slice() {
                [] => {}
                [one] => return Ok(one.clone()),
                [first, rest @ ..] => {
                    let last = rest.last().unwrap_or(first).clone();
                    return Err(note("lot.pattern_ambiguous")
                        .with("one", first.as_str())
                        .with("other", last));
                }
            }
        }
        Err(note("lot.pattern_no_match").with("stem", stem(path)))
    }

    /// Every serial number that the pattern can select from a name, each once, the shortest first.
    fn captures(&self, name: &[char]) -> Vec<String> {
        let ends_of_before = reached(&self.before, name);
        let mut reversed: Vec<char> = name.to_vec();
        reversed.reverse();
        let mut after = self.after.clone();
        after.reverse();
        let lengths_of_after = reached(&after, &reversed);
        let mut found: Vec<String> = vec![];
        for from in (0..=name.len()).filter(|i| ends_of_before.get(*i) == Some(&true)) {
            for to in (from + 1..=name.len()).filter(|i| lengths_of_after.get(name.len() - i) == Some(&true))
            {
                let serial: String = name.get(from..to).unwrap_or_default().iter().collect();
                let serial = serial.trim().to_owned();
                if !serial.is_empty() && !serial.contains('/') && !found.contains(&serial) {
                    found.push(serial);
                }
            }
        }
        found.sort_by_key(|s| s.chars().count());
        found
    }
}

/// True where a pattern of `*` and `?` fits a whole path. Neither of them fits a `/`.
pub fn fits(pattern: &str, path: &str) -> bool {
    let tokens: Vec<Token> = pattern.chars().map(token).collect();
    reached(&tokens, &path.chars().collect::<Vec<_>>()).last() == Some(&true)
}

fn token(c: char) -> Token {
    match c {
        '*' => Token::Any,
        '?' => Token::One,
        c => Token::Exactly(c),
    }
}

/// For each length of a beginning of the name, whether the tokens match it. `*` and `?` do not match a `/`.
fn reached(tokens: &[Token], name: &[char]) -> Vec<bool> {
    let mut at = vec![false; name.len() + 1];
    if let Some(first) = at.first_mut() {
        *first = true;
    }
    for token in tokens {
        let mut next = vec![false; name.len() + 1];
        for i in 0..=name.len() {
            let before = i.checked_sub(1).and_then(|b| Some((b, *name.get(b)?)));
            let here = match (token, before) {
                (Token::Any, Some((b, c))) => at[i] || (next[b] && c != '/'),
                (Token::Any, None) => at[i],
                (Token::One, Some((b, c))) => at[b] && c != '/',
                (Token::Exactly(wanted), Some((b, c))) => at[b] && c == *wanted,
                (_, None) => false,
            };
            next[i] = here;
        }
        at = next;
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_unit_written_in_several_ways_is_one() {
        for same in ["SN-0043", "sn-43", "S/N 0043", "0043", " 43 ", "№ 43"] {
            assert_eq!(plain(same), "43", "{same}");
        }
        for other in ["SN-0034", "430", "43-1", "A43", ""] {
            assert_ne!(plain(other), "43", "{other}");
        }
        assert_ne!(plain("0"), plain(""));
        assert_ne!(plain("4-3"), plain("43"));
    }

    #[test]
    fn a_pattern_fits_a_whole_path() {
        for (pattern, path, expected) in [
            ("*", "a.csv", true),
            ("*", "a/b.csv", false),
            ("*/*.csv", "a/b.csv", true),
            ("?.csv", "ab.csv", false),
            ("*.csv", "a.csv.done", false),
        ] {
            assert_eq!(fits(pattern, path), expected, "{pattern} {path}");
        }
    }

    #[test]
    fn a_name_loses_its_endings() {
        for (path, name) in [
            ("lot/unit-7.csv.gz", "unit-7"),
            ("v1.2.csv", "v1.2"),
            ("plain", "plain"),
            (".csv", ".csv"),
            ("a.gz", "a"),
        ] {
            assert_eq!(stem(Path::new(path)), name);
        }
    }

    #[test]
    fn the_part_of_the_name_that_a_pattern_selects() {
        for (pattern, path, serial) in [
            ("{stem}", "lot/unit-7.csv.gz", "unit-7"),
            ("{serial}", "lot/unit-7.csv", "unit-7"),
            ("unit-{serial}", "lot/unit-7.csv", "7"),
            ("unit-{serial}.csv", "lot/unit-7.csv", "7"),
            ("{serial}_*", "SN12_25C.csv", "SN12"),
            ("*_{serial}_*", "20261125_SN12_25C.csv", "SN12"),
            ("????????_{serial}_*", "20261125_SN12_25C.csv", "SN12"),
            ("{serial}/*", "lot/SN-7/static.csv", "SN-7"),
            ("{serial}/*/*", "/data/SN-7/25C/static.csv", "SN-7"),
            ("блок{serial}", "блок17.csv", "17"),
        ] {
            let found = SerialPattern::parse(pattern).unwrap().serial_of(Path::new(path));
            assert_eq!(found.unwrap(), serial, "{pattern} {path}");
        }
    }

    #[test]
    fn what_does_not_match_or_matches_in_two_ways_is_refused() {
        let error = |pattern: &str, path: &str| {
            SerialPattern::parse(pattern).unwrap().serial_of(Path::new(path)).unwrap_err().id.into_owned()
        };
        assert_eq!(error("SN{serial}", "unit-7.csv"), "lot.pattern_no_match");
        assert_eq!(error("{serial}_*", "SN_12_25C.csv"), "lot.pattern_ambiguous");
        assert_eq!(error("{serial}*", "SN12.csv"), "lot.pattern_ambiguous");
        assert_eq!(error("{serial}/*", "static.csv"), "lot.pattern_no_match");
        for wrong in ["", "SN*", "{serial}{serial}", "x{stem}", "{name}", "{serial}}"] {
            assert_eq!(SerialPattern::parse(wrong).unwrap_err().id, "lot.pattern", "{wrong}");
        }
    }
}
