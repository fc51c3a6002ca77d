//! Results with no more than the fields of the contract.

use crate::datasheet::{bound, notes, quantity, sheet};
use crate::support::{Said, sagnac};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use tempfile::tempdir;

fn result(serial: &str, lot: &str, measurands: &Value) -> Value {
    json!({
        "format": "result/1",
        "procedure": {"id": "p", "revision": "A"},
        "unit_under_test": {"serial": serial, "model": "M-1", "lot": lot},
        "verdict": "pass",
        "measurands": measurands,
    })
}

fn walk(value: f64, relative: f64) -> Value {
    let interval = json!({"low": value * (-1.96 * relative).exp(), "high": value * (1.96 * relative).exp(), "coverage": 0.95});
    json!({"id": "angle_random_walk", "channel": "rate", "unit": "deg/sqrt(h)", "value": value, "interval": interval})
}

fn write(dir: &Path, name: &str, value: &Value) {
    fs::write(dir.join(name), value.to_string()).unwrap();
}

fn run(dir: &Path, more: &[&str]) -> Said {
    sagnac(dir, &[&["datasheet", "*.json", "--lang", "en", "--out", "sheet"], more].concat())
}

/// The 18 values of the published example of STAT-17 in CMH-17.
const STAT_17: [f64; 18] = [
    137.4438, 139.5395, 150.89, 141.4474, 141.8203, 151.8821, 143.9245, 132.9732, 136.6419, 138.1723,
    148.7668, 143.283, 143.5429, 141.7023, 137.4732, 152.338, 144.1589, 128.5218,
];

#[test]
fn exact_values_have_the_published_bound() {
    let dir = tempdir().unwrap();
    for (i, value) in STAT_17.into_iter().enumerate() {
        // Of a quantity with a sign, which has a lower bound.
        let row = json!([{"id": "static_bias", "channel": "rate", "unit": "deg/h", "value": value,
            "interval": {"low": value - 1e-6, "high": value + 1e-6, "coverage": 0.95}}]);
        write(dir.path(), &format!("{i:02}.json"), &result(&format!("S{i}"), "1", &row));
    }
    for (proportion, published) in [("0.90", 129.290), ("0.99", 120.355)] {
        let said = run(dir.path(), &["--proportion", proportion]);
        assert_eq!(said.code, 0, "{said:?}");
        let found = sheet(&dir.path().join("sheet"));
        let bias = quantity(&found, "static_bias");
        assert!((bound(bias, "true", "lower") - published).abs() < 6e-4, "{bias}");
        assert_eq!(bias["scale"], "linear");
        assert_eq!(bias["largest"]["serial"], "S15");
        assert!(notes(&found).contains(&"datasheet.note.all_pass".to_owned()));
        assert!(notes(&found).contains(&"datasheet.note.one_lot".to_owned()));
    }
}

#[test]
fn bounded_units_count_and_are_no_values() {
    let dir = tempdir().unwrap();
    for i in 0..20_u32 {
        let value = 0.002 * (0.1 * f64::from(i % 10) - 0.45).exp();
        let row = if i % 10 < 3 {
            json!([{"id": "bias_instability", "channel": "rate", "unit": "deg/h", "identifiable": false,
                "value": null, "upper_limit": {"value": 0.0018, "coverage": 0.95}}])
        } else {
            json!([{"id": "bias_instability", "channel": "rate", "unit": "deg/h", "value": value,
                "interval": {"low": 0.9 * value, "high": 1.1 * value, "coverage": 0.95}}])
        };
        write(dir.path(), &format!("{i:02}.json"), &result(&format!("S{i}"), &format!("L{}", i % 6), &row));
    }
    let said = run(dir.path(), &[]);
    assert_eq!(said.code, 0, "{said:?}");
    let found = sheet(&dir.path().join("sheet"));
    let b = quantity(&found, "bias_instability");
    assert_eq!((&b["units"], &b["bounded"], &b["lots"]), (&20.into(), &6.into(), &6.into()));
    assert!(b["spread"]["between_lots"].is_number(), "{b}");
    let typical = b["typical"]["value"].as_f64().unwrap();
    assert!((0.0016..0.0022).contains(&typical), "{b}");
    assert!(bound(b, "true", "upper") > 0.0027, "{b}");
    assert!(notes(b).contains(&"datasheet.note.bounded".to_owned()));
    let shown = b["values"].as_array().unwrap().iter().filter(|v| v["value"].is_null()).count();
    assert_eq!(shown, 6);
}

