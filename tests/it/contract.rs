//! What scripts outside the project read: names, types, units and meanings of `result.json` and `sigma_tau.csv`.

use crate::support::schema::{closed, validate};
use crate::support::shared::{SharedRun, shared, shared_input, tested_once};
use crate::support::synthetic::white;
use crate::support::{limits, names, procedure, sagnac, sagnac_with, sample, steady_files};
use sagnac::record::{RunKind, read};
use serde_json::Value;
use std::path::Path;
use tempfile::tempdir;

const HEADER: &str = "estimator,tau_s,m,n,stride,deviation_deg_h,low_deg_h,high_deg_h,edf,noise_type";

/// Measurands of the static test with their units.
const STATIC: [(&str, &str); 14] = [
    ("static_bias", "deg/h"),
    ("angle_random_walk", "deg/sqrt(h)"),
    ("bias_instability", "deg/h"),
    ("bias_instability_minimum", "deg/h"),
    ("bias_instability_minimum_scaled", "deg/h"),
    ("rate_random_walk", "deg/h/sqrt(h)"),
    ("rate_ramp", "deg/h/h"),
    ("quantization", "arcsec"),
    ("russian_drift_100s", "deg/h"),
    ("russian_drift_100s_3sigma", "deg/h"),
    ("russian_sigma_10s", "deg/h"),
    ("russian_arw_10s", "deg/sqrt(h)"),
    ("line_frequency", "Hz"),
    ("line_amplitude", "deg/h"),
];

/// Fields that scripts read, of a result, of its first recording, of a condition, of a fault and of a row.
const FIELDS: [(&str, &[&str]); 5] = [
    (
        "",
        &[
            "format",
            "program",
            "procedure",
            "unit_under_test",
            "session",
            "recording",
            "verdict",
            "conditions",
            "integrity",
            "measurands",
        ],
    ),
    ("/recording/0", &["path", "sha256", "samples", "sample_interval_s", "start", "duration_s"]),
    ("/conditions/0", &["id", "status", "required", "observed", "note"]),
    ("/integrity/faults/0", &["kind", "row", "count", "time_s", "note"]),
    (
        "/measurands/0",
        &[
            "id",
            "channel",
            "value",
            "unit",
            "interval",
            "identifiable",
            "upper_limit",
            "method",
            "limit",
            "verdict",
        ],
    ),
];

/// A recording with three gyro axes, analysed.
fn three_axes() -> &'static SharedRun {
    shared(&["analyze", &recording_of_three_axes()], "a")
}

fn recording_of_three_axes() -> String {
    shared_input("three.csv", || {
        let mut text = String::from("time_s,gyro_x_deg_h,gyro_y_deg_h,gyro_z_deg_h\n");
        for i in 0..4000 {
            let axis = |seed: u64| 3.0 * seed as f64 + 0.1 * white(seed, i);
            text.push_str(&format!("{i},{:.5},{:.5},{:.5}\n", axis(1), axis(2), axis(3)));
        }
        text
    })
}

/// The sample that passes, tested without a serial number: an error.
fn without_serial() -> &'static SharedRun {
    let recording = shared_input("no-serial.csv", || {
        let text = std::fs::read_to_string(sample("pass")).unwrap();
        text.lines().filter(|l| !l.starts_with("# serial")).map(|l| format!("{l}\n")).collect()
    });
    shared(&["run", &procedure(), &recording], "r")
}

/// Results of every verdict, of several channels, and of a recording that ends before its warm-up does.
fn results() -> [(&'static str, &'static SharedRun); 7] {
    [
        ("pass", tested_once("pass")),
        ("fail", tested_once("fail")),
        ("indeterminate", tested_once("indeterminate")),
        ("faults", tested_once("faults")),
        ("three axes", three_axes()),
        ("without serial", without_serial()),
        ("late", shared(&["analyze", &sample("pass"), "--warm-up", "1e9"], "late")),
    ]
}

