//! The verb `store` and runs that are kept, as a user has them.

mod attempts;
mod damage;
mod exchange;
mod history;
mod kept;
mod kills;
mod lossless;
mod scale;
mod writers;

use crate::support::{Said, sagnac};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A folder with a new store in it.
fn with_store() -> TempDir {
    let dir = tempfile::tempdir().unwrap();
    store(dir.path(), &["init", "store"]);
    dir
}

/// Runs the verb on what must succeed.
fn store(folder: &Path, args: &[&str]) -> Said {
    let said = store_says(folder, args);
    assert_eq!(said.code, 0, "{args:?}: {said:?}");
    said
}

fn store_says(folder: &Path, args: &[&str]) -> Said {
    sagnac(folder, &[&["store"], args].concat())
}

/// A result as another program may write it: one limit, one value.
fn a_result(serial: &str, lot: &str, evaluated_at: &str, value: f64) -> Value {
    let verdict = if value <= 1.0 { "pass" } else { "fail" };
    json!({
        "format": "result/1",
        "kind": "run",
        "procedure": {"id": "static-bias", "revision": "A", "sha256": "p", "limits": {"id": "l", "revision": "1", "sha256": "l"}},
        "unit_under_test": {"serial": serial, "model": "A-1", "lot": lot},
        "session": {"operator": "O", "station": "S1", "evaluated_at": evaluated_at},
        "verdict": verdict,
        "measurands": [{
            "id": "static_bias", "channel": "rate", "unit": "deg/h", "value": value,
            "interval": {"low": value - 0.1, "high": value + 0.1, "coverage": 0.95},
            "limit": {"min": null, "max": 1.0}, "verdict": verdict,
        }],
    })
}

/// Writes a result into a folder of its own.
fn write_result(folder: &Path, name: &str, result: &Value) {
    let at = folder.join(name);
    std::fs::create_dir_all(&at).unwrap();
    std::fs::write(at.join("result.json"), serde_json::to_vec(result).unwrap()).unwrap();
}

/// Writes results of some units, each tested twice on days that follow each other.
fn write_results(folder: &Path, units: usize) {
    for i in 0..units {
        for (attempt, value) in [(1, 1.2), (2, 0.8 + 0.01 * i as f64)] {
            let at = format!("2026-03-{:02}T1{attempt}:00:00Z", 1 + i % 28);
            let result = a_result(&format!("SN-{i:03}"), "L1", &at, value);
            write_result(folder, &format!("u{i:03}-{attempt}"), &result);
        }
    }
}

/// The result folders of a store, by their addresses.
pub(crate) fn kept(store: &Path) -> Vec<(String, PathBuf)> {
    let mut found = vec![];
    for group in crate::support::names(&store.join("results")).into_iter().filter(|n| !n.starts_with('.')) {
        let group = store.join("results").join(group);
        found.extend(crate::support::names(&group).into_iter().map(|n| (n.clone(), group.join(n))));
    }
    found
}
