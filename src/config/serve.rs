//! Rules of a bench: which part number is tested by what.

use super::contained_files::{folder_of, joined};
use super::diagnostics::Problems;
use super::read_tables::checked;
use super::reader::Reader;
use super::section::Section;
use super::shipped;
use super::spec::TableSpec;
use super::table::Table;
use super::text_file::{self, Wording};
use crate::i18n::note;
use std::path::Path;

/// Messages for a file of rules that cannot be read at all.
const WORDING: Wording = Wording { unreadable: "serve_file.unreadable", folder: "serve_file.folder" };

/// A file of rules of a bench as a whole.
pub static SERVE_FILE: TableSpec = *ServeTables::SPEC;

/// Rules of a bench: `sagnac serve` tests each part number by its procedure.
#[derive(Table)]
#[table("", format = "serve/1")]
struct ServeTables {
    /// The rules, one table each. The first whose pattern fits a part number holds for it.
    #[key(name = "rule", required)]
    rules: Vec<PartKeys>,
}

/// Part numbers that are tested alike.
#[derive(Table)]
#[table("rule")]
struct PartKeys {
    /// Pattern of the part number: `*` is any characters, `?` a single one.
    #[key(example = "OIUS-501-*")]
    part: String,
    /// Procedure: a file relative to this one, or the name of a shipped one.
    #[key(example = "static-bias")]
    procedure: String,
    /// Limits: a file relative to this one, or the name of a shipped one.
    #[key(example = "sample-unit")]
    limits: Option<String>,
    #[key(section)]
    section: Section,
}

/// A rule: a part number and its test.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PartRule {
    /// Pattern of the part number.
    pub part: String,
    /// Procedure: an absolute path, or the name of a shipped one.
    pub procedure: String,
    /// Limits, as the procedure.
    pub limits: Option<String>,
}

/// Reads a file of rules.
///
/// # Errors
/// Every problem of the file, each with its place.
pub fn load(path: &Path) -> Result<Vec<PartRule>, Problems> {
    parse(&path.display().to_string(), &text_file::bytes(path, &WORDING)?, folder_of(path))
}

/// Reads rules from the bytes of a file; `name` stands in diagnostics, files are named relative to `folder`.
///
/// # Errors
/// Every problem of the text.
pub fn parse(name: &str, bytes: &[u8], folder: &Path) -> Result<Vec<PartRule>, Problems> {
    let build = |root: &Section, reader: &mut Reader<'_>| {
        let ServeTables { rules } = ServeTables::read(root);
        rules.into_iter().map(|keys| rule(keys, folder, reader)).collect()
    };
    let (rules, problems) = checked(&text_file::source(name, bytes)?, &SERVE_FILE, build);
    rules.ok_or(problems)
}

fn rule(keys: PartKeys, folder: &Path, reader: &mut Reader<'_>) -> PartRule {
    let section = &keys.section;
    let mut file = |key: &'static str, text: &str| {
        if let Ok(path) = joined(folder, text).canonicalize()
            && path.is_file()
        {
            return path.display().to_string();
        }
        if shipped::find(Path::new(text)).is_none() {
            let message = note!("watch_file.missing", path = text);
            reader.error(&section.span_of(key), message, Some("watch_file.help.missing".into()));
        }
        text.to_owned()
    };
    let procedure =
        if keys.procedure.is_empty() { String::new() } else { file("procedure", &keys.procedure) };
    let limits = keys.limits.as_deref().map(|text| file("limits", text));
    PartRule { procedure, limits, part: keys.part }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<PartRule>, Problems> {
        parse("serve.toml", text.as_bytes(), Path::new("procedures"))
    }

    #[test]
    fn files_beside_the_rules_and_shipped_ones_are_found() {
        let text = "format = \"serve/1\"\n[[rule]]\npart = \"A-*\"\nprocedure = \"warm-up.toml\"\n\
                    [[rule]]\npart = \"*\"\nprocedure = \"static-bias\"\nlimits = \"sample-unit\"\n";
        let rules = read(text).unwrap_or_else(|e| panic!("{e}"));
        let [first, second] = rules.as_slice() else { panic!("{rules:?}") };
        assert!(Path::new(&first.procedure).is_absolute() && first.limits.is_none());
        assert_eq!(
            (second.procedure.as_str(), second.limits.as_deref()),
            ("static-bias", Some("sample-unit"))
        );
    }

    #[test]
    fn a_mistake_is_told_once_at_its_place() {
        let rule = "format = \"serve/1\"\n[[rule]]\npart = \"A-*\"\nprocedure = \"static-bias\"\n";
        for (from, to, line) in [
            ("\"A-*\"", "\" \"", 3),
            ("\"A-*\"", "7", 3),
            ("static-bias", "nowhere.toml", 4),
            ("\"static-bias\"", "\"static-bias\"\nlimit = \"a\"", 5),
            ("\"static-bias\"", "\"static-bias\"\nlimits = \"nowhere\"", 5),
        ] {
            let problems = read(&rule.replace(from, to)).unwrap_err();
            let lines: Vec<usize> = problems.list.iter().map(|p| p.line).collect();
            assert_eq!(lines, [line], "{to}: {problems}");
        }
        assert!(read(rule).is_ok());
    }
}
