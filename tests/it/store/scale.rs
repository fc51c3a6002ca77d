//! How long a large store takes to answer: figures for `docs/validation/lots.md`, and that the time does not grow with a square.

use crate::store::{a_result, store, with_store};
use crate::support::{result, sagnac, shipped};
use sagnac::store::address::{address, sha256};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::Instant;

/// Runs in the store.
const RUNS: usize = 100_000;
/// Units of the lot whose data sheet is made.
const UNITS: usize = 1000;

/// Puts a result where the store keeps it, without waiting for the disk: its index is made afterwards.
fn put(folder: &Path, result: &Value) {
    let bytes = serde_json::to_vec(result).unwrap();
    let address = address(&BTreeMap::from([("result.json".to_owned(), sha256(&bytes))]));
    let at = folder.join("store/results").join(&address[..2]).join(&address);
    fs::create_dir_all(&at).unwrap();
    fs::write(at.join("result.json"), bytes).unwrap();
}

/// Results of units that are tested again from time to time.
fn write_runs(folder: &Path, runs: usize) {
    for i in 0..runs {
        let (unit, attempt) = (i % (runs / 4), i / (runs / 4));
        let day = i % 336;
        let at = format!("20{:02}-{:02}-{:02}T1{attempt}:00:00Z", 20 + attempt, 1 + day / 28, 1 + day % 28);
        let value = 0.5 + 0.3 * (i as f64 * 0.618_034).fract();
        put(folder, &a_result(&format!("SN-{unit:06}"), &format!("L{}", unit / 100), &at, value));
    }
}

/// Results of a lot as the program writes them, from those of the sample lot with other numbers.
fn write_lot(folder: &Path, units: usize) {
    let samples: Vec<Value> = fs::read_dir(shipped("samples/lot"))
        .unwrap()
        .filter(|e| e.as_ref().unwrap().path().is_dir())
        .map(|e| result(&e.unwrap().path()))
        .collect();
    for i in 0..units {
        let mut unit = samples[i % samples.len()].clone();
        unit["unit_under_test"]["serial"] = format!("LOT-{i:04}").into();
        unit["unit_under_test"]["model"] = "LOT-MODEL".into();
        let factor = 1.0 + 0.001 * (i / samples.len()) as f64;
        for m in unit["measurands"].as_array_mut().unwrap() {
            if let Some(value) = m["value"].as_f64() {
                m["value"] = (value * factor).into();
            }
        }
        put(folder, &unit);
    }
}

#[test]
#[ignore = "writes 100 000 results"]
fn how_long_a_large_store_takes() {
    let dir = with_store();
    write_runs(dir.path(), RUNS - UNITS);
    write_lot(dir.path(), UNITS);
    let timed = |args: &[&str]| {
        let began = Instant::now();
        let said = sagnac(dir.path(), args);
        assert_eq!(said.code, 0, "{args:?}: {}", said.err);
        began.elapsed().as_secs_f64()
    };
    println!("{:.1} s: index of {RUNS} runs made anew", timed(&["store", "rebuild", "store"]));
    let mut of_serial: Vec<f64> =
        (0..11).map(|i| timed(&["history", &format!("SN-{:06}", 2000 + i), "--store", "store"])).collect();
    of_serial.sort_by(f64::total_cmp);
    println!("{:.1} ms: history of a serial number, median of 11", 1e3 * of_serial[5]);
    println!(
        "{:.2} s: history of a lot of 100 units",
        timed(&["history", "--lot", "L7", "--store", "store"])
    );
    let sheet = ["datasheet", "--store", "store", "--device-model", "LOT-MODEL", "--out", "sheet"];
    println!("{:.2} s: data sheet of {UNITS} units", timed(&sheet));
    store(dir.path(), &["init", "empty"]);
    println!("{:.1} ms: start of the program and nothing else", 1e3 * timed(&["effects"]));
}

#[test]
fn a_history_takes_time_that_grows_with_its_quantities() {
    let dir = with_store();
    let quantities = 20_000;
    for (day, value) in [(1, 0.5), (2, 0.6)] {
        let mut result = a_result("SN-1", "L1", &format!("2026-03-0{day}T10:00:00Z"), value);
        let row = result["measurands"][0].clone();
        let rows = (0..quantities).map(|i| {
            let mut row = row.clone();
            row["channel"] = format!("rate_{i}").into();
            row
        });
        result["measurands"] = rows.collect();
        put(dir.path(), &result);
    }
    store(dir.path(), &["rebuild", "store"]);
    let began = Instant::now();
    let said = sagnac(dir.path(), &["history", "SN-1", "--store", "store", "--format", "json"]);
    let took = began.elapsed();
    assert_eq!(said.code, 0, "{}", said.err);
    let history: Value = serde_json::from_str(&said.out).unwrap();
    assert_eq!(history["charts"].as_array().unwrap().len(), quantities);
    assert_eq!(history["charts"][quantities - 1]["points"][1]["value"], 0.6);
    let began = Instant::now();
    let said = sagnac(dir.path(), &["history", "SN-1", "--store", "store"]);
    assert_eq!(said.code, 0, "{}", said.err);
    let took = took.max(began.elapsed());
    // Seconds where nothing is optimised; time that grows with the square would be minutes.
    assert!(took.as_secs() < 120, "{took:?}");
}
