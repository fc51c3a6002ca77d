//! Compares what two binaries make of the shipped samples.

use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::{fs, io};

/// A procedure and a sample of `samples/README.md`, and the exit code stated there.
struct Pair {
    procedure: &'static str,
    sample: String,
    serial: Option<String>,
    limits: Option<&'static str>,
    exit: i32,
}

impl Pair {
    fn name(&self) -> String {
        format!("{} / {}", self.procedure, self.sample)
    }
}

/// When a run took place is not its result.
const CLOCK_FIELDS: [&str; 1] = ["evaluated_at"];

/// What may differ between two results.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    /// A text.
    Word,
    /// A number, in any digit.
    Number,
    /// A field or an item that only one of them has, or another type.
    Shape,
    /// The exit code.
    Exit,
    /// No result was written.
    NoResult,
}

struct Difference {
    kind: Kind,
    at: String,
    old: String,
    new: String,
}

/// Runs every pair whose name contains `only` with both binaries and prints what differs.
///
/// Exit code 0: numbers, shape and exit codes are the same (words may differ); 1: something differs; 2: a run failed.
pub fn compare(root: &Path, old: &Path, new: &Path, only: &str) -> ExitCode {
    let chosen: Vec<Pair> = pairs().into_iter().filter(|p| p.name().contains(only)).collect();
    let mut totals: BTreeMap<Kind, usize> = BTreeMap::new();
    for pair in &chosen {
        let differences = match compare_pair(root, pair, old, new) {
            Ok(differences) => differences,
            Err(error) => {
                eprintln!("failed to run {}: {error}", pair.name());
                return ExitCode::from(2);
            }
        };
        println!("{} {}", if differences.is_empty() { "same   " } else { "DIFFERS" }, pair.name());
        for Difference { kind, at, old, new } in differences {
            println!("    {kind:?} {at}: {old} -> {new}");
            *totals.entry(kind).or_default() += 1;
        }
    }
    println!("{} pairs, differences: {totals:?}", chosen.len());
    if chosen.is_empty() || totals.contains_key(&Kind::NoResult) {
        ExitCode::from(2)
    } else if totals.keys().any(|k| *k != Kind::Word) {
        ExitCode::FAILURE
    } else {
        ExitCode::SUCCESS
    }
}

fn pairs() -> Vec<Pair> {
    let mut pairs = vec![];
    let mut add = |procedure, sample: &str, serial: Option<&str>, limits, exit| {
        pairs.push(Pair {
            procedure,
            sample: sample.to_owned(),
            serial: serial.map(str::to_owned),
            limits,
            exit,
        });
    };
    for (name, exit) in [("pass", 0), ("fail", 1), ("indeterminate", 3), ("faults", 3)] {
        add("static-bias", &format!("unit-{name}.csv"), Some("SN-0001"), Some("sample-unit"), exit);
    }
    for procedure in [
        "scale-factor",
        "scale-factor-over-temperature",
        "threshold",
        "maximum-rate",
        "misalignment",
        "acceleration",
        "transfer-function",
        "start-up",
        "bench-check",
    ] {
        for (name, exit) in [("pass", 0), ("fail", 1)] {
            add(procedure, &format!("{procedure}-{name}.csv"), Some("SN-1"), None, exit);
        }
    }
    add("multi-position", "multi-position-pass.csv", Some("SN-1"), None, 0);
    add("multi-position", "multi-position-software.csv", Some("SN-1"), None, 3);
    for (procedure, sample, serial, limits, exit) in [
        ("temperature-ramp", "temperature-pass", "SN-0101", "sample-temperature", 0),
        ("temperature-ramp", "temperature-fail", "SN-0102", "sample-temperature", 1),
        ("temperature-ramp", "temperature-aborted", "SN-0103", "sample-temperature", 3),
        ("temperature-soak", "temperature-soak-pass", "SN-0104", "sample-temperature", 0),
        ("temperature-soak", "temperature-soak-fail", "SN-0105", "sample-temperature", 1),
        ("warm-up", "warm-up-pass", "SN-0106", "sample-warm-up", 0),
        ("warm-up", "warm-up-fail", "SN-0107", "sample-warm-up", 1),
    ] {
        add(procedure, &format!("{sample}.csv"), Some(serial), Some(limits), exit);
    }
    let alternating = ["bias-repeatability", "magnetic-sensitivity", "supply-sensitivity", "vibration"];
    let tests = alternating.iter().flat_map(|p| [(*p, "pass", 0), (*p, "fail", 1)]);
    for (number, (procedure, name, exit)) in (111..).zip(tests) {
        add(procedure, &format!("{procedure}-{name}.csv"), Some(&format!("SN-0{number}")), None, exit);
    }
    let declared = [
        "pressure-sensitivity",
        "electromagnetic-immunity",
        "scale-factor-under-pressure",
        "vibration-by-frequency",
    ];
    let tests = declared.iter().flat_map(|p| [(*p, "pass", 0), (*p, "fail", 1)]);
    for (number, (procedure, name, exit)) in (121..).zip(tests) {
        add(procedure, &format!("{procedure}-{name}.csv"), Some(&format!("SN-0{number}")), None, exit);
    }
    add("output-noise", "output-noise-pass.csv", Some("SN-0119"), None, 0);
    add("output-noise", "output-noise-fail.csv", Some("SN-0120"), None, 1);
    for (name, exit) in [("pass", 0), ("fail", 1)] {
        add("acceptance", &format!("acceptance-{name}.toml"), None, None, exit);
    }
    pairs
}

