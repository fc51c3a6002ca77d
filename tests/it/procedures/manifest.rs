//! Several files as one recording, by name, by pattern and by manifest; and manifests that cannot be used.

use crate::support::synthetic::white;
use crate::support::{corpus, result, root, sagnac};
use sagnac::config::manifest;
use sagnac::ingest::{ReadOptions, open_recording};
use serde_json::Value;
use std::path::Path;
use tempfile::{TempDir, tempdir};

#[test]
fn broken_manifests_are_reported_at_their_place() {
    let count = corpus::each_problem_at_its_place("manifest", |file| manifest::load(file).unwrap_err().list);
    assert!(count >= 30, "{count} manifests");
}

/// A file of rows `from..to` of one recording of 1 Hz.
fn part(folder: &Path, name: &str, from: u64, to: u64) {
    let rows: String = (from..to).map(|i| format!("{i},{:.4}\n", white(1, i))).collect();
    std::fs::write(folder.join(name), format!("time_s,rate_deg_h\n{rows}")).unwrap();
}

fn three() -> TempDir {
    let dir = tempdir().unwrap();
    part(dir.path(), "part1.csv", 0, 1000);
    part(dir.path(), "part2.csv", 1000, 2500);
    part(dir.path(), "part10.csv", 2500, 4000);
    part(dir.path(), "whole.csv", 0, 4000);
    std::fs::write(
        dir.path().join("manifest.toml"),
        "format = \"manifest/1\"\nserial = \"SN-7\"\nfiles = \"part*.csv\"\n",
    )
    .unwrap();
    dir
}

/// The option that makes several files one recording, where there are several.
fn joined<'a>(recording: &[&'a str]) -> Vec<&'a str> {
    let several = recording.len() > 1 || recording.iter().any(|name| name.contains('*'));
    let option = if several && recording.get(1) != Some(&"--sample-rate") { &["--join"][..] } else { &[] };
    [recording, option].concat()
}

fn analysed(dir: &Path, recording: &[&str]) -> Value {
    let mut args = vec!["analyze"];
    args.extend(joined(recording));
    args.extend(["--out", "a"]);
    let said = sagnac(dir, &args);
    assert_eq!(said.code, 0, "{recording:?}: {said:?}");
    result(&dir.join("a"))
}

/// Sums over blocks of other lengths differ in their last digits.
fn same_figures(a: &Value, b: &Value, within: f64) {
    let (a, b) = (a["measurands"].as_array().unwrap(), b["measurands"].as_array().unwrap());
    assert!(a.len() == b.len() && a.len() > 5);
    for (a, b) in a.iter().zip(b) {
        assert_eq!((&a["id"], &a["identifiable"]), (&b["id"], &b["identifiable"]));
        if let (Some(x), Some(y)) = (a["value"].as_f64(), b["value"].as_f64()) {
            assert!((x - y).abs() <= within * (y.abs() + 1.0), "{a:#} {b:#}");
        }
    }
}

#[test]
fn a_recording_in_parts_gives_the_figures_of_the_whole() {
    let dir = three();
    let whole = analysed(dir.path(), &["whole.csv"]);
    for named in [vec!["part1.csv", "part2.csv", "part10.csv"], vec!["part*.csv"], vec!["manifest.toml"]] {
        let r = analysed(dir.path(), &named);
        same_figures(&r, &whole, 1e-9);
        assert_eq!(r["integrity"]["faults"], whole["integrity"]["faults"], "{named:?}");
        assert_eq!(r["integrity"]["gaps"], 0, "{named:?}");
        let files = r["recording"].as_array().unwrap();
        let told: Vec<(&str, u64, f64)> = files
            .iter()
            .map(|f| {
                let path = f["path"].as_str().unwrap();
                assert_eq!(f["sha256"].as_str().unwrap().len(), 64);
                assert_eq!(f["sample_interval_s"], 1.0);
                (path, f["samples"].as_u64().unwrap(), f["duration_s"].as_f64().unwrap())
            })
            .collect();
        assert_eq!(
            told,
            [("part1.csv", 1000, 1000.0), ("part2.csv", 1500, 1500.0), ("part10.csv", 1500, 1500.0)]
        );
    }
}

#[test]
fn a_gap_at_a_joint_is_counted_and_a_fault_is_told_with_its_file() {
    let dir = three();
    part(dir.path(), "part2.csv", 1007, 2500);
    let r = analysed(dir.path(), &["part*.csv"]);
    assert_eq!((&r["integrity"]["gaps"], &r["integrity"]["missing_samples"]), (&1.into(), &7.into()));
    let fault = &r["integrity"]["faults"][0];
    assert_eq!(
        (&fault["file"], &fault["row"], &fault["kind"]),
        (&"part2.csv".into(), &1.into(), &"gap".into())
    );
}

