//! Broken recordings in files, each with line, character, offending text and a piece of the message written by hand.

use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::tempdir;

/// `line:character: token: fragment`; `-` where there is no such place.
struct Expected {
    line: Option<u64>,
    character: Option<u64>,
    token: String,
    fragment: String,
}

fn expected(path: &Path) -> Expected {
    let text = std::fs::read_to_string(path.with_extension("expect")).unwrap();
    let (place, rest) = text.trim_end().split_once(": ").unwrap();
    let (token, fragment) = rest.rsplit_once(": ").unwrap();
    let (line, character) = place.split_once(':').unwrap();
    Expected {
        line: line.parse().ok(),
        character: character.parse().ok(),
        token: token.trim_end_matches(':').trim().to_owned(),
        fragment: fragment.to_owned(),
    }
}

/// What `analyze` says of a file: its complaint, or the notes of its faults.
fn said(path: &Path) -> Vec<String> {
    let folder = tempdir().unwrap();
    let out = folder.path().join("o");
    let run = Command::new(env!("CARGO_BIN_EXE_sagnac"))
        .args(["--lang", "en", "analyze"])
        .arg(path)
        .arg("--out")
        .arg(&out)
        .output()
        .unwrap();
    if !run.status.success() {
        assert_eq!(run.status.code(), Some(2), "{}", path.display());
        return vec![String::from_utf8(run.stderr).unwrap()];
    }
    let text = std::fs::read_to_string(out.join("result.json")).unwrap();
    let result: serde_json::Value = serde_json::from_str(&text).unwrap();
    let faults = result["integrity"]["faults"].as_array().unwrap();
    faults.iter().map(|f| f["note"].as_str().unwrap().to_owned()).collect()
}

#[test]
fn every_broken_recording_is_told_at_its_place() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad-input/recording");
    let mut files: Vec<PathBuf> = std::fs::read_dir(&folder)
        .unwrap()
        .map(|e| e.unwrap().path())
        .filter(|p| p.extension().is_some_and(|e| e == "csv"))
        .collect();
    files.sort();
    assert!(files.len() >= 19, "only {} files", files.len());
    let mut wrong = vec![];
    for path in &files {
        let e = expected(path);
        let name = path.display().to_string();
        let told = said(path);
        let fits = |text: &String| {
            let refused = match (e.line, e.character) {
                (Some(l), Some(c)) => text.contains(&format!("{name}:{l}:{c}: ")),
                (Some(l), None) => text.contains(&format!("{name}:{l}: ")),
                _ => text.contains(&format!("{name}: ")),
            };
            let located = e
                .line
                .zip(e.character)
                .is_some_and(|(l, c)| text.contains(&format!(", line {l} character {c}:")));
            let token = e.token.is_empty() || text.contains(&format!("`{}`", e.token));
            (refused || located) && token && text.contains(&e.fragment)
        };
        if !told.iter().any(fits) {
            wrong.push(format!("{name}: {told:#?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