fn compare_pair(root: &Path, pair: &Pair, old: &Path, new: &Path) -> io::Result<Vec<Difference>> {
    let folder = std::env::temp_dir().join(format!("sagnac-same-results-{}", std::process::id()));
    let before = run(root, pair, old, &folder.join("old"));
    let after = run(root, pair, new, &folder.join("new"));
    // A folder that stays behind is no reason to fail.
    let _ = fs::remove_dir_all(&folder);
    let ((old_exit, old_results), (new_exit, new_results)) = (before?, after?);
    let mut differences = vec![];
    let mut note = |kind, at: &str, old: String, new: String| {
        differences.push(Difference { kind, at: at.to_owned(), old, new });
    };
    if old_exit != new_exit {
        note(Kind::Exit, "exit code", format!("{old_exit:?}"), format!("{new_exit:?}"));
    }
    if new_exit != Some(pair.exit) {
        note(Kind::Exit, "exit code of samples/README.md", pair.exit.to_string(), format!("{new_exit:?}"));
    }
    if old_results.is_empty() || new_results.is_empty() {
        note(Kind::NoResult, "result.json", old_results.len().to_string(), new_results.len().to_string());
    }
    let (old_files, new_files) = (object(old_results), object(new_results));
    walk(&old_files, &new_files, "", &mut differences);
    Ok(differences)
}

fn object(results: BTreeMap<String, Value>) -> Value {
    Value::Object(results.into_iter().collect())
}

/// The exit code, and every `result.json` under its path.
fn run(
    root: &Path,
    pair: &Pair,
    program: &Path,
    out: &Path,
) -> io::Result<(Option<i32>, BTreeMap<String, Value>)> {
    let mut command = Command::new(program);
    command.current_dir(root).arg("run").arg(format!("procedures/{}.toml", pair.procedure));
    command.arg(format!("samples/{}", pair.sample)).args(["--lang", "en", "--out"]).arg(out);
    if let Some(serial) = &pair.serial {
        command.args(["--serial", serial]);
    }
    if let Some(limits) = pair.limits {
        command.arg("--limits").arg(format!("procedures/limits/{limits}.toml"));
    }
    let done = command.output()?;
    let mut files = vec![];
    collect_results(out, &mut files)?;
    let mut results = BTreeMap::new();
    for file in files {
        let name = file.strip_prefix(out).unwrap_or(&file).display().to_string();
        results.insert(name, serde_json::from_str(&fs::read_to_string(&file)?)?);
    }
    Ok((done.status.code(), results))
}