#[test]
fn overlapping_and_misordered_files_are_located() {
    let dir = three();
    part(dir.path(), "part2.csv", 990, 2500);
    let r = analysed(dir.path(), &["part*.csv"]);
    assert_eq!(
        r["integrity"]["backward_timestamps"].as_u64().unwrap()
            + r["integrity"]["duplicate_timestamps"].as_u64().unwrap(),
        10
    );
    assert_eq!(r["integrity"]["gaps"], 0);
    part(dir.path(), "part2.csv", 1000, 2500);
    let r = analysed(dir.path(), &["part2.csv", "part1.csv"]);
    let faults = r["integrity"]["faults"].as_array().unwrap();
    let told = |f: &Value| f["file"] == "part1.csv" && f["row"] == 1 && f["kind"] == "backward_timestamp";
    assert!(faults.iter().any(told), "{faults:#?}");
    assert_eq!(r["integrity"]["gaps"], 1);
}

#[test]
fn a_contiguous_recording_follows_whatever_the_stamps_say() {
    let dir = three();
    part(dir.path(), "again.csv", 0, 1000);
    let text = "format = \"manifest/1\"\ncontiguous = true\n[[file]]\npath = \"part2.csv\"\n[[file]]\npath = \"again.csv\"\n[[file]]\npath = \"part10.csv\"\n";
    std::fs::write(dir.path().join("m.toml"), text).unwrap();
    let r = analysed(dir.path(), &["m.toml"]);
    for kind in ["gaps", "missing_samples", "backward_timestamps", "duplicate_timestamps"] {
        assert_eq!(r["integrity"][kind], 0, "{kind}");
    }
}

#[test]
fn joints_without_stamps_are_gaps_unless_the_manifest_says_otherwise() {
    let dir = tempdir().unwrap();
    for (name, from) in [("a.csv", 0), ("b.csv", 500)] {
        let rows: String = (from..from + 500).map(|i| format!("{:.4}\n", white(1, i))).collect();
        std::fs::write(dir.path().join(name), format!("rate_deg_h\n{rows}")).unwrap();
    }
    for (contiguous, gaps) in [(false, 1), (true, 0)] {
        let text = format!("format = \"manifest/1\"\ncontiguous = {contiguous}\nfiles = \"?.csv\"\n");
        std::fs::write(dir.path().join("m.toml"), text).unwrap();
        let r = analysed(dir.path(), &["m.toml", "--sample-rate", "1"]);
        assert_eq!(r["integrity"]["gaps"], gaps);
    }
}

fn refused(dir: &Path, recording: &[&str], fragments: &[&str]) {
    let mut args = vec!["analyze"];
    args.extend(joined(recording));
    args.extend(["--out", "refused"]);
    let said = sagnac(dir, &args);
    assert_eq!(said.code, 2, "{said:?}");
    for fragment in fragments {
        assert!(said.err.contains(fragment), "no `{fragment}` in\n{}", said.err);
    }
}

#[test]
fn files_that_do_not_belong_together_are_refused() {
    let dir = three();
    let write = |name: &str, text: &str| std::fs::write(dir.path().join(name), text).unwrap();
    write("extra.csv", "time_s,rate_deg_h,temp_degC\n5000,1,2\n5001,2,2\n");
    refused(dir.path(), &["part1.csv", "extra.csv"], &["extra.csv", "temp_degC", "part1.csv"]);
    refused(dir.path(), &["extra.csv", "part1.csv"], &["part1.csv", "temp_degC", "no column"]);
    write("metres.csv", "time_s,rate_m\n5000,1\n5001,2\n");
    refused(dir.path(), &["part1.csv", "metres.csv"], &["metres.csv"]);
    std::fs::copy(dir.path().join("part1.csv"), dir.path().join("copy.csv")).unwrap();
    refused(dir.path(), &["part1.csv", "part2.csv", "copy.csv"], &["copy.csv", "part1.csv", "byte for byte"]);
    refused(dir.path(), &["part1.csv", "manifest.toml"], &["manifest.toml", "alone"]);
    refused(dir.path(), &["none*.csv"], &["none*.csv", "no file matches"]);
    refused(dir.path(), &["."], &["pattern"]);
    write("wrong.toml", "format = \"manifest/1\"\n[[file]]\npath = \"gone.csv\"\n");
    refused(dir.path(), &["wrong.toml"], &["wrong.toml:3:9", "gone.csv"]);
}

