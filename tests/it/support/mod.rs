//! Runs the program as a user does and reads what it leaves.
#![allow(dead_code, reason = "each test file uses its own part")]

pub mod corpus;
pub mod long;
pub mod pairs;
pub mod quick;
pub mod real;
pub mod schema;
pub mod shared;
pub mod synthetic;
pub mod tested;

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// No run of a test may take longer: several times what the longest takes where other tests share the machine.
const PATIENCE: Duration = Duration::from_secs(900);

/// What a run of the program said.
#[derive(Debug)]
pub struct Said {
    /// Exit code; -1 when it was killed.
    pub code: i32,
    /// Standard output.
    pub out: String,
    /// Standard error.
    pub err: String,
}

/// Path of the program.
pub fn program() -> &'static str {
    env!("CARGO_BIN_EXE_sagnac")
}

/// Runs the program in a folder.
pub fn sagnac(folder: &Path, args: &[&str]) -> Said {
    sagnac_with(folder, args, &[])
}

/// Runs the program in a folder with variables of the environment. A test that names a folder for results once more
/// means to replace what is there.
pub fn sagnac_with(folder: &Path, args: &[&str], environment: &[(&str, &str)]) -> Said {
    let out = args.iter().position(|a| *a == "--out").and_then(|i| args.get(i + 1));
    let again = out.is_some_and(|out| folder.join(out).exists()) && !args.contains(&"--force");
    let mut args = args.to_vec();
    args.extend(again.then_some("--force"));
    let mut said = sagnac_as_typed(folder, &args, environment);
    if again
        && let Some((first, rest)) = said.err.split_once('\n').filter(|(f, _)| f.starts_with("--force: "))
    {
        assert!(first.contains("replaced"), "{first}");
        said.err = rest.to_owned();
    }
    said
}

/// Runs the program in a folder with the arguments as they are.
pub fn sagnac_as_typed(folder: &Path, args: &[&str], environment: &[(&str, &str)]) -> Said {
    let output = assert_cmd::Command::new(program())
        .current_dir(folder)
        .args(args)
        .envs(environment.iter().copied())
        .timeout(PATIENCE)
        .output()
        .unwrap();
    let said = Said {
        code: output.status.code().unwrap_or(-1),
        out: String::from_utf8(output.stdout).unwrap(),
        err: String::from_utf8(output.stderr).unwrap(),
    };
    assert!(!said.err.contains("panicked"), "{args:?}: {}", said.err);
    assert!((0..=3).contains(&said.code), "{args:?}: {said:?}");
    said
}

/// The root of the repository.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A file of the repository, as text for the command line.
pub fn shipped(path: &str) -> String {
    root().join(path).to_string_lossy().into_owned()
}

/// The static procedure.
pub fn procedure() -> String {
    shipped("procedures/static-bias.toml")
}

/// The static procedure with a warm-up of 10 s, for short recordings; written into a folder.
pub fn short_procedure(folder: &Path) -> String {
    altered(folder, "short.toml", &procedure(), &[("warm_up = \"30 min\"", "warm_up = \"10 s\"")])
}

/// Analyses a recording into `a`. Whatever it is: no panic, exit codes as documented, no value that is no number in what
/// was written.
pub fn analysed(folder: &Path, name: &str) -> Said {
    written(folder, &["analyze", name], "a")
}

/// Analyses a recording into `a` and tests it into `r`, as [`analysed`] does.
pub fn both(folder: &Path, name: &str) -> (Said, Said) {
    let short = short_procedure(folder);
    (analysed(folder, name), written(folder, &["run", &short, name, "--serial", "SN-1"], "r"))
}

fn written(folder: &Path, args: &[&str], out: &str) -> Said {
    let said = sagnac(folder, &[args, &["--out", out]].concat());
    if folder.join(out).is_dir() {
        assert_no_nan(&folder.join(out));
    }
    said
}

/// The limits of the samples.
pub fn limits() -> String {
    shipped("procedures/limits/sample-unit.toml")
}

/// A sample by its short name.
pub fn sample(name: &str) -> String {
    shipped(&format!("samples/unit-{name}.csv"))
}

