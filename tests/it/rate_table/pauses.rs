//! Files of one position or one step each: what lies between them is no gap.

use super::root;
use super::runs::run;
use serde_json::Value;
use std::fmt::Write;
use std::path::Path;

/// The sample in positions as a file each, 20 s apart or each with a clock of its own, without some rows of the second.
fn in_files(folder: &Path, own_clock: bool, lost: std::ops::Range<usize>) -> (i32, Value) {
    let procedure = {
        let text = std::fs::read_to_string(root("procedures/multi-position.toml")).unwrap();
        let mut out = String::new();
        let mut at = 0;
        for line in text.lines() {
            if line.starts_with("from = ") {
                let _ = writeln!(out, "phase = \"p{at}\"");
                at += 1;
            } else if !line.starts_with("to = ") {
                let _ = writeln!(out, "{line}");
            }
        }
        assert_eq!(at, 4);
        out
    };
    let sample = std::fs::read_to_string(root("samples/multi-position-pass.csv")).unwrap();
    let rows: Vec<&str> = sample.lines().skip(1).collect();
    let mut manifest = String::from("format = \"manifest/1\"\nseveral_phases = true\n");
    for (i, part) in rows.chunks(600).enumerate() {
        let mut text = String::from("time_s,rate_deg_h\n");
        for (k, row) in part.iter().enumerate().filter(|(k, _)| i != 1 || !lost.contains(k)) {
            let stamp = if own_clock { k + 3 } else { 620 * i + k };
            let _ = writeln!(text, "{stamp},{}", row.split(',').nth(1).unwrap());
        }
        std::fs::write(folder.join(format!("p{i}.csv")), text).unwrap();
        let _ = writeln!(manifest, "[[file]]\npath = \"p{i}.csv\"\nphase = \"p{i}\"");
    }
    std::fs::write(folder.join("procedure.toml"), procedure).unwrap();
    std::fs::write(folder.join("manifest.toml"), manifest).unwrap();
    run(&folder.join("procedure.toml"), &folder.join("manifest.toml"))
}

fn counted(result: &Value) -> [u64; 3] {
    ["gaps", "missing_samples", "backward_timestamps"].map(|id| result["integrity"][id].as_u64().unwrap())
}

#[test]
fn pauses_between_the_files_of_positions_are_no_gaps_and_gaps_within_them_are() {
    for own_clock in [false, true] {
        let folder = tempfile::tempdir().unwrap();
        let (code, result) = in_files(folder.path(), own_clock, 0..0);
        assert_eq!((code, counted(&result)), (0, [0, 0, 0]), "{}", result["summary"]);
        let left_out = result["window"]["excluded"].as_array().unwrap();
        assert!(left_out.len() == 3 && left_out.iter().all(|s| s["reason"] == "pause"), "{left_out:?}");
        let said = result["conditions"].as_array().unwrap();
        assert!(said.iter().any(|c| c["message"]["id"] == "time_base.pauses"), "{said:?}");

        let (code, result) = in_files(folder.path(), own_clock, 200..230);
        assert_eq!((code, counted(&result)), (3, [1, 30, 0]), "{}", result["summary"]);
    }
}

#[test]
fn a_joint_of_a_test_at_rest_stays_a_gap() {
    let folder = tempfile::tempdir().unwrap();
    let sample = std::fs::read_to_string(root("samples/unit-pass.csv")).unwrap();
    let lines: Vec<&str> = sample.lines().collect();
    let head = lines.iter().position(|l| l.starts_with(|c: char| c.is_ascii_digit())).unwrap();
    let middle = lines.len() / 2;
    let write = |name: &str, rows: &[&str]| {
        let text = [&lines[..head], rows].concat().join("\n");
        std::fs::write(folder.path().join(name), text + "\n").unwrap();
    };
    write("a.csv", &lines[head..middle]);
    write("b.csv", &lines[middle + 30..]);
    let manifest = "format = \"manifest/1\"\n[[file]]\npath = \"a.csv\"\n[[file]]\npath = \"b.csv\"\n";
    std::fs::write(folder.path().join("manifest.toml"), manifest).unwrap();
    let (_, result) = run(&root("procedures/static-bias.toml"), &folder.path().join("manifest.toml"));
    assert_eq!(counted(&result)[..2], [1, 30]);
}