/// What holds of a row beyond its types, which the schema has.
fn check_measurand(m: &Value) {
    assert_eq!(m["identifiable"].as_bool().unwrap(), m["value"].is_number(), "{m}");
    if m["identifiable"] == true {
        assert!(m["upper_limit"].is_null(), "{m}");
    } else {
        assert!(m["value"].is_null() && m["interval"].is_null(), "{m}");
    }
    if let Some(i) = m["interval"].as_object() {
        let (low, value, high) =
            (i["low"].as_f64().unwrap(), m["value"].as_f64().unwrap(), i["high"].as_f64().unwrap());
        assert!(low <= value && value <= high && i["coverage"] == 0.95, "{m}");
    }
    if let Some(u) = m["upper_limit"].as_object() {
        assert!(u["value"].as_f64().unwrap() > 0.0 && u["coverage"] == 0.95, "{m}");
    }
    match m["limit"].as_object() {
        Some(l) => {
            assert!(!(l["min"].is_null() && l["max"].is_null()), "{m}");
            assert_eq!(l["unit"], m["unit"], "{m}");
            assert_ne!(m["verdict"], "none", "{m}");
        }
        None => assert_eq!(m["verdict"], "none", "{m}"),
    }
}

#[test]
fn results_hold_every_field_of_the_contract() {
    let faults = tested_once("faults").result();
    for (place, fields) in FIELDS {
        let of = faults.pointer(place).unwrap().as_object().unwrap();
        fields.iter().for_each(|field| assert!(of.contains_key(*field), "no `{field}` in {place}"));
    }
    for (name, run) in results() {
        let r = run.result();
        assert_eq!((&r["format"], &r["program"]["name"]), (&"result/1".into(), &"sagnac".into()), "{name}");
        assert_eq!(r["program"]["version"], env!("CARGO_PKG_VERSION"), "{name}");
        let hashes = r["recording"].as_array().unwrap().iter().map(|f| &f["sha256"]);
        let procedure = (!r["procedure"].is_null()).then(|| &r["procedure"]["sha256"]);
        for hash in hashes.chain(procedure) {
            let is_digit = |c: char| c.is_ascii_digit() || matches!(c, 'a'..='f');
            assert!(
                hash.as_str().is_some_and(|s| s.len() == 64 && s.chars().all(is_digit)),
                "{name}: {hash}"
            );
        }
        for f in r["integrity"]["faults"].as_array().unwrap() {
            assert!(f["row"].as_u64() >= Some(1) && f["count"].as_u64() >= Some(1), "{name}: {f}");
        }
        rows(r).for_each(check_measurand);
        let samples = ["pass", "fail", "indeterminate", "faults"];
        for row in STATIC.iter().chain(&[("earth_rate_component", "deg/h")]) {
            let found = rows(r).any(|m| (text(&m["id"]), text(&m["unit"])) == *row);
            assert!(found || !samples.contains(&name), "{name}: {row:?} is missing");
        }
    }
    assert_eq!(without_serial().said.code, 2);
}

fn rows(result: &Value) -> impl Iterator<Item = &Value> {
    result["measurands"].as_array().unwrap().iter()
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap()
}

#[test]
fn several_channels_repeat_ids_and_have_a_table_each() {
    let run = three_axes();
    assert_eq!(run.said.code, 0, "{:?}", run.said);
    let channels = ["gyro_x_deg_h", "gyro_y_deg_h", "gyro_z_deg_h"];
    for (id, unit) in STATIC {
        let found: Vec<(&str, &str)> = rows(run.result())
            .filter(|m| m["id"] == id)
            .map(|m| (text(&m["channel"]), text(&m["unit"])))
            .collect();
        assert_eq!(found, channels.map(|c| (c, unit)), "{id}");
    }
    let tables: Vec<String> = names(&run.out).into_iter().filter(|n| n.starts_with("sigma_tau")).collect();
    assert_eq!(tables, channels.map(|c| format!("sigma_tau_{c}.csv")));
    for table in tables {
        check_table(&run.text(&table));
    }
}

/// Every row of a table, checked field by field; gives the estimators back.
fn check_table(text: &str) -> Vec<String> {
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some(HEADER));
    let mut estimators: Vec<String> = Vec::new();
    for line in lines {
        let fields: Vec<&str> = line.split(',').collect();
        assert_eq!(fields.len(), 10, "{line}");
        assert!(["oadev", "mdev", "hdev", "totdev"].contains(&fields[0]), "{line}");
        let f = |i: usize| fields[i].parse::<f64>().unwrap_or_else(|_| panic!("{line}"));
        let whole = |i: usize| fields[i].parse::<u64>().unwrap_or_else(|_| panic!("{line}"));
        assert!(f(1) > 0.0 && whole(2) >= 1 && whole(3) >= 1 && whole(4) >= 1, "{line}");
        assert!(whole(4) <= whole(2), "a stride beyond m: {line}");
        assert!(f(5).is_finite() && f(5) > 0.0, "{line}");
        if !fields[6].is_empty() {
            assert!(0.0 < f(6) && f(6) <= f(5) && f(5) <= f(7) && f(8) > 0.0, "{line}");
        }
        assert!(!fields[9].is_empty(), "{line}");
        estimators.push(fields[0].to_owned());
    }
    estimators.dedup();
    estimators
}