#[test]
fn few_units_promise_nothing_and_the_sheet_says_how_many_would() {
    let dir = tempdir().unwrap();
    for i in 0..3 {
        let row = json!([walk(0.002 + 0.0001 * f64::from(i), 0.02)]);
        write(dir.path(), &format!("{i}.json"), &result(&format!("S{i}"), "1", &row));
    }
    let said = run(dir.path(), &[]);
    assert_eq!(said.code, 0, "{said:?}");
    let found = sheet(&dir.path().join("sheet"));
    let n = quantity(&found, "angle_random_walk");
    assert!(n["typical"].is_null() && n["bounds"].as_array().unwrap().is_empty(), "{n}");
    let note = n["notes"][0]["text"].as_str().unwrap();
    assert!(note.contains('5') && notes(n) == ["datasheet.note.too_few"], "{note}");
}

#[test]
fn broken_files_are_named_and_the_others_go_on() {
    let dir = tempdir().unwrap();
    for i in 0..6 {
        let row = json!([walk(0.002 + 0.0001 * f64::from(i), 0.02)]);
        write(dir.path(), &format!("{i}.json"), &result(&format!("S{i}"), "1", &row));
    }
    fs::write(dir.path().join("cut.json"), "{\"format\": \"result/1\"").unwrap();
    write(
        dir.path(),
        "nameless.json",
        &json!({"format": "result/1", "unit_under_test": {}, "verdict": "pass", "measurands": []}),
    );
    write(dir.path(), "other.json", &json!({"format": "other/1"}));
    // The same unit once more: of two without a moment the later named one counts.
    let row = json!([walk(0.009, 0.02)]);
    write(dir.path(), "z.json", &result("S5", "1", &row));
    let said = run(dir.path(), &[]);
    assert_eq!(said.code, 0, "{said:?}");
    for name in ["cut.json", "nameless.json", "other.json"] {
        assert!(said.err.contains(name), "{name}: {}", said.err);
    }
    let found = sheet(&dir.path().join("sheet"));
    assert_eq!(found["units"], 6);
    let n = quantity(&found, "angle_random_walk");
    assert_eq!((&n["largest"]["value"], &n["largest"]["serial"]), (&0.009.into(), &"S5".into()));
    assert!(notes(&found).contains(&"datasheet.note.retested".to_owned()));
}

#[test]
fn what_makes_no_sheet_is_refused() {
    let dir = tempdir().unwrap();
    let mut one = result("S1", "1", &json!([walk(0.002, 0.02)]));
    write(dir.path(), "1.json", &one);
    one["unit_under_test"]["serial"] = "S2".into();
    one["unit_under_test"]["model"] = "M-2".into();
    write(dir.path(), "2.json", &one);
    let said = run(dir.path(), &[]);
    assert!(said.code == 2 && said.err.contains("M-1, M-2"), "{said:?}");
    one["unit_under_test"]["model"] = "M-1".into();
    one["procedure"]["id"] = "q".into();
    write(dir.path(), "2.json", &one);
    let said = run(dir.path(), &[]);
    assert!(said.code == 2 && said.err.contains("p, q"), "{said:?}");
    one["procedure"] = json!({"id": "p", "revision": "B"});
    write(dir.path(), "2.json", &one);
    assert_eq!(run(dir.path(), &[]).code, 0);
    assert!(notes(&sheet(&dir.path().join("sheet"))).contains(&"datasheet.note.revisions".to_owned()));
    for given in ["0", "1", "nan"] {
        let said = run(dir.path(), &["--confidence", given]);
        assert!(said.code == 2 && said.err.contains("--confidence"), "{said:?}");
    }
    fs::write(dir.path().join("1.json"), "").unwrap();
    fs::remove_file(dir.path().join("2.json")).unwrap();
    assert_eq!(run(dir.path(), &[]).code, 2);
}