#[test]
fn columns_in_another_order_or_unit_are_put_right() {
    let dir = three();
    let rows: String = (1000..2500).map(|i| format!("{:.9},{i}000\n", white(1, i) / 3600.0)).collect();
    std::fs::write(dir.path().join("part2.csv"), format!("rate [deg/s],time [ms]\n{rows}")).unwrap();
    let (whole, r) = (analysed(dir.path(), &["whole.csv"]), analysed(dir.path(), &["part*.csv"]));
    assert_eq!(r["integrity"]["gaps"], 0, "{:#}", r["integrity"]);
    same_figures(&r, &whole, 1e-3);
}

#[test]
fn the_serial_number_of_the_manifest_counts_and_another_one_is_refused() {
    let dir = three();
    let procedure = crate::support::short_procedure(dir.path());
    let run = |serial: &[&str]| {
        let mut args = vec!["run", &procedure, "manifest.toml", "--out", "r"];
        args.extend(serial);
        sagnac(dir.path(), &args)
    };
    // The procedure asks for a temperature that these files lack; the report is written all the same.
    let said = run(&[]);
    assert_eq!(said.code, 2, "{said:?}");
    assert_eq!(result(&dir.path().join("r"))["unit_under_test"]["serial"], "SN-7");
    let said = run(&["--serial", "SN-8"]);
    assert!(said.code == 2 && said.err.contains("SN-7") && said.err.contains("SN-8"), "{said:?}");
}

#[test]
fn check_and_schema_know_manifests() {
    let dir = three();
    let said = sagnac(dir.path(), &["check", "manifest.toml"]);
    assert!(said.code == 0 && said.out.contains("manifest of 3 files"), "{said:?}");
    std::fs::write(dir.path().join("bad.toml"), "format = \"manifest/1\"\nfiles = \"../*\"\n").unwrap();
    let said = sagnac(dir.path(), &["check", "bad.toml"]);
    assert!(said.code == 2 && said.out.contains("bad.toml:2:10"), "{said:?}");
    let schema: Value = serde_json::from_str(&sagnac(dir.path(), &["schema", "manifest"]).out).unwrap();
    assert_eq!(schema["properties"]["file"]["items"]["required"], serde_json::json!(["path"]));
}

#[cfg(unix)]
#[test]
fn a_link_out_of_the_folder_is_refused() {
    let (dir, outside) = (three(), tempdir().unwrap());
    part(outside.path(), "secret.csv", 0, 10);
    std::os::unix::fs::symlink(outside.path().join("secret.csv"), dir.path().join("link.csv")).unwrap();
    std::os::unix::fs::symlink(outside.path(), dir.path().join("door")).unwrap();
    for path in ["link.csv", "door/secret.csv"] {
        let text = format!("format = \"manifest/1\"\n[[file]]\npath = \"{path}\"\n");
        std::fs::write(dir.path().join("m.toml"), text).unwrap();
        let problems = manifest::load(&dir.path().join("m.toml")).unwrap_err();
        assert!(problems.to_string().contains("link that leads out"), "{problems}");
    }
    std::fs::write(dir.path().join("m.toml"), "format = \"manifest/1\"\nfiles = \"door/*.csv\"\n").unwrap();
    assert!(manifest::load(&dir.path().join("m.toml")).unwrap_err().to_string().contains("leads out"));
}

#[test]
fn a_file_that_changes_after_it_was_opened_is_refused() {
    let dir = three();
    let named = [dir.path().join("part1.csv"), dir.path().join("part2.csv")];
    let recording = open_recording(&named, &ReadOptions::default()).unwrap();
    part(dir.path(), "part2.csv", 1000, 2501);
    let error = recording.source.read(&[1], &mut |_| std::ops::ControlFlow::Continue(())).unwrap_err();
    assert!(error.path().ends_with("part2.csv"), "{error}");
}

#[test]
fn the_guide_of_manifests_is_that_of_their_tables() {
    let path = root().join("docs/guide/manifest.md");
    let text = std::fs::read_to_string(&path).unwrap();
    let (begin, end) = ("<!-- keys -->\n", "<!-- /keys -->");
    let (from, to) = (text.find(begin).unwrap() + begin.len(), text.find(end).unwrap());
    let reference = sagnac::config::procedure::guide::manifest_reference();
    if std::env::var_os("SAGNAC_WRITE_GUIDE").is_some() {
        std::fs::write(&path, format!("{}{reference}{}", &text[..from], &text[to..])).unwrap();
        return;
    }
    assert_eq!(text[from..to], reference, "regenerate with SAGNAC_WRITE_GUIDE=1");
}
