//! Runs the proofs and writes what came of each run, failures too, into `docs/PROOFS.md`.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::Instant;

/// Where the lines of the runs begin.
const HEAD: &str =
    "| date | commit | proof | outcome | rules | what did not hold | time |\n|---|---|---|---|---|---|--:|\n";

/// Runs the proofs whose path contains one of the words, or all, with recordings from a folder; the pages stay in `target/proofs`.
pub fn run(root: &Path, data: &str, words: &[String]) -> ExitCode {
    let page = root.join("docs/PROOFS.md");
    let Ok(mut text) = std::fs::read_to_string(&page) else {
        eprintln!("docs/PROOFS.md cannot be read");
        return ExitCode::FAILURE;
    };
    if !text.contains(HEAD) {
        eprintln!("docs/PROOFS.md has no table of runs");
        return ExitCode::FAILURE;
    }
    let built = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
        .current_dir(root)
        .args(["build", "--release", "--quiet"])
        .status();
    if !built.is_ok_and(|s| s.success()) {
        return ExitCode::FAILURE;
    }
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
    let commit = said(root, &["git", "describe", "--always", "--dirty=+"]);
    let mut failed = false;
    for proof in proofs(&root.join("proofs")) {
        let name = proof.strip_prefix(root).unwrap_or(&proof).display().to_string();
        if !words.is_empty() && !words.iter().any(|w| name.contains(w.as_str())) {
            continue;
        }
        let out = target
            .join("proofs")
            .join(proof.strip_prefix(root.join("proofs")).unwrap_or(&proof))
            .with_extension("");
        let began = Instant::now();
        let ran = Command::new(target.join("release/sagnac"))
            .current_dir(root)
            .args(["prove", &name, "--data", data, "--force", "--quiet", "--out"])
            .arg(&out)
            .output();
        let seconds = began.elapsed().as_secs_f64();
        let record = std::fs::read(out.join("proof.json")).ok();
        let record: Option<Value> = record.and_then(|bytes| serde_json::from_slice(&bytes).ok());
        let done = ran.as_ref().is_ok_and(|o| matches!(o.status.code(), Some(0 | 1)));
        let line = match record.filter(|_| done) {
            Some(record) => told(&name, &commit, &record, seconds),
            None => {
                let why =
                    ran.map(|o| String::from_utf8_lossy(&o.stderr).trim().to_owned()).unwrap_or_default();
                let date = said(root, &["date", "-u", "+%F"]);
                failed = true;
                format!(
                    "| {date} | `{commit}` | `{name}` | could not run | – | {} | {seconds:.0} s |\n",
                    cell(&why)
                )
            }
        };
        print!("{line}");
        text.push_str(&line);
        if std::fs::write(&page, &text).is_err() {
            eprintln!("docs/PROOFS.md cannot be written");
            return ExitCode::FAILURE;
        }
    }
    if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

/// The line of a run.
fn told(name: &str, commit: &str, record: &Value, seconds: f64) -> String {
    let rules = record["rules"].as_array().cloned().unwrap_or_default();
    let broken: Vec<String> = rules
        .iter()
        .filter(|r| r["holds"] != true)
        .map(|r| {
            let word = |key: &str| r[key]["text"].as_str().unwrap_or_default().to_owned();
            format!("{}: {} — {}", r["when"].as_str().unwrap_or_default(), word("must"), word("found"))
        })
        .collect();
    let date = record["proved_at"].as_str().and_then(|d| d.get(..10)).unwrap_or_default();
    let outcome = if record["outcome"] == "holds" { "proved" } else { "**not proved**" };
    let held = rules.len() - broken.len();
    format!(
        "| {date} | `{commit}` | `{name}` | {outcome} | {held} of {} | {} | {seconds:.0} s |\n",
        rules.len(),
        cell(&broken.join("; "))
    )
}

fn cell(text: &str) -> String {
    if text.is_empty() { "–".to_owned() } else { text.replace(['\n', '|'], " ") }
}

/// Every proof below a folder, in the order of their names.
fn proofs(folder: &Path) -> Vec<PathBuf> {
    let mut found = vec![];
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            found.extend(proofs(&path));
        } else if std::fs::read_to_string(&path).is_ok_and(|t| t.starts_with("format = \"proof/1\"")) {
            found.push(path);
        }
    }
    found.sort();
    found
}

fn said(root: &Path, command: &[&str]) -> String {
    let [program, arguments @ ..] = command else { return String::new() };
    let output = Command::new(program).current_dir(root).args(arguments).output();
    output.map(|o| String::from_utf8_lossy(&o.stdout).trim().to_owned()).unwrap_or_default()
}
