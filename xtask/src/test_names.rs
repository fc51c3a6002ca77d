//! Compares the names of all tests with those of an earlier commit, so that none goes unnoticed.

use crate::weight::git;
use std::collections::BTreeMap;
use std::io;
use std::path::Path;
use std::process::ExitCode;

/// Prints the tests that went and those that came since a commit. A test is known by the name of its function: one that
/// moved to another file is the same test.
pub fn compare(root: &Path, commit: &str) -> ExitCode {
    let (old, new) = match (names(root, Some(commit)), names(root, None)) {
        (Ok(old), Ok(new)) => (old, new),
        (Err(error), _) | (_, Err(error)) => {
            eprintln!("tests: {error}");
            return ExitCode::FAILURE;
        }
    };
    let total = |of: &BTreeMap<String, Vec<String>>| of.values().map(Vec::len).sum::<usize>();
    println!("{} tests at {commit}, {} now", total(&old), total(&new));
    for (sign, from, to) in [("-", &old, &new), ("+", &new, &old)] {
        for (name, files) in from {
            let more = files.len().saturating_sub(to.get(name).map_or(0, Vec::len));
            if more > 0 {
                println!("{sign} {name} ({})", files[..more].join(", "));
            }
        }
    }
    ExitCode::SUCCESS
}

/// Functions with `#[test]` of a commit or of the work tree, and the files in which each name stands.
fn names(root: &Path, commit: Option<&str>) -> io::Result<BTreeMap<String, Vec<String>>> {
    let mut arguments =
        vec!["grep", "--full-name", "--no-color", "--heading", "--after-context=6", "-F", "#[test]"];
    arguments.extend(commit);
    arguments.extend(["--", "*.rs"]);
    let mut found: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let (mut file, mut expected) = (String::new(), false);
    for line in git(root, &arguments)?.lines() {
        let code = line.trim_start();
        if line.ends_with(".rs") && !line.starts_with([' ', '/']) {
            let path = commit.and_then(|c| line.strip_prefix(&format!("{c}:"))).unwrap_or(line);
            path.clone_into(&mut file);
        } else if code.starts_with("#[test]") {
            expected = true;
        } else if let Some(name) = code.strip_prefix("fn ").filter(|_| expected) {
            let name = name.split('(').next().unwrap_or_default();
            found.entry(name.to_owned()).or_default().push(file.clone());
            expected = false;
        }
    }
    Ok(found)
}
