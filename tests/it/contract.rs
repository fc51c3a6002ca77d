//! What scripts outside the project read: names, types, units and meanings of `result.json` and `sigma_tau.csv`.

use crate::support::schema::{closed, validate};
use crate::support::synthetic::white;
use crate::support::{files, limits, names, procedure, result, sagnac, sagnac_with, sample};
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

fn run(folder: &Path, name: &str) -> Value {
    let args = ["run", &procedure(), &sample(name), "--limits", &limits(), "--serial", "SN-1", "--out", name];
    assert!(sagnac(folder, &args).code != 2, "{name}");
    result(&folder.join(name))
}

/// A recording with three gyro axes.
fn three_axes(folder: &Path) -> String {
    let mut text = String::from("time_s,gyro_x_deg_h,gyro_y_deg_h,gyro_z_deg_h\n");
    for i in 0..4000 {
        let axis = |seed: u64| 3.0 * seed as f64 + 0.1 * white(seed, i);
        text.push_str(&format!("{i},{:.5},{:.5},{:.5}\n", axis(1), axis(2), axis(3)));
    }
    let path = folder.join("three.csv");
    std::fs::write(&path, text).unwrap();
    path.to_string_lossy().into_owned()
}

fn is_number(value: &Value) -> bool {
    value.as_f64().is_some_and(f64::is_finite)
}

fn is_count(value: &Value) -> bool {
    value.as_u64().is_some()
}

fn is_sha256(value: &Value) -> bool {
    value.as_str().is_some_and(|s| s.len() == 64 && s.chars().all(|c| matches!(c, '0'..='9' | 'a'..='f')))
}

fn one_of(value: &Value, words: &[&str]) -> bool {
    value.as_str().is_some_and(|s| words.contains(&s))
}

fn null_or(value: &Value, test: impl Fn(&Value) -> bool) -> bool {
    value.is_null() || test(value)
}

fn check_result(r: &Value) {
    assert_eq!(r["format"], "result/1");
    assert_eq!(r["program"]["name"], "sagnac");
    assert_eq!(r["program"]["version"], env!("CARGO_PKG_VERSION"));
    if !r["procedure"].is_null() {
        assert!(r["procedure"]["id"].is_string() && r["procedure"]["revision"].is_string());
        assert!(is_sha256(&r["procedure"]["sha256"]));
    }
    let unit = r["unit_under_test"].as_object().unwrap();
    assert!(null_or(&unit["serial"], Value::is_string) && null_or(&unit["family"], Value::is_string));
    let recordings = r["recording"].as_array().unwrap();
    assert_eq!(recordings.len(), 1);
    for f in recordings {
        assert!(f["path"].is_string() && is_sha256(&f["sha256"]) && is_count(&f["samples"]), "{f}");
        assert!(is_number(&f["sample_interval_s"]) && is_number(&f["duration_s"]), "{f}");
        assert!(f.get("start").is_some_and(|s| null_or(s, Value::is_string)), "{f}");
    }
    let verdicts = ["none", "pass", "indeterminate", "fail", "error"];
    assert!(one_of(&r["verdict"], &verdicts));
    for c in r["conditions"].as_array().unwrap() {
        assert!(c["id"].is_string() && c["required"].is_string() && c["note"].is_string(), "{c}");
        assert!(one_of(&c["status"], &["ok", "remark", "invalid"]) && c["observed"].is_object(), "{c}");
    }
    check_integrity(&r["integrity"]);
    for m in r["measurands"].as_array().unwrap() {
        check_measurand(m, &verdicts);
    }
}

fn check_integrity(integrity: &Value) {
    for key in [
        "gaps",
        "missing_samples",
        "duplicate_timestamps",
        "backward_timestamps",
        "non_finite",
        "unparsable",
        "outliers",
        "saturated",
        "stuck",
    ] {
        assert!(is_count(&integrity[key]), "{key}");
    }
    let kinds = [
        "gap",
        "duplicate_timestamp",
        "backward_timestamp",
        "non_finite",
        "unparsable",
        "outlier",
        "saturated",
        "stuck",
    ];
    for f in integrity["faults"].as_array().unwrap() {
        assert!(one_of(&f["kind"], &kinds), "{f}");
        assert!(
            f["row"].as_u64().is_some_and(|r| r >= 1) && f["count"].as_u64().is_some_and(|n| n >= 1),
            "{f}"
        );
        assert!(null_or(&f["time_s"], is_number) && f["note"].is_string(), "{f}");
    }
}

fn check_measurand(m: &Value, verdicts: &[&str]) {
    let own = m.as_object().unwrap();
    for key in [
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
    ] {
        assert!(own.contains_key(key), "no `{key}` in {m}");
    }
    assert!(m["id"].is_string() && m["channel"].is_string() && m["method"].is_string(), "{m}");
    assert!(one_of(&m["verdict"], verdicts), "{m}");
    assert_eq!(m["identifiable"].as_bool().unwrap(), is_number(&m["value"]), "{m}");
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
            assert!(null_or(&l["min"], is_number) && null_or(&l["max"], is_number), "{m}");
            assert!(!(l["min"].is_null() && l["max"].is_null()), "{m}");
            assert!(
                null_or(&l["acceptance_min"], is_number) && null_or(&l["acceptance_max"], is_number),
                "{m}"
            );
            assert!(one_of(&l["rule"], &["simple", "guard_band"]) && is_number(&l["risk"]), "{m}");
            assert_eq!(l["unit"], m["unit"], "{m}");
            assert!(l["source"].is_string() && m["verdict"] != "none", "{m}");
        }
        None => assert_eq!(m["verdict"], "none", "{m}"),
    }
}

