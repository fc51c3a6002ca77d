//! Broken procedures and limits files: every problem is reported at its place, and nothing else.
//!
//! Each `tests/bad-input/{procedure,limits}/NAME.toml` has a `NAME.expect` written by hand, one line a problem:
//! `[warning ]line:column: offending text: fragment of message or help`.

use sagnac::procedure::{Problem, Problems, Severity, parse_limits, parse_procedure};
use std::path::{Path, PathBuf};

fn cases(kind: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad-input").join(kind);
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    files.sort();
    files
}

fn matches(expected: &str, problem: &Problem) -> bool {
    let (severity, rest) = match expected.strip_prefix("warning ") {
        Some(rest) => (Severity::Warning, rest),
        None => (Severity::Error, expected),
    };
    let mut parts = rest.splitn(3, ": ");
    let (place, token, fragment) =
        (parts.next().unwrap(), parts.next().expect("offending text"), parts.next().expect("fragment"));
    let said =
        format!("{} {}", problem.message, problem.help.as_ref().map(|h| h.to_string()).unwrap_or_default());
    severity == problem.severity
        && place == format!("{}:{}", problem.line, problem.column)
        && token == problem.token
        && said.contains(fragment)
}

fn run(kind: &str, parse: impl Fn(&str, &[u8]) -> Vec<Problem>) -> usize {
    let files = cases(kind);
    let mut wrong = String::new();
    for file in &files {
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        let expected = std::fs::read_to_string(file.with_extension("expect")).expect("a .expect beside it");
        let mut found = parse(&name, &std::fs::read(file).unwrap());
        for line in expected.lines() {
            match found.iter().position(|p| matches(line, p)) {
                Some(i) => {
                    found.remove(i);
                }
                None => wrong.push_str(&format!("{name}: not reported: {line}\n")),
            }
        }
        for problem in found {
            wrong.push_str(&format!("{name}: not expected (token `{}`):\n{problem}\n", problem.token));
        }
    }
    assert!(wrong.is_empty(), "\n{wrong}");
    files.len()
}

fn problems<T>(result: Result<sagnac::procedure::Loaded<T>, Problems>) -> Vec<Problem> {
    match result {
        Ok(loaded) => loaded.warnings,
        Err(problems) => problems.list,
    }
}

#[test]
fn broken_procedures_are_reported_at_their_place() {
    let count = run("procedure", |name, bytes| problems(parse_procedure(name, bytes)));
    assert!(count >= 70, "{count} cases");
}

#[test]
fn broken_limits_are_reported_at_their_place() {
    let count = run("limits", |name, bytes| problems(parse_limits(name, bytes)));
    assert!(count >= 19, "{count} cases");
}

#[test]
fn every_report_of_the_corpus_shows_file_line_and_help_in_full() {
    for file in cases("procedure") {
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        for problem in problems(parse_procedure(&name, &std::fs::read(&file).unwrap())) {
            let shown = problem.to_string();
            let place = format!("--> {name}:{}:{}", problem.line, problem.column);
            assert!(shown.contains(&place), "{shown}");
            let line = shown.lines().find(|l| l.starts_with(&format!("{} | ", problem.line))).unwrap();
            let carets = shown.lines().find(|l| l.trim_start_matches([' ', '|']).starts_with('^')).unwrap();
            let (from, width) = (
                carets.chars().position(|c| c == '^').unwrap(),
                carets.chars().filter(|c| *c == '^').count(),
            );
            let underlined: String = line.chars().skip(from).take(width).collect();
            assert!(problem.token.is_empty() || underlined == problem.token, "{shown}");
        }
    }
}
