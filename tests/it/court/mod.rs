//! Criticism of a fit: no verdict on a model that its own page contradicts. Each input stands for a kind of recording of which a
//! verdict was once wrong.

mod delivered;
mod noise_floor;
mod response;
mod rounding;
mod slow_noise;
mod temperature;

use crate::support::{Said, procedure, result, sagnac, shipped};
use serde_json::Value;
use std::fmt::Write;
use std::path::Path;

/// A file of a case.
fn case(path: &str) -> String {
    shipped(&format!("tests/fixtures/cases/{path}"))
}

/// A limits file with one limit.
fn limit(folder: &Path, measurand: &str, limit: &str) -> String {
    let text = format!(
        "format = \"limits/1\"\n[limits]\nid = \"l\"\ntitle = \"L\"\nrevision = \"A\"\nsource = \"S\"\n\
         [[limit]]\nmeasurand = \"{measurand}\"\n{limit}\n"
    );
    let path = folder.join("limits.toml");
    std::fs::write(&path, text).unwrap();
    path.to_string_lossy().into_owned()
}

/// The shipped static test of a recording.
fn run(folder: &Path, recording: &str, limits: &str) -> (Said, Value) {
    let arguments =
        ["run", &procedure(), recording, "--serial", "J-1", "--limits", limits, "--out", "o", "--force"];
    let said = sagnac(folder, &arguments);
    assert!(said.code != 2, "{said:?}");
    (said, result(&folder.join("o")))
}

/// The result of an analysis of rates, deg/h, without limits.
fn analyzed(folder: &Path, interval_s: f64, rates: &[f64]) -> Value {
    let mut text = String::from("time_s,rate_deg_h\n");
    for (i, rate) in rates.iter().enumerate() {
        let _ = writeln!(text, "{},{rate:.7}", i as f64 * interval_s);
    }
    std::fs::write(folder.join("r.csv"), text).unwrap();
    let said = sagnac(folder, &["analyze", "r.csv", "--out", "a", "--force"]);
    assert_eq!(said.code, 0, "{said:?}");
    result(&folder.join("a"))
}

/// The checks that contradict a row.
fn objections(row: &Value) -> Vec<&str> {
    row["objections"].as_array().into_iter().flatten().filter_map(|o| o["check"].as_str()).collect()
}

/// Whether the 95 % interval of a row holds a value.
fn holds(row: &Value, truth: f64) -> bool {
    let end = |name: &str| row["interval"][name].as_f64().unwrap_or(f64::NAN);
    end("low") <= truth && truth <= end("high")
}
