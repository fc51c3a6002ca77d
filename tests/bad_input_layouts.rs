//! Broken layouts of raw binary records: every problem is reported at its place, and nothing else.
//!
//! Each `tests/bad-input/layout/NAME.toml` has a `NAME.expect` written by hand, one line a problem:
//! `line:column: offending text: fragment of message or help`.

use sagnac::ingest::raw::layout;
use sagnac::procedure::Problem;
use std::path::Path;

fn matches(expected: &str, problem: &Problem) -> bool {
    let mut parts = expected.splitn(3, ": ");
    let (place, token, fragment) =
        (parts.next().unwrap(), parts.next().expect("offending text"), parts.next().expect("fragment"));
    let said =
        format!("{} {}", problem.message, problem.help.as_ref().map(ToString::to_string).unwrap_or_default());
    place == format!("{}:{}", problem.line, problem.column)
        && token == problem.token
        && said.contains(fragment)
}

#[test]
fn broken_layouts_are_reported_at_their_place() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad-input/layout");
    let (mut wrong, mut count) = (String::new(), 0);
    for entry in std::fs::read_dir(folder).unwrap() {
        let file = entry.unwrap().path();
        if file.extension().is_none_or(|e| e != "toml") {
            continue;
        }
        count += 1;
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        let expected = std::fs::read_to_string(file.with_extension("expect")).expect("a .expect beside it");
        let mut found = layout::load(&file).expect_err(&name).list;
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
    assert!(count >= 28, "{count} cases");
}