/// The static procedure with some of its text replaced; every replacement must find its text.
pub fn altered(folder: &Path, name: &str, source: &str, changes: &[(&str, &str)]) -> String {
    let mut text = std::fs::read_to_string(source).unwrap();
    for (from, to) in changes {
        assert!(text.contains(from), "{source} holds no `{from}`");
        text = text.replace(from, to);
    }
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path.to_string_lossy().into_owned()
}

/// `result.json` of a result folder.
pub fn result(folder: &Path) -> Value {
    let bytes = std::fs::read(folder.join("result.json")).unwrap();
    serde_json::from_slice(&bytes).unwrap()
}

/// The row of a measurand.
pub fn measurand<'a>(result: &'a Value, id: &str) -> &'a Value {
    let rows = result["measurands"].as_array().unwrap();
    rows.iter().find(|m| m["id"] == id).unwrap_or_else(|| panic!("no {id}"))
}

/// Files of a folder by their paths in it, sorted.
pub type Files = Vec<(PathBuf, Vec<u8>)>;

/// The files of a result without the moment of its making, and without the list of hashes, which are those of files with
/// the clock in them.
pub fn steady_files(folder: &Path) -> Files {
    let at = result(folder)["session"]["evaluated_at"].as_str().unwrap().to_owned();
    let shown = format!("{} {} UTC", &at[..10], &at[11..19]);
    let without = |bytes: Vec<u8>| {
        let text = String::from_utf8(bytes).unwrap();
        text.replace(&at[..19], "<clock>").replace(&shown, "<clock>").into_bytes()
    };
    let all = files(folder).into_iter().filter(|(path, _)| !path.ends_with("SHA256SUMS"));
    all.map(|(path, bytes)| (path, without(bytes))).collect()
}

/// Every file below a folder.
pub fn files(folder: &Path) -> Files {
    let mut found = Vec::new();
    let mut open = vec![folder.to_owned()];
    while let Some(next) = open.pop() {
        for entry in std::fs::read_dir(&next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else {
                let bytes = std::fs::read(&path).unwrap();
                found.push((path.strip_prefix(folder).unwrap().to_owned(), bytes));
            }
        }
    }
    found.sort();
    found
}

/// Names in a folder, sorted.
pub fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// No value that is no number reaches a result: neither as a JSON token nor as text in a report. What a field of the
/// recording held may be quoted.
pub fn assert_no_nan(folder: &Path) {
    for (path, bytes) in files(folder) {
        let mut text = String::from_utf8(bytes).unwrap();
        for quoted in ["NaN", "nan", "inf", "-Infinity"] {
            text = text.replace(&format!("`{quoted}`"), "").replace(&format!("<code>{quoted}</code>"), "");
        }
        let words = text.split(|c: char| !c.is_ascii_alphabetic());
        for word in words {
            let bad = ["NaN", "nan", "inf", "Infinity", "infinity", "undefined"].contains(&word);
            assert!(!bad, "`{word}` in {}", path.display());
        }
    }
}

/// A Markdown report without what changes from run to run: the moment and the day of evaluation, the version, the checksums of files.
pub fn steady(report: &str, result: &Value) -> String {
    let at = result["session"]["evaluated_at"].as_str().unwrap();
    let clock = format!("{} {} UTC", &at[..10], &at[11..19]);
    assert!(report.contains(&clock), "{clock}");
    let mut text = report.replace(&clock, "<clock>").replace(&at[..10], "<day>");
    text = text.replace(env!("CARGO_PKG_VERSION"), "<version>");
    for word in report.split(|c: char| !c.is_ascii_hexdigit()).filter(|w| w.len() == 64) {
        text = text.replace(word, "<sha256>");
    }
    text
}

/// Writes the results of the sample lot as a table: a row each, with the recording and the record.
pub fn result_table(path: &std::path::Path) {
    use sagnac::output::{Column, write_table};
    type Row = (String, String);
    let mut rows: Vec<Row> = std::fs::read_dir(root().join("samples/lot"))
        .unwrap()
        .flatten()
        .filter_map(|e| {
            let record = std::fs::read_to_string(e.path().join("result.json")).ok()?;
            Some((format!("recordings/{}.csv", e.file_name().display()), record))
        })
        .collect();
    rows.sort();
    let columns: [(&str, Column<Row>); 2] =
        [("uri", Column::Text(|r| r.0.clone())), ("result_json", Column::Text(|r| r.1.clone()))];
    write_table(&rows, &columns, std::fs::File::create(path).unwrap()).unwrap();
}
