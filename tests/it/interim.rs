//! A growing recording by a plan of looks.

use crate::support::{altered, limits, measurand, result, sagnac, shipped};
use serde_json::Value;
use std::path::{Path, PathBuf};

const PLAN: &str = "[interim]\nlooks = [\"10 h\", \"25 h\", \"50 h\", \"100 h\"]\n";

/// The static procedure with a table of looks.
fn procedure(folder: &Path, plan: &str) -> String {
    altered(
        folder,
        "p.toml",
        &shipped("procedures/static-bias.toml"),
        &[("[conditions]\n", &format!("{plan}\n[conditions]\n"))],
    )
}

/// The first hours of a sample, which has a row in 10 s, with half an hour of warm-up.
fn beginning(folder: &Path, sample: &str, hours: f64) -> String {
    let text = std::fs::read_to_string(shipped(&format!("samples/{sample}.csv"))).unwrap();
    let rows = ((hours + 0.5) * 360.0) as usize + 2;
    let lines: Vec<&str> = text.lines().take(rows).collect();
    let name = format!("{sample}-{hours}.csv");
    std::fs::write(folder.join(&name), lines.join("\n") + "\n").unwrap();
    name
}

fn run(folder: &Path, procedure: &str, recording: &str, serial: &str) -> Value {
    let out = format!("{recording}.out");
    let said = sagnac(
        folder,
        &[
            "run",
            procedure,
            recording,
            "--limits",
            &limits(),
            "--serial",
            serial,
            "--out",
            &out,
            "--no-store",
        ],
    );
    assert!(said.code < 4, "{}", said.err);
    result(&folder.join(PathBuf::from(out)))
}

#[test]
fn a_look_decides_by_its_own_bound_and_leaves_the_rest_open() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let procedure = procedure(folder, PLAN);
    // 27 h: the second look, and two hours that wait for the third.
    let found = run(folder, &procedure, &beginning(folder, "unit-fail", 27.0), "SN-0001");
    let interim = &found["interim"];
    assert_eq!(interim["look"], 2);
    assert_eq!(interim["looks_s"], serde_json::json!([36e3, 9e4, 18e4, 36e4]));
    assert!((found["window"]["to_s"].as_f64().unwrap() - 91_790.0).abs() < 20.0, "{}", found["window"]);
    let noise = measurand(&found, "angle_random_walk");
    let row = interim["rows"].as_array().unwrap().iter().find(|r| r["id"] == "angle_random_walk").unwrap();
    let shares: Vec<f64> =
        row["information"].as_array().unwrap().iter().map(|t| t.as_f64().unwrap()).collect();
    // White noise: information goes with time.
    assert!((shares[1] - 0.25).abs() < 0.01 && shares[3] == 1.0, "{shares:?}");
    let risk = noise["limit"]["risk"].as_f64().unwrap();
    assert!(risk < 0.001, "{risk}");
    assert_eq!(noise["verdict"], "fail");
    assert_eq!(found["verdict"], "fail");
    assert_eq!(interim["state"], "decided");
    assert!(row["spent_risk"].as_f64().unwrap() < 0.05);
    // What is open is told by the plan and not by its uncertainty.
    assert!(!found["summary"].to_string().contains("row_not_shown"), "{}", found["summary"]);
    // A row without a value waits for the full duration.
    let open = interim["rows"].as_array().unwrap().iter().find(|r| r["state"] == "open").unwrap();
    assert!(open["decidable_s"].as_f64().unwrap() > 9e4);
}

#[test]
fn before_the_first_look_nothing_is_decided_and_the_whole_is_open() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let procedure = procedure(folder, "[interim]\nlooks = [\"20 %\", 0.5, 1.0]\n");
    let found = run(folder, &procedure, &beginning(folder, "unit-fail", 12.0), "SN-0001");
    assert_eq!(found["interim"]["look"], 0);
    assert_eq!(found["interim"]["state"], "open");
    assert_eq!(found["interim"]["next_look_s"], 72e3);
    assert_eq!(found["verdict"], "indeterminate");
    let limited = found["measurands"].as_array().unwrap().iter().filter(|m| !m["limit"].is_null());
    assert!(limited.clone().count() > 3 && limited.into_iter().all(|m| m["verdict"] == "indeterminate"));
}

#[test]
fn a_plan_that_contradicts_the_procedure_is_refused_with_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (looks, reason) in [
        ("[\"50 h\", \"25 h\", \"100 h\"]", "Looks must ascend"),
        ("[\"10 h\", \"50 h\"]", "last look"),
        ("[\"2 h\", \"100 h\"]", "minimum duration"),
        ("[]", "list of times and shares"),
        ("[\"10 deg\", \"100 h\"]", "10 deg"),
        ("[0.5, 1.5]", "1.5"),
        ("\"10 h\"", "list of times and shares"),
    ] {
        let procedure = procedure(folder, &format!("[interim]\nlooks = {looks}\n"));
        let said = sagnac(folder, &["check", &procedure]);
        assert_eq!(said.code, 2, "{looks}: {}", said.out);
        assert!(said.out.contains(reason) && said.out.contains("p.toml:"), "{looks}: {}", said.out);
    }
}

#[test]
fn a_growing_recording_without_a_plan_is_told_to_have_been_looked_at() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let whole = shipped("procedures/static-bias.toml");
    let args = |recording: &str, out: &str| -> Vec<String> {
        [
            "run",
            &whole,
            recording,
            "--limits",
            &limits(),
            "--serial",
            "SN-0001",
            "--out",
            out,
            "--store",
            "store",
        ]
        .iter()
        .map(ToString::to_string)
        .collect()
    };
    assert_eq!(sagnac(folder, &["store", "init", "store"]).code, 0);
    for hours in [11.0, 12.0] {
        let recording = beginning(folder, "unit-pass", hours);
        let args = args(&recording, &format!("r{hours}"));
        sagnac(folder, &args.iter().map(String::as_str).collect::<Vec<_>>());
    }
    let found = result(&folder.join("r12"));
    let told = found["attempt"]["summary"].to_string();
    assert!(told.contains("already evaluated the beginning"), "{told}");
    let first = result(&folder.join("r11"));
    assert!(!first["attempt"]["summary"].to_string().contains("beginning"));
}
