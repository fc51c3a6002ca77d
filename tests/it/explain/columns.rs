//! What several recorded columns do together, and what a recorded ramp folds: named, stated and consistent with what was
//! stated.

use super::{N, json};
use crate::support::sagnac;
use crate::support::synthetic::white;
use serde_json::Value;
use std::f64::consts::TAU;
use std::fmt::Write;
use std::path::Path;
use tempfile::tempdir;

const ROWS: usize = 8000;

/// A recording at 1 Hz of white noise and a course beside two columns, explained; and with what the explanation states, again.
fn explained(
    folder: &Path,
    names: [&str; 2],
    columns: impl Fn(f64) -> [f64; 2],
    course: impl Fn(f64) -> f64,
) -> Value {
    let mut text = format!("time_s,rate_deg_h,{},{}\n", names[0], names[1]);
    for i in 0..ROWS {
        let t = i as f64;
        let [first, second] = columns(t);
        let rate = 5.0 + 60.0 * N * white(91, i as u64) + course(t);
        let _ = writeln!(text, "{t},{rate:.6},{first:.5},{second:.5}");
    }
    std::fs::write(folder.join("r.csv"), text).unwrap();
    std::fs::write(folder.join("model.toml"), super::MODEL).unwrap();
    let run = |model: &str, out: &str| {
        let said = sagnac(folder, &["explain", "r.csv", "--model", model, "--out", out]);
        assert_eq!(said.err, "", "{said:?}");
        said.code
    };
    assert_ne!(run("model.toml", "e"), 0);
    assert_eq!(run("e/augmented.toml", "again"), 0);
    json(&folder.join("e/explain.json"))
}

fn weather(t: f64) -> [f64; 2] {
    [
        1000.0 + 5.0 * (t / 700.0).sin() + 3.0 * (t / 310.0).cos(),
        20.0 + 6.0 * (t / 1100.0).cos() + 2.0 * (t / 180.0).sin(),
    ]
}

#[test]
fn a_law_of_two_columns_is_unknown_with_its_formula_and_the_loop_closes() {
    let dir = tempdir().unwrap();
    // The change of the pressure, hPa/h, times the departure of the temperature from 20 °C.
    let course = |t: f64| {
        let change = (weather(t + 1.0)[0] - weather(t - 1.0)[0]) / 2.0 * 3600.0;
        0.003 * change * (weather(t)[1] - 20.0)
    };
    let all = explained(dir.path(), ["pressure_hPa", "temp_degC"], weather, course);
    let first = &all["effects"][0];
    assert_eq!(
        (first["kind"].as_str(), first["effect"].as_str()),
        (Some("unknown"), Some("column_law")),
        "{all}"
    );
    let formula = first["formula"].as_str().unwrap();
    assert!(formula.starts_with("0.0029") || formula.starts_with("0.0030"), "{formula}");
    assert!(formula.contains("d(pressure_hPa)/dt") && formula.contains("(temp_degC − "), "{formula}");
    let report = std::fs::read_to_string(dir.path().join("e/report.md")).unwrap();
    // In Markdown an underscore is escaped.
    assert!(report.replace('\\', "").contains(formula), "{report}");
}

#[test]
fn a_disturbance_that_a_recorded_ramp_folds_is_one_comb_with_its_column() {
    let dir = tempdir().unwrap();
    // The period of 40 s wanders by a tenth.
    let turns = |t: f64| t / 40.0 + 3.0 * (t / 900.0).sin();
    let columns = |t: f64| [turns(t).rem_euclid(1.0) * 32_767.0, 21.0 + (t / 800.0).sin()];
    let course = |t: f64| 1.5 * (3.0 * ((TAU * turns(t)).cos() - 1.0)).exp();
    let all = explained(dir.path(), ["ramp_counts", "temp_degC"], columns, course);
    let first = &all["effects"][0];
    assert_eq!(
        (first["kind"].as_str(), first["column"].as_str()),
        (Some("comb"), Some("ramp_counts")),
        "{all}"
    );
    let fundamental = first["parameters"]["fundamental_hz"]["value"].as_f64().unwrap();
    assert!((fundamental - 1.0 / 40.0).abs() < 0.001, "{first}");
    assert!(first["probabilities"]["comb"].as_f64().unwrap() > 0.5, "{first}");
}
