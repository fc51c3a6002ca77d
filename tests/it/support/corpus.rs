//! The folders of `tests/bad-input`: broken files, each with a `NAME.expect` beside it that was written by hand.
//!
//! Of files of keys it has one line a problem: `[warning ]line:column: offending text: fragment of message or help`.

use sagnac::config::procedure::{Loaded, Problem, Problems, Severity};
use sagnac::i18n::{Lang, Localize};
use std::path::{Path, PathBuf};

/// The files of a folder with an extension, sorted.
pub fn cases(kind: &str, extension: &str) -> Vec<PathBuf> {
    let folder = super::root().join("tests/bad-input").join(kind);
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == extension))
        .collect();
    files.sort();
    files
}

/// What is expected of a file.
pub fn expected(file: &Path) -> String {
    std::fs::read_to_string(file.with_extension("expect")).expect("a .expect beside it")
}

/// All problems of a file, warnings among them.
pub fn problems<T>(result: Result<Loaded<T>, Problems>) -> Vec<Problem> {
    match result {
        Ok(loaded) => loaded.warnings,
        Err(problems) => problems.list,
    }
}

fn matches(expected: &str, problem: &Problem) -> bool {
    let (severity, rest) = match expected.strip_prefix("warning ") {
        Some(rest) => (Severity::Warning, rest),
        None => (Severity::Error, expected),
    };
    let mut parts = rest.splitn(3, ": ");
    let (place, token, fragment) =
        (parts.next().unwrap(), parts.next().expect("offending text"), parts.next().expect("fragment"));
    let said = format!(
        "{} {}",
        problem.message.say(Lang::En),
        problem.help.as_ref().map(|h| h.say(Lang::En)).unwrap_or_default()
    );
    severity == problem.severity
        && place == format!("{}:{}", problem.line, problem.column)
        && token == problem.token
        && said.contains(fragment)
}

/// Asserts that every file of a folder has the problems expected of it and no others; gives the number of files.
pub fn each_problem_at_its_place(kind: &str, read: impl Fn(&Path) -> Vec<Problem>) -> usize {
    let files = cases(kind, "toml");
    let mut wrong = String::new();
    for file in &files {
        let name = file.file_name().unwrap().to_string_lossy();
        let mut found = read(file);
        for line in expected(file).lines() {
            match found.iter().position(|p| matches(line, p)) {
                Some(i) => drop(found.remove(i)),
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
