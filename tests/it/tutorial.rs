//! The tutorial, carried out as it is written: every command, every output.

#![cfg(unix)]

use crate::support::{program, root};
use std::path::{Path, PathBuf};

/// A block of the page: its language and its lines.
struct Block {
    language: String,
    text: String,
}

fn blocks(page: &str) -> Vec<Block> {
    let mut out: Vec<Block> = vec![];
    let mut open = false;
    for line in page.lines() {
        match (line.strip_prefix("```"), open) {
            (Some(language), false) => {
                out.push(Block { language: language.to_owned(), text: String::new() });
                open = true;
            }
            (Some(_), true) => open = false,
            (None, true) => {
                let block = out.last_mut().unwrap();
                block.text.push_str(line);
                block.text.push('\n');
            }
            (None, false) => {}
        }
    }
    out
}

/// What a command prints: standard output, and where it could not do its work the error.
fn printed(folder: &Path, command: &str) -> String {
    let program = PathBuf::from(program());
    let path = std::env::var_os("PATH").unwrap_or_default();
    let places = program.parent().map(PathBuf::from).into_iter().chain(std::env::split_paths(&path));
    let done = assert_cmd::Command::new("sh")
        .current_dir(folder)
        .args(["-c", command])
        .env("PATH", std::env::join_paths(places).unwrap())
        .env("LANG", "C.UTF-8")
        .env_remove("LC_ALL")
        .output()
        .unwrap();
    let error = String::from_utf8(done.stderr).unwrap();
    let text = String::from_utf8(done.stdout).unwrap() + &error;
    assert_eq!(done.status.code() == Some(2), text.contains("error: "), "{command}: {text}");
    // Numbers and units are kept together by spaces of their own.
    text.replace(['\u{a0}', '\u{202f}', '\u{2009}'], " ")
}

#[test]
fn every_command_gives_the_output_on_the_page() {
    let page = std::fs::read_to_string(root().join("docs/tutorial.md")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    for file in std::fs::read_dir(root().join("docs/tutorial")).unwrap() {
        let file = file.unwrap().path();
        std::fs::copy(&file, folder.path().join(file.file_name().unwrap())).unwrap();
    }
    let (mut last, mut compared) = (String::new(), 0);
    for block in blocks(&page) {
        match block.language.as_str() {
            "sh" => last = printed(folder.path(), &block.text),
            "text" => {
                assert!(last.contains(&block.text), "on the page:\n{}\nprinted:\n{last}", block.text);
                compared += 1;
            }
            other => panic!("a block of `{other}`"),
        }
    }
    assert_eq!(compared, 13);
    let report = std::fs::read_to_string(folder.path().join("report/report.md")).unwrap();
    for value in ["0.1186", "10.64 °/h", "0.001994", "| 0.0043 | 0.0028 … 0.0058 |", "0.0133 °/h"] {
        assert!(report.contains(value), "{value} is not in the report");
    }
}
