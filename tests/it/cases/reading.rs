//! Files whose clocks, units, layouts and headers were once misread.

use super::input;
use crate::support::{Said, result, sagnac};
use serde_json::Value;

/// Analyses a file of a case; gives what was said and the result.
fn analysed(case: &str, file: &str, more: &[&str]) -> (Said, Value) {
    let folder = tempfile::tempdir().unwrap();
    let path = input(case, file);
    let args = [&["analyze", path.as_str()], more, &["--out", "r"]].concat();
    let said = sagnac(folder.path(), &args);
    assert!(folder.path().join("r").exists(), "{}", said.err);
    let found = result(&folder.path().join("r"));
    (said, found)
}

fn inspected(case: &str, file: &str, more: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = input(case, file);
    let said = sagnac(folder.path(), &[&["inspect", path.as_str()], more].concat());
    assert_eq!(said.code, 0, "{}", said.err);
    said.out
}

/// The angle random walk of the first channel, deg/sqrt(h).
fn walk(found: &Value) -> f64 {
    let rows = found["measurands"].as_array().unwrap();
    let row = rows.iter().find(|m| m["id"] == "angle_random_walk").unwrap();
    row["value"].as_f64().unwrap_or(f64::NAN)
}

#[track_caller]
fn near(found: f64, right: f64) {
    assert!((found / right - 1.0).abs() < 0.15, "{found} instead of {right}");
}

#[test]
fn nanoseconds_since_1970_are_recognised_by_their_size() {
    let (said, found) = analysed("epoch-ns", "imu0.csv", &["--rate", "omega_x", "--unit", "rad/s"]);
    near(walk(&found), 0.58);
    assert!(said.err.contains("ns"), "{}", said.err);
    let text = inspected("epoch-ns", "echo_p.csv", &[]);
    assert!(text.contains("200 Hz"), "{text}");
    assert!(!text.contains("Gyro output `field.orientation.w`"), "{text}");
}

#[test]
fn no_limit_is_drafted_from_years_between_rows() {
    let folder = tempfile::tempdir().unwrap();
    let path = input("epoch-ns", "imu0.csv");
    let draft =
        sagnac(folder.path(), &["init", &path, "--rate", "omega_x", "--unit", "rad/s", "--time-unit", "s"]);
    assert_ne!(draft.code, 0);
    assert!(draft.err.contains("--time-unit"), "{}", draft.err);
}

#[test]
fn minutes_and_halves_of_a_day_are_read() {
    for (file, more) in [("mmss.csv", &[][..]), ("us_ampm.csv", &[]), ("mmss.csv", &["--sample-rate", "2"])] {
        let (_, found) = analysed("clock-text", file, more);
        let rate_hz = 1.0 / found["recording"][0]["sample_interval_s"].as_f64().unwrap();
        assert!((rate_hz - 2.0).abs() < 1e-3, "{file}: {rate_hz}");
        assert_eq!(found["integrity"]["gaps"], 0, "{file}");
    }
    let text = inspected("clock-text", "us_ampm.csv", &[]);
    // 77 °F.
    let temperature = text.lines().find(|l| l.contains("`Temp (F)`") && l.contains("25"));
    assert!(temperature.is_some(), "{text}");
}

#[test]
fn columns_that_count_nothing_are_no_counters() {
    let text = inspected("counter-by-name", "sensor_gyro_0.csv", &[]);
    assert!(text.contains("25 Hz") && !text.contains("sample counter"), "{text}");
}

#[test]
fn a_rate_and_a_counter_of_the_header_are_used() {
    let (said, found) = analysed("rate-in-header", "MT_export.txt", &["--rate", "Gyr_X", "--unit", "rad/s"]);
    near(walk(&found), 0.50);
    assert_eq!(found["integrity"]["missing_samples"], 40);
    assert!(said.err.contains("40 Hz") && said.err.contains("PacketCounter"), "{}", said.err);
}

#[test]
fn sensors_that_take_turns_are_asked_for() {
    let path = input("interleaved-sensors", "IMU.csv");
    let folder = tempfile::tempdir().unwrap();
    let rate = ["--rate", "GyrX", "--unit", "rad/s"];
    let mixed = sagnac(folder.path(), &[&["analyze", path.as_str()], &rate[..]].concat());
    assert_ne!(mixed.code, 0);
    assert!(mixed.err.contains("--where I=0") && mixed.err.contains("--where I=1"), "{}", mixed.err);
    for (value, n) in [("I=0", 0.30), ("I=1", 0.60)] {
        let (_, found) =
            analysed("interleaved-sensors", "IMU.csv", &[&rate[..], &["--where", value]].concat());
        near(walk(&found), n);
    }
    let text = inspected("interleaved-sensors", "IMU.csv", &[]);
    assert!(text.contains("--where I=1") && text.contains("degC"), "{text}");
}

#[test]
fn erased_memory_at_the_end_is_one_fault_and_left_out() {
    let columns = ["--time", "1", "--rate", "5", "--unit", "deg/s"];
    let (said, found) = analysed("erased-flash-tail", "flash.txt", &columns);
    near(walk(&found), 0.50);
    assert!(said.err.contains("601 to 2900") && said.err.contains("--rows 1-600"), "{}", said.err);
    assert_eq!(found["integrity"]["implausible"], 2300);
}

#[test]
fn scales_of_the_header_are_used_and_junk_before_the_data_is_left_out() {
    let (said, found) = analysed("gcsv-header-scales", "esp.gcsv", &[]);
    near(walk(&found), 0.50);
    assert!(said.err.contains("1 to 256") && said.err.contains("gscale"), "{}", said.err);
}

#[test]
fn counts_without_a_sign_are_signed() {
    let more = ["--scale", "0.00763358778625954", "--unit", "deg/s"];
    let (said, found) = analysed("unsigned-counts", "raw.csv", &more);
    near(walk(&found), 0.50);
    assert!(said.err.contains("two's complement"), "{}", said.err);
    let folder = tempfile::tempdir().unwrap();
    let path = input("unsigned-counts", "raw.csv");
    let without = sagnac(folder.path(), &["analyze", &path, "--rate", "2"]);
    assert!(without.err.contains("--scale"), "{}", without.err);
    let draft = sagnac(folder.path(), &[&["init", path.as_str()], &more[..]].concat());
    assert_eq!(draft.code, 0, "{}", draft.err);
    let procedure = std::fs::read_to_string(folder.path().join("procedure.toml")).unwrap();
    assert!(procedure.contains("scale = "), "{procedure}");
}

#[test]
fn units_are_read_as_makers_write_them() {
    let (_, found) = analysed("unit-spelling", "euroc.csv", &[]);
    near(walk(&found), 0.58);
}

#[test]
fn a_name_for_remarks_needs_no_field() {
    let (_, found) = analysed("lvm-comment-column", "bench.lvm", &[]);
    near(walk(&found), 0.050);
}

#[test]
fn that_the_unit_moved_stands_first() {
    let (said, _) = analysed("moved-not-said", "hand.csv", &[]);
    let at = said.out.find("The unit moved from 30").unwrap_or(usize::MAX);
    assert!(at < said.out.find("Static bias").unwrap_or(0), "{}", said.out);
    // What rests at a standstill is not listed row by row.
    let others = said.out.split("Not found or not resolved").nth(1).unwrap_or_default();
    assert!(!others.contains("walk") && !others.contains("instability"), "{}", said.out);
}
