//! A thermometer that reads whole degrees: its steps are no lag, no loop and nothing that was not recorded.

use super::{input, interval, is_right, run};
use crate::support::{measurand, sagnac};

const CASE: &str = "thermometer-1degC";

#[test]
fn whole_degrees_are_no_lag_and_no_loop() {
    let (said, found) = run(&input(CASE, "ramp.toml"), &input(CASE, "sweep.csv"), &[]);
    // Samples of 10 s leave half of one open, 5 s of lag and 3 deg/h between the branches of a ramp.
    for (id, most) in [
        ("thermal_lag", 10.0),
        ("bias_loop_width", 6.0),
        ("thermal_hysteresis", 6.0),
        ("bias_temperature_rate_sensitivity", 6.0),
    ] {
        let row = measurand(&found, id);
        let at_zero = row["value"].as_f64().is_some_and(|v| v.abs() < most);
        assert!(is_right(row, 0.0) || at_zero, "{id}: {row} {}", said.out);
    }
    let span = measurand(&found, "bias_over_temperature_peak_to_peak");
    assert!((span["value"].as_f64().unwrap() / 1717.0 - 1.0).abs() < 0.02, "{span}");
    let slope = measurand(&found, "bias_temperature_sensitivity");
    let (low, high) = interval(slope);
    assert!(low < 38.4 && high > 38.0 && high - low < 2.0, "{slope}");
}

#[test]
fn the_explanation_is_the_temperature() {
    let folder = tempfile::tempdir().unwrap();
    let model = input(CASE, "model.toml");
    let said =
        sagnac(folder.path(), &["explain", &input(CASE, "sweep.csv"), "--model", &model, "--out", "e"]);
    let text = std::fs::read_to_string(folder.path().join("e/explain.json")).unwrap();
    let found: serde_json::Value = serde_json::from_str(&text).unwrap();
    let first = found["effects"][0]["kind"].as_str().unwrap_or_default();
    assert!(first.starts_with("temp_") || first == "thermal_lag", "{first}: {}", said.out);
    let kinds: Vec<&str> =
        found["effects"].as_array().unwrap().iter().filter_map(|e| e["kind"].as_str()).collect();
    assert!(!kinds.contains(&"unobserved_driver"), "{kinds:?}");
}
