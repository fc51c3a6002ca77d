//! Every shipped sample under changes that leave the unit as it is: the verdict stays, or the report says why not.
//!
//! A verdict of `pass` never becomes `fail` nor the reverse, and whatever else it becomes has a reason of its own: a
//! condition that is not met, a fault, or a row that says why it is undecided.

mod changes;

use crate::support::pairs::{PAIRS, Pair};
use crate::support::{result, sagnac, shipped};
use changes::Change;
use rayon::prelude::*;
use serde_json::Value;
use std::path::Path;

/// What a run gave.
struct Judged {
    code: i32,
    verdict: String,
    reasons: Vec<String>,
}

/// Runs a pair on files in a folder.
fn judged(dir: &Path, pair: &Pair, files: &[String], procedure: &str, serial: &str) -> Judged {
    let limits = pair.limits.map(|l| shipped(&format!("procedures/limits/{l}.toml")));
    let mut args = vec!["run", procedure];
    args.extend(files.iter().map(String::as_str));
    args.extend(["--serial", serial, "--out", "out"]);
    if let Some(limits) = &limits {
        args.extend(["--limits", limits.as_str()]);
    }
    let _ = std::fs::remove_dir_all(dir.join("out"));
    let said = sagnac(dir, &args);
    if !dir.join("out/result.json").exists() {
        return Judged { code: said.code, verdict: "refused".to_owned(), reasons: vec![said.err] };
    }
    let r = result(&dir.join("out"));
    Judged { code: said.code, verdict: verdict(&r), reasons: reasons(&r) }
}

fn verdict(r: &Value) -> String {
    r["verdict"].as_str().unwrap_or("?").to_owned()
}

/// What a result gives as reasons: conditions that are not met, and rows that are undecided with what they say or with
/// the interval that leaves their limit open.
fn reasons(r: &Value) -> Vec<String> {
    let text = |v: &Value, key: &str| v[key].as_str().unwrap_or_default().to_owned();
    let conditions = r["conditions"].as_array().into_iter().flatten();
    let broken = conditions.filter(|c| c["status"] == "invalid" && c["note"] != "");
    let broken = broken.map(|c| format!("{}: {}", text(c, "id"), text(c, "note")));
    let rows = r["measurands"].as_array().into_iter().flatten();
    let open = rows.filter(|m| m["verdict"] == "indeterminate");
    let open =
        open.filter(|m| m["notes"].as_array().is_some_and(|n| !n.is_empty()) || m["interval"].is_object());
    broken.chain(open.map(|m| format!("{}: {} {}", text(m, "id"), m["notes"], m["interval"]))).collect()
}

/// What is wrong with a changed sample, and what it gave.
fn outcome(pair: &Pair, change: Change) -> (String, Option<String>) {
    let dir = tempfile::tempdir().unwrap();
    let name = format!("{} {change:?}", pair.sample);
    let text = std::fs::read_to_string(shipped(&format!("samples/{}.csv", pair.sample))).unwrap();
    let procedure = shipped(&format!("procedures/{}.toml", pair.procedure));
    let Some(made) = changes::make(change, pair, &text, &std::fs::read_to_string(&procedure).unwrap()) else {
        return (format!("{name}: does not apply"), None);
    };
    let mut files = Vec::new();
    for (i, text) in made.files.iter().enumerate() {
        let file = format!("part{i}.csv");
        std::fs::write(dir.path().join(&file), text).unwrap();
        files.push(file);
    }
    std::fs::write(dir.path().join("p.toml"), &made.procedure).unwrap();
    let serial = made.serial.as_deref().unwrap_or(pair.serial);
    let judged = judged(dir.path(), pair, &files, "p.toml", serial);
    let same = judged.code == pair.code;
    let reversed = matches!((pair.code, judged.code), (0, 1) | (1, 0)) || pair.code == 3 && judged.code < 2;
    let line = format!("{name}: {} -> {} {} {:?}", pair.code, judged.code, judged.verdict, judged.reasons);
    let wrong = if same {
        None
    } else if reversed {
        Some(format!("the verdict changed: {line}"))
    } else if judged.reasons.iter().all(String::is_empty) {
        Some(format!("no reason: {line}"))
    } else {
        None
    };
    let wrong = match change {
        // A record of another unit is none of this one.
        Change::OtherUnit if judged.code == 0 => Some(format!("another unit passes: {line}")),
        Change::OtherUnit => None,
        // Nothing is known of a unit under an influence that never acted.
        Change::SilenceInfluence if judged.code < 2 => Some(format!("judged without influence: {line}")),
        _ => wrong,
    };
    (line, wrong)
}

#[test]
fn a_verdict_stays_or_its_change_is_explained() {
    if !crate::support::long::wanted("a_verdict_stays_or_its_change_is_explained") {
        return;
    }
    let cases: Vec<(&Pair, Change)> =
        PAIRS.iter().flat_map(|p| Change::ALL.into_iter().map(move |c| (p, c))).collect();
    let outcomes: Vec<(String, Option<String>)> = cases.par_iter().map(|(p, c)| outcome(p, *c)).collect();
    let lines: Vec<&str> = outcomes.iter().map(|o| o.0.as_str()).collect();
    println!("{}", lines.join("\n"));
    let wrong: Vec<&String> = outcomes.iter().filter_map(|o| o.1.as_ref()).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}