/// A copy of the sample that passes, which does not state its serial number.
fn without_serial(folder: &Path) -> String {
    let text = std::fs::read_to_string(sample("pass")).unwrap();
    let path = folder.join("no-serial.csv");
    let rows: Vec<&str> = text.lines().filter(|l| !l.starts_with("# serial")).collect();
    std::fs::write(&path, rows.join("\n") + "\n").unwrap();
    path.to_string_lossy().into_owned()
}

#[test]
fn results_hold_every_field_of_the_contract() {
    let dir = tempdir().unwrap();
    for name in ["pass", "fail", "indeterminate", "faults"] {
        let r = run(dir.path(), name);
        check_result(&r);
        let found: Vec<(&str, &str)> = rows(&r).map(|m| (text(&m["id"]), text(&m["unit"]))).collect();
        for row in STATIC.iter().chain(&[("earth_rate_component", "deg/h")]) {
            assert!(found.contains(row), "{name}: {row:?} is not in {found:?}");
        }
    }
    let no_serial = sagnac(dir.path(), &["run", &procedure(), &without_serial(dir.path()), "--out", "e"]);
    assert_eq!(no_serial.code, 2);
    check_result(&result(&dir.path().join("e")));
}

fn rows(result: &Value) -> impl Iterator<Item = &Value> {
    result["measurands"].as_array().unwrap().iter()
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap()
}

#[test]
fn several_channels_repeat_ids_and_have_a_table_each() {
    let dir = tempdir().unwrap();
    let said = sagnac(dir.path(), &["analyze", &three_axes(dir.path()), "--out", "o"]);
    assert_eq!(said.code, 0, "{said:?}");
    let out = dir.path().join("o");
    let r = result(&out);
    check_result(&r);
    let channels = ["gyro_x_deg_h", "gyro_y_deg_h", "gyro_z_deg_h"];
    for (id, unit) in STATIC {
        let found: Vec<(&str, &str)> =
            rows(&r).filter(|m| m["id"] == id).map(|m| (text(&m["channel"]), text(&m["unit"]))).collect();
        assert_eq!(found, channels.map(|c| (c, unit)), "{id}");
    }
    let tables: Vec<String> = names(&out).into_iter().filter(|n| n.starts_with("sigma_tau")).collect();
    assert_eq!(tables, channels.map(|c| format!("sigma_tau_{c}.csv")));
    for table in tables {
        check_table(&out.join(table));
    }
}

/// Every row of a table, checked field by field; gives the estimators back.
fn check_table(path: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(path).unwrap();
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
    let dir = tempdir().unwrap();
    for name in ["pass", "faults"] {
        run(dir.path(), name);
        let table = dir.path().join(name).join("sigma_tau.csv");
        assert_eq!(check_table(&table), ["oadev", "mdev", "hdev", "totdev"], "{name}");
        let text = std::fs::read_to_string(&table).unwrap();
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
    let mut results: Vec<Value> =
        ["pass", "fail", "indeterminate", "faults"].map(|n| run(dir.path(), n)).into();
    assert_eq!(sagnac(dir.path(), &["analyze", &three_axes(dir.path()), "--out", "a"]).code, 0);
    results.push(result(&dir.path().join("a")));
    let late = sagnac(dir.path(), &["analyze", &sample("pass"), "--warm-up", "1e9", "--out", "late"]);
    assert_eq!(late.code, 2);
    results.push(result(&dir.path().join("late")));
    for r in &results {
        validate(&strict, &strict, r, "result").unwrap();
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
    let recording = three_axes(dir.path());
    let mut seen = Vec::new();
    for (name, threads) in [("a", "1"), ("b", "1"), ("c", "2"), ("d", "5")] {
        let home = dir.path().join(name);
        std::fs::create_dir(&home).unwrap();
        let environment = [("RAYON_NUM_THREADS", threads)];
        let run =
            ["run", &procedure(), &sample("faults"), "--limits", &limits(), "--serial", "SN-1", "--out", "r"];
        assert_eq!(sagnac_with(&home, &run, &environment).code, 3);
        assert_eq!(sagnac_with(&home, &["analyze", &recording, "--out", "a"], &environment).code, 0);
        let mut all = Vec::new();
        for part in ["r", "a"] {
            let at = result(&home.join(part))["session"]["evaluated_at"].as_str().unwrap().to_owned();
            let shown = format!("{} {} UTC", &at[..10], &at[11..19]);
            // The hashes are those of files with the clock in them.
            let all_but_hashes =
                files(&home.join(part)).into_iter().filter(|(p, _)| !p.ends_with("SHA256SUMS"));
            for (path, bytes) in all_but_hashes {
                let text = String::from_utf8(bytes).unwrap();
                all.push((part, path, text.replace(&at[..19], "<clock>").replace(&shown, "<clock>")));
            }
        }
        seen.push(all);
    }
    let (first, others) = seen.split_first().unwrap();
    for other in others {
        assert_eq!(first.len(), other.len());
        for (one, two) in first.iter().zip(other) {
            assert!(one == two, "{} {} differs", one.0, one.1.display());
        }
    }
}

/// Every field of a result survives reading and writing, messages in both languages among them.
#[test]
fn results_are_read_back_to_the_last_field() {
    let dir = tempdir().unwrap();
    let mut folders = vec!["pass", "fail", "indeterminate", "faults"];
    for name in &folders {
        run(dir.path(), name);
    }
    assert_eq!(sagnac(dir.path(), &["analyze", &three_axes(dir.path()), "--out", "a"]).code, 0);
    assert_eq!(sagnac(dir.path(), &["run", &procedure(), &without_serial(dir.path()), "--out", "e"]).code, 2);
    folders.extend(["a", "e"]);
    for name in folders {
        let bytes = std::fs::read(dir.path().join(name).join("result.json")).unwrap();
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