fn collect_results(folder: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    if !folder.is_dir() {
        return Ok(());
    }
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            collect_results(&path, files)?;
        } else if path.file_name().is_some_and(|n| n == "result.json") {
            files.push(path);
        }
    }
    Ok(())
}

/// Numbers are read to the nearest double and written back with the fewest digits that give it: they differ where any digit
/// of the file does.
fn walk(old: &Value, new: &Value, at: &str, differences: &mut Vec<Difference>) {
    let mut note = |kind, at: String, old: String, new: String| {
        differences.push(Difference { kind, at, old, new });
    };
    match (old, new) {
        (Value::Object(a), Value::Object(b)) => {
            let added = b.keys().filter(|k| !a.contains_key(*k));
            for key in a.keys().chain(added).filter(|k| !CLOCK_FIELDS.contains(&k.as_str())) {
                let at = format!("{at}.{key}");
                match (a.get(key), b.get(key)) {
                    (Some(a), Some(b)) => walk(a, b, &at, differences),
                    (a, b) => {
                        differences.push(Difference { kind: Kind::Shape, at, old: short(a), new: short(b) })
                    }
                }
            }
        }
        (Value::Array(a), Value::Array(b)) => {
            if a.len() != b.len() {
                note(Kind::Shape, at.to_owned(), format!("{} items", a.len()), format!("{} items", b.len()));
            }
            for (i, (a, b)) in a.iter().zip(b).enumerate() {
                walk(a, b, &format!("{at}[{i}]"), differences);
            }
        }
        (Value::Number(a), Value::Number(b)) if a.to_string() != b.to_string() => {
            note(Kind::Number, at.to_owned(), a.to_string(), b.to_string());
        }
        (Value::String(a), Value::String(b)) if a != b => {
            note(Kind::Word, at.to_owned(), short(Some(old)), short(Some(new)));
        }
        (a, b) if std::mem::discriminant(a) != std::mem::discriminant(b) => {
            note(Kind::Shape, at.to_owned(), short(Some(a)), short(Some(b)));
        }
        (Value::Bool(a), Value::Bool(b)) if a != b => {
            note(Kind::Shape, at.to_owned(), a.to_string(), b.to_string());
        }
        _ => {}
    }
}

fn short(value: Option<&Value>) -> String {
    value.map_or_else(|| "absent".to_owned(), |v| v.to_string().chars().take(160).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds(old: &str, new: &str) -> Vec<Kind> {
        let mut differences = vec![];
        let read = |text| serde_json::from_str(text).unwrap();
        walk(&read(old), &read(new), "", &mut differences);
        differences.iter().map(|d| d.kind).collect()
    }

    #[test]
    fn a_last_digit_and_a_lost_field_are_found_and_the_clock_is_not() {
        assert_eq!(kinds(r#"{"a": 0.1, "b": [1]}"#, r#"{"a": 0.1, "b": [1]}"#), []);
        assert_eq!(kinds(r#"{"a": 0.1}"#, r#"{"a": 0.10000000000000002}"#), [Kind::Number]);
        assert_eq!(kinds(r#"{"a": 1, "b": 2}"#, r#"{"a": 1, "c": 2}"#), [Kind::Shape, Kind::Shape]);
        assert_eq!(kinds(r#"{"a": "x"}"#, r#"{"a": "y"}"#), [Kind::Word]);
        assert_eq!(kinds(r#"{"a": null}"#, r#"{"a": 1}"#), [Kind::Shape]);
        assert_eq!(kinds(r#"{"a": true}"#, r#"{"a": false}"#), [Kind::Shape]);
        assert_eq!(kinds(r#"{"evaluated_at": "x"}"#, r#"{"evaluated_at": "y"}"#), []);
    }

    #[test]
    fn every_pair_has_its_files() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        let pairs = pairs();
        assert_eq!(pairs.len(), 51);
        for pair in pairs {
            assert!(root.join(format!("procedures/{}.toml", pair.procedure)).exists(), "{}", pair.name());
            assert!(root.join("samples").join(&pair.sample).exists(), "{}", pair.name());
        }
    }
}
