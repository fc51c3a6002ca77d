//! The log of a chamber beside that of a gyro: what is determined does not depend on whether both stand in one file.

use crate::support::pairs::sample_once;
use crate::support::{Said, result, sagnac, shipped};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Seconds by which the clock of the chamber's log is ahead.
const AHEAD_S: f64 = 1234.5;

/// A sample over temperature as two files: the gyro, and every third temperature by a clock that is ahead.
fn split(folder: &Path, sample: &str) {
    let text = fs::read_to_string(shipped(&format!("samples/{sample}.csv"))).unwrap();
    let (mut gyro, mut chamber) = (String::new(), String::from("time_s,temp_degC\n"));
    for (i, line) in text.lines().enumerate() {
        match line.split(',').collect::<Vec<_>>()[..] {
            [time, rate, temperature] => {
                gyro += &format!("{time},{rate}\n");
                if let Ok(s) = time.parse::<f64>()
                    && i % 3 == 0
                {
                    chamber += &format!("{},{temperature}\n", s + AHEAD_S);
                }
            }
            _ => gyro += &format!("{line}\n"),
        }
    }
    fs::write(folder.join("gyro.csv"), gyro).unwrap();
    fs::write(folder.join("chamber.csv"), chamber).unwrap();
}

fn run(folder: &Path, recording: &str, more: &[&str]) -> Said {
    run_of("temperature-soak", folder, recording, more)
}

fn run_of(procedure: &str, folder: &Path, recording: &str, more: &[&str]) -> Said {
    let procedure = shipped(&format!("procedures/{procedure}.toml"));
    let limits = shipped("procedures/limits/sample-temperature.toml");
    let all = ["run", &procedure, recording, "--limits", &limits, "--out", "r", "--force"];
    sagnac(folder, &[&all[..], more].concat())
}

/// The temperature measurands of a result agree with those of another one within their standard uncertainties.
#[track_caller]
fn agree(found: &Value, single: &Value) {
    let rows = |of: &Value| of["measurands"].as_array().unwrap().clone();
    let mut compared = 0;
    for (a, b) in rows(found).iter().zip(rows(single)) {
        assert_eq!(a["id"], b["id"]);
        let end = |key: &str| b["interval"][key].as_f64();
        if let (Some(x), Some(y), Some(low), Some(high)) =
            (a["value"].as_f64(), b["value"].as_f64(), end("low"), end("high"))
        {
            assert!((x - y).abs() <= (0.5 * (high - low)).abs() + 1e-12, "{}: {x} instead of {y}", a["id"]);
            compared += 1;
        }
    }
    assert!(compared > 2, "{compared} rows");
}

#[test]
fn a_temperature_from_a_second_file_gives_the_figures_of_one() {
    let single = sample_once("temperature-soak-pass");
    let folder = tempfile::tempdir().unwrap();
    split(folder.path(), "temperature-soak-pass");
    let said = run(
        folder.path(),
        "gyro.csv",
        &["--serial", "SN-0104", "--source", "chamber.csv", "--source-offset", "-1234.5"],
    );
    assert_eq!(said.code, single.said.code, "{}", said.err);
    agree(&result(&folder.path().join("r")), single.result());

    let manifest = "format = \"manifest/1\"\nserial = \"SN-0104\"\n\n[[file]]\npath = \"gyro.csv\"\n\n\
                    [[source]]\npath = \"chamber.csv\"\ntime_offset = \"-1234.5 s\"\n";
    fs::write(folder.path().join("bench.toml"), manifest).unwrap();
    let said = run(folder.path(), "bench.toml", &[]);
    assert_eq!(said.code, single.said.code, "{}", said.err);
    agree(&result(&folder.path().join("r")), single.result());
}

#[test]
fn a_clock_without_a_tie_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    split(folder.path(), "temperature-soak-pass");
    let said = sagnac(folder.path(), &["inspect", "gyro.csv", "--source", "chamber.csv"]);
    assert_eq!(said.code, 2);
    let named = ["chamber.csv", "gyro.csv", "--source-offset"];
    assert!(named.iter().all(|word| said.err.contains(word)), "{}", said.err);
    let said =
        sagnac(folder.path(), &["inspect", "gyro.csv", "--source", "chamber.csv", "--estimate-offset"]);
    assert!(said.code == 2 && said.err.contains("in common"), "{}", said.err);
}

/// Half the width of the interval of a row, and the row.
fn half_width<'a>(result: &'a Value, id: &str) -> (f64, &'a Value) {
    let row = result["measurands"].as_array().unwrap().iter().find(|m| m["id"] == id).unwrap();
    let end = |key: &str| row["interval"][key].as_f64().unwrap();
    (0.5 * (end("high") - end("low")), row)
}

#[test]
fn the_uncertainty_of_a_clock_is_a_component_of_what_depends_on_it() {
    let folder = tempfile::tempdir().unwrap();
    split(folder.path(), "temperature-pass");
    let ramp = |uncertainty: &str| {
        let source = ["--source", "chamber.csv", "--source-offset=-1234.5"];
        let stated = ["--serial", "SN-0101", "--source-offset-uncertainty", uncertainty];
        let more = [&source[..], &stated[..]].concat();
        let said = run_of("temperature-ramp", folder.path(), "gyro.csv", &more);
        assert_ne!(said.code, 2, "{}", said.err);
        result(&folder.path().join("r"))
    };
    let (known, unsure) = (ramp("0"), ramp("100"));
    // A thermometer that is 100 s late has a coil that lags 100 s less behind it.
    let ((before, _), (after, row)) = (half_width(&known, "thermal_lag"), half_width(&unsure, "thermal_lag"));
    let expected = before.hypot(1.96 * 100.0);
    assert!((after / expected - 1.0).abs() < 0.15, "{before} s and {after} s instead of {expected} s");
    let told = row["notes"].to_string();
    assert!(told.contains("clock_offset_component") && told.contains("chamber.csv"), "{told}");
    // The curve of a slow temperature hardly depends on the clock, the noise not at all.
    let noise = |of: &Value| half_width(of, "angle_random_walk_at_temperature").0;
    assert!((noise(&unsure) / noise(&known) - 1.0).abs() < 0.05);
}
