//! Watch rules from a TOML file, with every problem at its place.

use super::rules::{SERIAL_PLACE, WatchRule, WatchRules};
use super::tables::{RuleKeys, WATCH_FILE, WatchTables};

use crate::config::contained_files::{folder_of, joined};
use crate::config::diagnostics::Problems;
use crate::config::read_tables::checked;
use crate::config::reader::Reader;
use crate::config::section::Section;
use crate::config::shipped;
use crate::config::table::Table;
use crate::config::text_file::{self, Wording};
use crate::i18n::note;
use std::path::{Component, Path, PathBuf};
use std::time::Duration;

/// Messages for a file of rules that cannot be read at all.
const WORDING: Wording = Wording { unreadable: "watch_file.unreadable", folder: "watch_file.folder" };

/// Reads a file of rules.
///
/// # Errors
/// Every problem of the file, each with its place.
pub fn load(path: &Path) -> Result<WatchRules, Problems> {
    parse(&path.display().to_string(), &text_file::bytes(path, &WORDING)?, folder_of(path))
}

/// Reads rules from the bytes of a file; `name` stands in diagnostics, files are named relative to `folder`.
///
/// # Errors
/// Every problem of the text.
pub fn parse(name: &str, bytes: &[u8], folder: &Path) -> Result<WatchRules, Problems> {
    let build = |root: &Section, reader: &mut Reader<'_>| {
        let WatchTables { poll_s, rules } = WatchTables::read(root);
        let rules = rules.into_iter().map(|keys| rule(keys, folder, reader)).collect();
        WatchRules { poll: seconds(poll_s), rules }
    };
    let (rules, problems) = checked(&text_file::source(name, bytes)?, &WATCH_FILE, build);
    rules.ok_or(problems)
}

/// A length of time; zero for one that was refused.
fn seconds(seconds: f64) -> Duration {
    Duration::try_from_secs_f64(seconds).unwrap_or_default()
}

fn rule(keys: RuleKeys, folder: &Path, reader: &mut Reader<'_>) -> WatchRule {
    let section = &keys.section;
    if section.entry("pattern").is_some() && !is_pattern(&keys.pattern) {
        let message = note!("watch_file.pattern", given = keys.pattern.as_str());
        reader.error(&section.span_of("pattern"), message, Some("watch_file.help.pattern".into()));
    }
    if keys.serial_column.is_some() && keys.pattern.contains(SERIAL_PLACE) {
        let help = Some("watch_file.help.two_serials".into());
        reader.error(&section.span_of("serial_column"), note!("watch_file.two_serials"), help);
    }
    if keys.marker.contains(['/', '\\']) {
        let message = note!("watch_file.marker", given = keys.marker.as_str());
        reader.error(&section.span_of("marker"), message, Some("watch_file.help.marker".into()));
    }
    let mut file = |key: &'static str, text: &str| {
        let path = joined(folder, text);
        if path.is_file() {
            return path;
        }
        if shipped::find(Path::new(text)).is_none() {
            let message = note!("watch_file.missing", path = text);
            reader.error(&section.span_of(key), message, Some("watch_file.help.missing".into()));
        }
        PathBuf::from(text)
    };
    let procedure =
        if keys.procedure.is_empty() { PathBuf::new() } else { file("procedure", &keys.procedure) };
    let limits = keys.limits.as_deref().map(|text| file("limits", text));
    WatchRule {
        procedure,
        limits,
        pattern: keys.pattern,
        serial_column: keys.serial_column,
        complete: keys.complete,
        marker: keys.marker,
        after: seconds(keys.after_s),
        store: keys.store.map(|text| joined(folder, &text)),
        unit_data: keys.unit_data.map(|text| joined(folder, &text)),
        station: keys.station,
        hook: keys.hook,
    }
}

/// True for a pattern of paths below a folder: plain names, in which one place may be that of the serial number.
fn is_pattern(text: &str) -> bool {
    let rest = text.replacen(SERIAL_PLACE, "", 1);
    let is_plain = |part: Component<'_>| matches!(part, Component::Normal(_));
    !text.ends_with('/') && !rest.contains(['{', '}', '\\']) && Path::new(text).components().all(is_plain)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::watch::Completeness;

    fn read(text: &str) -> Result<WatchRules, Problems> {
        parse("w.toml", text.as_bytes(), Path::new("."))
    }

    #[test]
    fn rules_are_read_with_their_defaults() {
        let text = "format = \"watch/1\"\n[[rule]]\npattern = \"*_{serial}_*.csv\"\nprocedure = \"static-bias\"\n\
                    [[rule]]\npattern = \"{serial}/*.parquet\"\nprocedure = \"static-bias\"\ncomplete = \"footer\"\n\
                    hook = [\"sh\", \"-c\", \"cat\"]\n";
        let rules = read(text).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(rules.poll, Duration::from_secs(5));
        let [first, second] = rules.rules.as_slice() else { panic!("{rules:?}") };
        assert_eq!((first.complete, first.after), (Completeness::Still, Duration::from_secs(60)));
        assert!(first.names_serial() && first.hook.is_empty() && first.marker == ".done");
        assert_eq!((second.complete, second.hook.len()), (Completeness::Footer, 3));
    }

    #[test]
    fn a_mistake_is_told_once_at_its_place() {
        let rule =
            "format = \"watch/1\"\n[[rule]]\npattern = \"{serial}.csv\"\nprocedure = \"static-bias\"\n";
        for (from, to, line) in [
            ("{serial}.csv", "{name}.csv", 3),
            ("{serial}.csv", "../{serial}.csv", 3),
            ("{serial}.csv", "/data/{serial}.csv", 3),
            ("{serial}.csv", "{serial}_{serial}.csv", 3),
            ("static-bias", "nowhere.toml", 4),
            ("\"static-bias\"", "\"static-bias\"\nserial_column = \"sn\"", 5),
            ("\"static-bias\"", "\"static-bias\"\nmarker = \"/done\"", 5),
            ("\"static-bias\"", "\"static-bias\"\nafter = \"60\"", 5),
            ("\"static-bias\"", "\"static-bias\"\nhook = \"cat\"", 5),
            ("\"static-bias\"", "\"static-bias\"\ncomplete = \"soon\"", 5),
        ] {
            let problems = read(&rule.replace(from, to)).unwrap_err();
            let lines: Vec<usize> = problems.list.iter().map(|p| p.line).collect();
            assert_eq!(lines, [line], "{to}: {problems}");
        }
        assert!(read(rule).is_ok());
    }
}
