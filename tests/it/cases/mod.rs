//! Small recordings on which a verdict was once wrong, each of a kind: what must be said of it, and what never. Inputs lie in
//! `tests/fixtures/cases`.

mod influence;
mod lots;
mod rate_table;
mod reading;
mod temperature;
mod warm_up;
mod words;

use crate::support::{Said, result, sagnac, shipped};
use serde_json::Value;

/// A file of a case.
fn input(case: &str, name: &str) -> String {
    shipped(&format!("tests/fixtures/cases/{case}/{name}"))
}

/// Runs a procedure on a recording of a case with the options given; gives what was said and the result.
fn run(procedure: &str, recording: &str, more: &[&str]) -> (Said, Value) {
    let folder = tempfile::tempdir().unwrap();
    let args = [&["run", procedure, recording], more, &["--out", "r"]].concat();
    let said = sagnac(folder.path(), &args);
    let found = result(&folder.path().join("r"));
    (said, found)
}

/// Ends of the interval of a row.
fn interval(row: &Value) -> (f64, f64) {
    (row["interval"]["low"].as_f64().unwrap(), row["interval"]["high"].as_f64().unwrap())
}

/// True where a row has no value, or an interval that holds the truth.
fn is_right(row: &Value, truth: f64) -> bool {
    row["value"].is_null() || (interval(row).0..=interval(row).1).contains(&truth)
}
