//! Broken recordings in files, each with line, character, offending text and a piece of the message written by hand.

use crate::support::{corpus, result, sagnac};
use std::path::Path;
use tempfile::tempdir;

/// `line:character: token: fragment`; `-` where there is no such place.
struct Expected {
    line: Option<u64>,
    character: Option<u64>,
    token: String,
    fragment: String,
}

fn expected(path: &Path) -> Expected {
    let text = corpus::expected(path);
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
    let run = sagnac(folder.path(), &["--lang", "en", "analyze", &path.to_string_lossy(), "--out", "o"]);
    if run.code != 0 {
        assert_eq!(run.code, 2, "{}", path.display());
        return vec![run.err];
    }
    let result = result(&folder.path().join("o"));
    let faults = result["integrity"]["faults"].as_array().unwrap();
    faults.iter().map(|f| f["note"].as_str().unwrap().to_owned()).collect()
}

#[test]
fn every_broken_recording_is_told_at_its_place() {
    let files = corpus::cases("recording", "csv");
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