#[test]
fn sigma_tau_tables_follow_the_contract() {
    for name in ["pass", "faults"] {
        let text = tested_once(name).text("sigma_tau.csv");
        assert_eq!(check_table(&text), ["oadev", "mdev", "hdev", "totdev"], "{name}");
        let bounded = text.lines().skip(1).filter(|l| !l.split(',').nth(6).unwrap().is_empty()).count();
        assert!(bounded * 10 >= 9 * (text.lines().count() - 1), "nearly every point has an interval");
        assert!(text.lines().skip(1).all(|l| l.split(',').nth(4) == Some("1")), "short records: stride 1");
    }
}

#[test]
fn results_follow_the_schema_and_the_schema_describes_every_field() {
    let dir = tempdir().unwrap();
    let schema: Value = serde_json::from_str(&sagnac(dir.path(), &["schema", "result"]).out).unwrap();
    let strict = closed(&schema);
    assert_eq!(results().map(|(_, run)| run.said.code), [0, 1, 3, 3, 0, 2, 2]);
    for (name, run) in results() {
        let r = run.result();
        validate(&strict, &strict, r, name).unwrap();
        // The check can fail: without a verdict, with a wrong one, with a count that is none.
        for (pointer, wrong) in [("/verdict", "good"), ("/integrity/gaps", "many"), ("/program", "sagnac")] {
            let mut broken = r.clone();
            *broken.pointer_mut(pointer).unwrap() = wrong.into();
            assert!(validate(&schema, &schema, &broken, "result").is_err(), "{pointer}");
        }
        let mut broken = r.clone();
        broken.as_object_mut().unwrap().remove("measurands");
        assert!(validate(&schema, &schema, &broken, "result").is_err());
    }
}

#[test]
fn the_same_run_gives_the_same_bytes_on_any_number_of_threads() {
    let dir = tempdir().unwrap();
    let recording = recording_of_three_axes();
    let tested = steady_files(&tested_once("faults").out);
    let analysed = steady_files(&three_axes().out);
    for threads in ["1", "5"] {
        let environment = [("RAYON_NUM_THREADS", threads)];
        let run =
            ["run", &procedure(), &sample("faults"), "--limits", &limits(), "--serial", "SN-1", "--out", "r"];
        assert_eq!(sagnac_with(dir.path(), &run, &environment).code, 3);
        assert_eq!(sagnac_with(dir.path(), &["analyze", &recording, "--out", "a"], &environment).code, 0);
        for (out, expected) in [("r", &tested), ("a", &analysed)] {
            let found = steady_files(&dir.path().join(out));
            assert_eq!(found.len(), expected.len());
            for (one, two) in found.iter().zip(expected) {
                assert!(one == two, "{threads}: {out}: {} differs", one.0.display());
            }
        }
    }
}

/// Every field of a result survives reading and writing, messages in both languages among them.
#[test]
fn results_are_read_back_to_the_last_field() {
    for (name, run) in results() {
        let bytes = std::fs::read(run.out.join("result.json")).unwrap();
        let record = read::from_slice(&bytes).unwrap_or_else(|e| panic!("{name}: {e}"));
        let mut written: Value = serde_json::from_slice(&bytes).unwrap();
        // What the folder holds and was made from is added where the folder is written, and is no part of the record.
        for key in ["files", "inputs"] {
            assert!(written.as_object_mut().unwrap().remove(key).is_some(), "{name}: {key}");
        }
        assert_eq!(serde_json::to_value(&record).unwrap(), written, "{name}");
    }
}

/// A result from before messages kept how arguments are presented: the same values, numbers shown by the default.
#[test]
fn a_result_without_presentations_is_read() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/fixtures/results/static-bias-without-presentation.json");
    let record = read::from_slice(&std::fs::read(path).unwrap()).unwrap();
    assert_eq!(record.format, "result/1");
    assert_eq!(record.kind, RunKind::Run);
    assert!(!record.measurands.is_empty() && !record.conditions.is_empty());
}
