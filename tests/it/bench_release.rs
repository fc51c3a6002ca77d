//! A bench released for today: the check and its samples, and tests that demand it, through the command line.

use crate::support::pairs::sample_once;
use crate::support::{Said, altered, measurand, result, sagnac, shipped};
use sagnac_studies::bench::bench_check::{BenchCheck, reference};
use sagnac_studies::bench::rate_table::RateTable;
use sagnac_studies::bench_checks::STUDY;
use sagnac_studies::study::Verdict;
use serde_json::Value;
use std::fs;
use std::path::Path;
use tempfile::{TempDir, tempdir};

fn good() -> BenchCheck {
    BenchCheck::default()
}

/// A table that turns too slowly for what it states, and thermometers that disagree.
fn bad() -> BenchCheck {
    BenchCheck { table: RateTable { error_ppm: -25.0, ..reference(73) }, difference: 0.6, ..good() }
}

fn files() -> [(&'static str, String); 2] {
    [("samples/bench-check-pass.csv", good().csv()), ("samples/bench-check-fail.csv", bad().csv())]
}

#[test]
fn the_samples_are_what_the_generator_gives() {
    for (path, text) in files() {
        let stands = fs::read_to_string(shipped(path)).unwrap_or_default();
        assert!(stands == text, "{path} differs: write the samples anew");
    }
}

#[test]
#[ignore = "writes the samples: cargo test --test it bench_release -- --ignored write_the_samples"]
fn write_the_samples() {
    for (path, text) in files() {
        fs::write(shipped(path), text).unwrap();
    }
}

#[test]
fn the_check_measures_table_earth_rate_and_thermometers() {
    let passed = sample_once("bench-check-pass").result();
    let truths = [("scale_factor_error", 2.0), ("scale_factor_bias", 0.02), ("thermometer_difference", 0.04)];
    for (id, truth) in truths {
        let row = measurand(passed, id);
        let end = |name: &str| row["interval"][name].as_f64().unwrap_or_else(|| panic!("{row}"));
        assert!((end("low")..=end("high")).contains(&truth), "{row}");
        assert_eq!(row["verdict"], "pass", "{row}");
    }
    let difference = measurand(passed, "thermometer_difference");
    assert_eq!(difference["unit"], "K");
    let inputs: Vec<&str> =
        difference["budget"].as_array().unwrap().iter().map(|c| c["input"].as_str().unwrap()).collect();
    assert_eq!(inputs[0], "thermometer");
    assert!(inputs.contains(&"rounding") && inputs.contains(&"readings"), "{inputs:?}");
    let failed = sample_once("bench-check-fail").result();
    for (id, verdict) in
        [("scale_factor_error", "fail"), ("scale_factor_bias", "pass"), ("thermometer_difference", "fail")]
    {
        assert_eq!(measurand(failed, id)["verdict"], verdict, "{id}");
    }
    assert_eq!(passed["bench"]["releases_for_s"], 86400.0);
    // Nobody named the bench: the check releases nothing, and says so.
    assert!(passed["bench"]["released_until"].is_null());
    assert_eq!(condition(passed)["status"], "remark");
}

/// The condition of the bench.
fn condition(result: &Value) -> &Value {
    let all = result["conditions"].as_array().unwrap();
    all.iter().find(|c| c["id"] == "bench").unwrap_or_else(|| panic!("no condition of the bench"))
}

/// A folder with recordings of a morning, a noon and an evening, and a procedure that demands a bench released within 12 h.
fn laboratory() -> TempDir {
    let folder = tempdir().unwrap();
    for (name, day, hour) in [
        ("morning", "2026-11-24", 6),
        ("forenoon", "2026-11-24", 9),
        ("noon", "2026-11-24", 12),
        ("night", "2026-11-24", 19),
    ] {
        let csv = BenchCheck { date: (day, hour), ..good() }.csv();
        fs::write(folder.path().join(format!("{name}.csv")), csv).unwrap();
    }
    fs::write(folder.path().join("bad.csv"), BenchCheck { date: ("2026-11-24", 10), ..bad() }.csv()).unwrap();
    let changes = [
        ("id = \"bench-check\"", "id = \"table-test\""),
        ("releases_for = \"24 h\"", "name = \"TABLE-3\"\nreleased_within = \"12 h\""),
    ];
    altered(folder.path(), "test.toml", &shipped("procedures/bench-check.toml"), &changes);
    folder
}

fn check(folder: &Path, recording: &str, bench: &str, out: &str, more: &[&str]) -> Said {
    let recording = format!("{recording}.csv");
    let mut args = vec!["run", "bench-check", &recording, "--serial", "REF-1", "--station", bench];
    args.extend(["--out", out]);
    args.extend(more);
    sagnac(folder, &args)
}

fn test(folder: &Path, recording: &str, out: &str, more: &[&str]) -> (i32, Value) {
    let recording = format!("{recording}.csv");
    let mut args = vec!["run", "test.toml", &recording, "--serial", "SN-1", "--out", out];
    args.extend(more);
    let said = sagnac(folder, &args);
    assert!(said.code != 2, "{said:?}");
    (said.code, result(&folder.join(out)))
}

fn refused(folder: &Path, recording: &str, out: &str, more: &[&str], says: &str) {
    let (code, result) = test(folder, recording, out, more);
    let condition = condition(&result);
    assert_eq!((code, condition["status"].as_str()), (3, Some("invalid")), "{condition}");
    assert!(condition["note"].as_str().unwrap().contains(says), "{says}: {condition}");
    let report = fs::read_to_string(folder.join(out).join("report.md")).unwrap();
    assert!(report.contains("Bench released"), "{report}");
}

#[test]
fn a_test_demands_the_release_and_finds_it_in_the_store() {
    let laboratory = laboratory();
    let folder = laboratory.path();
    assert_eq!(sagnac(folder, &["store", "init", "s"]).code, 0);
    let store = ["--store", "s"];
    refused(folder, "noon", "nobody", &["--no-store"], "neither");
    refused(folder, "noon", "none", &store, "No result of");
    assert_eq!(check(folder, "forenoon", "TABLE-4", "other", &store).code, 0);
    refused(folder, "noon", "elsewhere", &store, "TABLE-4");
    let said = check(folder, "morning", "table-3", "released", &store);
    assert_eq!(said.code, 0, "{said:?}");
    assert_eq!(result(&folder.join("released"))["bench"]["released_until"], "2026-11-25T06:14:18Z");
    let (code, found) = test(folder, "noon", "tested", &store);
    assert_eq!((code, condition(&found)["status"].as_str()), (0, Some("ok")), "{}", condition(&found));
    assert_eq!(found["bench"]["check"]["verdict"], "pass");
    let age = condition(&found)["observed"]["age_h"].as_f64().unwrap();
    assert!((age - 5.762).abs() < 0.01, "{age}");
    // 12.8 h after the check, and before it.
    refused(folder, "night", "late", &store, "held for");
    refused(folder, "morning", "before", &store, "ended after");
    // A failed check takes the release back from then on, not for what was recorded before it.
    assert_eq!(check(folder, "bad", "TABLE-3", "failed", &store).code, 1);
    refused(folder, "noon", "taken-back", &store, "fail");
    assert_eq!(test(folder, "forenoon", "earlier", &store).0, 0);
}

#[test]
fn a_named_check_counts_only_as_it_was_written() {
    let laboratory = laboratory();
    let folder = laboratory.path();
    assert_eq!(check(folder, "morning", "TABLE-3", "c", &["--no-store"]).code, 0);
    let named = ["--no-store", "--bench-check", "c"];
    assert_eq!(test(folder, "noon", "good", &named).0, 0);
    // The result is computed again from its recording with the check that it names.
    let said = sagnac(folder, &["verify", "good", "--recording", "noon.csv"]);
    assert!(said.code == 0, "{said:?}");
    refused(folder, "noon", "own", &["--no-store", "--bench-check", "good"], "is no check");
    fs::create_dir(folder.join("c/signatures")).unwrap();
    fs::write(folder.join("c/signatures/01-tested.json"), "{}").unwrap();
    refused(folder, "noon", "forged", &named, "not what was written");
    fs::remove_dir_all(folder.join("c/signatures")).unwrap();
    assert_eq!(test(folder, "noon", "again", &named).0, 0);
    let file = folder.join("c/result.json");
    let text = fs::read_to_string(&file).unwrap();
    fs::write(&file, text.replacen("\"releases_for_s\": 86400.0", "\"releases_for_s\": 864000.0", 1))
        .unwrap();
    refused(folder, "noon", "changed", &named, "result.json");
    let said = sagnac(folder, &["run", "test.toml", "noon.csv", "--serial", "1", "--bench-check", "nowhere"]);
    assert!(said.code == 2 && said.err.contains("nowhere"), "{said:?}");
}

#[test]
fn a_recording_without_a_date_is_said_to_have_none() {
    let laboratory = laboratory();
    let folder = laboratory.path();
    let changed = [("column = \"time\"", "column = \"time_s\"")];
    altered(folder, "test.toml", &folder.join("test.toml").display().to_string(), &changed);
    let noon = fs::read_to_string(folder.join("noon.csv")).unwrap();
    let rows = noon.lines().skip(1).enumerate().map(|(i, row)| {
        let rest = row.split_once(',').unwrap().1;
        format!("{:.1},{rest}\n", i as f64 / 5.0)
    });
    let header = noon.lines().next().unwrap().replacen("time", "time_s", 1);
    fs::write(folder.join("undated.csv"), format!("{header}\n{}", rows.collect::<String>())).unwrap();
    // Of a day long ago: the evaluation of today is too late for it.
    assert_eq!(check(folder, "morning", "TABLE-3", "c", &["--no-store"]).code, 0);
    let (code, found) = test(folder, "undated", "o", &["--no-store", "--bench-check", "c"]);
    let age = condition(&found)["observed"]["age_h"].as_f64();
    let told = condition(&found)["note"].as_str().unwrap();
    match age {
        // The clock of the computer is before the day of the check.
        None => assert!(code == 3 && told.contains("ended after"), "{told}"),
        Some(age) if age > 12.0 => assert!(code == 3 && told.contains("held for"), "{told}"),
        Some(_) => assert!(code == 0 && told.contains("no date"), "{told}"),
    }
}

#[test]
fn intervals_of_a_check_hold_and_a_bench_at_its_limit_is_not_released() {
    let cases = (STUDY.cases)();
    assert_eq!(cases.len(), 8);
    for case in cases {
        let rows = (case.run)(6, 7);
        assert_eq!(rows.iter().filter(|r| r.of == 6).count(), rows.len(), "{}", case.name);
        for row in rows {
            assert!(row.verdict != Verdict::Misses, "{}: {row:?}", case.name);
        }
    }
}

#[test]
fn tables_of_a_bench_that_say_nothing_or_too_much_are_refused() {
    let folder = tempdir().unwrap();
    let shipped = shipped("procedures/bench-check.toml");
    for (from, to, says) in [
        ("releases_for = \"24 h\"", "name = \"A\"", "neither checked nor demanded"),
        ("releases_for = \"24 h\"", "releases_for = \"24 h\"\nreleased_within = \"24 h\"", "cannot rest on"),
        ("releases_for = \"24 h\"", "released_within = \"24 h\"", "no check of its own bench"),
        ("reference = \"temp_reference\"", "reference = \"temp\"", "compared with itself"),
        ("reference = \"temp_reference\"", "reference = \"temp_referense\"", "temp_reference"),
        ("reference = \"temp_reference\"", "reference = \"table\"", "temperature"),
        ("id = \"thermometer_difference\"", "id = \"static_bias\"", "quantity of the program"),
        ("min = \"-0.3 K\"", "min = \"-0.3 V\"", "K"),
    ] {
        altered(folder.path(), "p.toml", &shipped, &[(from, to)]);
        let said = sagnac(folder.path(), &["check", "p.toml"]);
        assert!(said.code != 0 && (said.out.clone() + &said.err).contains(says), "{to}: {said:?}");
    }
}
