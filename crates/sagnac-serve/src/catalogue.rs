//! Procedures and limits that may be chosen: those that the program carries, and files of the configured folders.

use crate::recordings::Roots;
use crate::setup::{Rule, Shipped};
use std::path::{Path, PathBuf};

/// Most own files that are listed.
const MAX_LISTED: usize = 500;
/// Ending of their names.
const ENDING: &str = ".toml";

/// Procedures, limits and the rules that choose them.
#[derive(Debug, Clone, Default)]
pub struct Catalogue {
    /// What the program carries.
    pub shipped: Shipped,
    /// Own files.
    pub own: Roots,
    /// Tests by part number.
    pub rules: Vec<Rule>,
}

impl Catalogue {
    /// The procedure of a name.
    pub fn procedure(&self, name: &str) -> Option<PathBuf> {
        self.find(name, &self.shipped.procedures)
    }

    /// The limits of a name.
    pub fn limits(&self, name: &str) -> Option<PathBuf> {
        self.find(name, &self.shipped.limits)
    }

    fn find(&self, name: &str, shipped: &[String]) -> Option<PathBuf> {
        if shipped.iter().any(|known| known == name) {
            return Some(PathBuf::from(name));
        }
        let stated = self.rules.iter().flat_map(|rule| [Some(&rule.procedure), rule.limits.as_ref()]);
        if stated.flatten().any(|stated| stated == name) {
            return Some(PathBuf::from(name));
        }
        self.own.resolve(name).ok().filter(|path| path.extension().is_some_and(|e| e == "toml"))
    }

    /// The name of a procedure or of limits, as it is offered; the path of one that a rule names.
    pub fn name(&self, path: &Path) -> String {
        self.own.name_of(path).unwrap_or_else(|| path.to_string_lossy().into_owned())
    }

    /// The test of a part number.
    pub fn of_part(&self, part: &str) -> Option<&Rule> {
        self.rules.iter().find(|rule| fits(&rule.part, part))
    }

    /// Names of own procedures and limits, in their order.
    pub fn own_files(&self) -> Vec<String> {
        let files = self.own.newest(MAX_LISTED).into_iter().map(|found| found.name);
        let mut names: Vec<String> = files.filter(|name| name.ends_with(ENDING)).collect();
        names.sort();
        names
    }
}

/// True where a pattern fits the whole of a text.
fn fits(pattern: &str, text: &str) -> bool {
    let pattern: Vec<char> = pattern.chars().collect();
    let text: Vec<char> = text.chars().collect();
    // Whether the pattern so far fits the first characters of the text, by their number.
    let mut reached = vec![false; text.len() + 1];
    if let Some(start) = reached.first_mut() {
        *start = true;
    }
    for sign in pattern {
        let mut next = vec![false; text.len() + 1];
        for at in 0..=text.len() {
            let before = at.checked_sub(1);
            let last = before.and_then(|i| text.get(i));
            let came = |row: &[bool], i: Option<usize>| i.and_then(|i| row.get(i)).copied().unwrap_or(false);
            let fits = match sign {
                '*' => came(&reached, Some(at)) || came(&next, before),
                '?' => last.is_some() && came(&reached, before),
                sign => last == Some(&sign) && came(&reached, before),
            };
            if let Some(slot) = next.get_mut(at) {
                *slot = fits;
            }
        }
        reached = next;
    }
    reached.last().copied().unwrap_or(false)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pattern_fits_the_whole_of_a_part_number() {
        for (pattern, part) in
            [("OIUS-*", "OIUS-501"), ("*", ""), ("A?C", "ABC"), ("*-R2", "A-R2-R2"), ("A", "A")]
        {
            assert!(fits(pattern, part), "{pattern} {part}");
        }
        for (pattern, part) in [("OIUS-*", "XOIUS-1"), ("A?", "A"), ("A", "AB"), ("", "A"), ("*a*b", "abc")] {
            assert!(!fits(pattern, part), "{pattern} {part}");
        }
        assert!(!fits(&"*a".repeat(200), &"a".repeat(190)));
    }

    #[test]
    fn only_what_is_offered_can_be_chosen() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("mine.toml"), "").unwrap();
        std::fs::write(folder.path().join("mine.csv"), "").unwrap();
        let shipped = Shipped { procedures: vec!["static-bias".to_owned()], limits: vec!["unit".to_owned()] };
        let own = Roots::new(&[folder.path().to_owned()]).unwrap();
        let catalogue = Catalogue { shipped, own, rules: vec![] };
        assert_eq!(catalogue.procedure("static-bias"), Some("static-bias".into()));
        assert!(catalogue.procedure("mine.toml").unwrap().is_absolute());
        for name in ["unit", "mine.csv", "/etc/hosts", "../x.toml", "--help", ""] {
            assert_eq!(catalogue.procedure(name), None, "{name}");
        }
    }
}
