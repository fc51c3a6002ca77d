//! Motion of a table over frequency: the samples, and what a table that ends early tells.

use crate::support::pairs::sample_once;
use crate::support::{altered, result, sagnac, shipped};
use sagnac_studies::bench::frequency::{Dynamics, Motion, OnTable};
use serde_json::Value;
use std::fs;
use tempfile::tempdir;

fn fast() -> OnTable {
    OnTable::default()
}

fn slow() -> OnTable {
    OnTable { dynamics: Dynamics::OnePole { corner_hz: 18.0 }, delay_s: 0.006, ..OnTable::default() }
}

/// Samples with what stands in them.
pub fn files() -> [(&'static str, String); 2] {
    [
        ("samples/transfer-function-pass.csv", csv(&fast(), 71)),
        ("samples/transfer-function-fail.csv", csv(&slow(), 73)),
    ]
}

fn csv(unit: &OnTable, seed: u64) -> String {
    let record = unit.record(seed);
    let rows = record.time.iter().zip(record.output.iter().zip(&record.angle));
    let mut out = String::from("time_s,rate_deg_s,table_angle_deg\n");
    for (time, (rate, angle)) in rows {
        out.push_str(&format!("{time:.3},{rate:.4},{angle:.6}\n"));
    }
    out
}

fn row<'a>(result: &'a Value, id: &str) -> &'a Value {
    result["measurands"].as_array().unwrap().iter().find(|r| r["id"] == id).unwrap_or_else(|| panic!("{id}"))
}

/// The interval holds the truth, and is no wider than a share of it.
fn holds(row: &Value, truth: f64, share: f64) {
    let end = |name: &str| row["interval"][name].as_f64().unwrap_or_else(|| panic!("{row}"));
    let (low, high) = (end("low"), end("high"));
    // Of the few intervals here none may miss by half its width.
    let half = 0.25 * (high - low);
    assert!((low - half..=high + half).contains(&truth), "{truth}: {row}");
    assert!(high - low < share * truth.abs(), "{truth}: {row}");
}

#[test]
fn bandwidth_and_latency_of_the_samples_come_back() {
    for (name, unit) in [("transfer-function-pass", fast()), ("transfer-function-fail", slow())] {
        let r = sample_once(name).result();
        let corner = (1..4000).map(|i| 0.02 * f64::from(i)).find(|f| unit.forced(*f).0 < 0.5f64.sqrt());
        let latency_ms = 1e3 * unit.forced(0.5).1 / (std::f64::consts::TAU * 0.5);
        holds(row(r, "bandwidth_3db"), corner.unwrap(), 0.05);
        holds(row(r, "bandwidth_3db_model"), corner.unwrap(), 0.05);
        holds(row(r, "latency"), latency_ms, 0.05);
    }
    let failed = sample_once("transfer-function-fail").result();
    assert_eq!(row(failed, "bandwidth_3db")["verdict"], "fail");
    assert_eq!(row(failed, "latency")["verdict"], "fail");
}

#[test]
fn a_table_that_ends_below_the_bandwidth_tells_at_least_and_lets_the_models_differ() {
    let folder = tempdir().unwrap();
    let unit = OnTable {
        dynamics: Dynamics::OnePole { corner_hz: 200.0 },
        delay_s: 0.0,
        motion: Motion::Random,
        frequencies: (0.5, 25.0),
        noise: 0.05,
        hz: 500.0,
        ..OnTable::default()
    };
    fs::write(folder.path().join("r.csv"), csv(&unit, 5)).unwrap();
    let procedure = shipped("procedures/transfer-function.toml");
    let said = sagnac(folder.path(), &["run", &procedure, "r.csv", "--serial", "SN-1", "--out", "o"]);
    assert_ne!(said.code, 2, "{}", said.err);
    let r = result(&folder.path().join("o"));
    let direct = row(&r, "bandwidth_3db");
    assert!(direct["value"].is_null(), "{direct}");
    let least = direct["lower_limit"]["value"].as_f64().unwrap_or_else(|| panic!("{direct}"));
    assert!((20.0..=26.0).contains(&least), "{direct}");
    let modelled = row(&r, "bandwidth_3db_model");
    let low = modelled["interval"]["low"].as_f64().or_else(|| modelled["lower_limit"]["value"].as_f64());
    assert!(low.is_some_and(|low| low < 200.0 && low > 25.0), "{modelled}");
    if let Some(high) = modelled["interval"]["high"].as_f64() {
        assert!(high > 200.0, "{modelled}");
    }
}

/// The result of the shipped procedure on a drawn unit.
fn tested(unit: &OnTable, flat_to: &str) -> Value {
    let folder = tempdir().unwrap();
    fs::write(folder.path().join("r.csv"), csv(unit, 5)).unwrap();
    let shipped = shipped("procedures/transfer-function.toml");
    altered(
        folder.path(),
        "p.toml",
        &shipped,
        &[("flat_to = \"10 Hz\"", &format!("flat_to = \"{flat_to}\""))],
    );
    let said = sagnac(folder.path(), &["run", "p.toml", "r.csv", "--serial", "SN-1", "--out", "o"]);
    assert_ne!(said.code, 2, "{}", said.err);
    result(&folder.path().join("o"))
}

#[test]
fn sine_steps_far_apart_tell_the_flatness_between_them() {
    // 14.7 and 20.7 Hz are steps, 20 Hz is none: there a pole at 25 Hz has lost 2.15 dB, at 14.7 Hz 1.29 dB.
    let unit = OnTable {
        dynamics: Dynamics::OnePole { corner_hz: 25.0 },
        motion: Motion::Steps,
        frequencies: (0.5, 80.0),
        seconds: 96.0,
        ..OnTable::default()
    };
    let r = tested(&unit, "20 Hz");
    let lost = 10.0 * (1.0 + 0.8f64.powi(2)).log10();
    for (id, truth) in [("response_flatness", lost), ("latency", 1.5 + 1e3 / (std::f64::consts::TAU * 25.0))]
    {
        holds(row(&r, id), truth, 0.3);
    }
}

#[test]
fn noise_of_the_angle_does_not_lower_the_gain() {
    // −3 dB of two poles of damping 0.5 lies at 1.272 of their corner; read as it is, this angle would put it 0.2 Hz lower.
    let unit = OnTable {
        dynamics: Dynamics::TwoPoles { corner_hz: 40.0, damping: 0.5 },
        frequencies: (0.5, 80.0),
        seconds: 60.0,
        reading_arcsec: 3.0,
        ..OnTable::default()
    };
    let r = tested(&unit, "20 Hz");
    let truth = 40.0 * (0.5 + 1.25f64.sqrt()).sqrt();
    let found = row(&r, "bandwidth_3db_model");
    let at = found["value"].as_f64().unwrap_or_else(|| panic!("{found}"));
    assert!((at - truth).abs() < 0.07, "{truth} {found}");
}

#[test]
fn a_table_at_rest_tells_nothing() {
    let folder = tempdir().unwrap();
    let unit = OnTable { amplitude: 0.0, ..OnTable::default() };
    fs::write(folder.path().join("r.csv"), csv(&unit, 5)).unwrap();
    let procedure = shipped("procedures/transfer-function.toml");
    let said = sagnac(folder.path(), &["run", &procedure, "r.csv", "--serial", "SN-1", "--out", "o"]);
    assert_eq!(said.code, 3, "{}{}", said.out, said.err);
    let r = result(&folder.path().join("o"));
    for id in ["bandwidth_3db", "latency", "response_flatness"] {
        assert!(row(&r, id)["value"].is_null(), "{}", row(&r, id));
    }
}

#[test]
fn a_procedure_without_an_input_or_a_band_is_refused() {
    let folder = tempdir().unwrap();
    let shipped = shipped("procedures/transfer-function.toml");
    altered(folder.path(), "a.toml", &shipped, &[("role = \"table_angle\"", "role = \"auxiliary\"")]);
    altered(folder.path(), "b.toml", &shipped, &[("flat_to = \"10 Hz\"\n", "")]);
    altered(
        folder.path(),
        "c.toml",
        &shipped,
        &[("[transfer_test]\nflat_to = \"10 Hz\"\nleast_coherence = 0.9", "")],
    );
    for (file, says) in [("a.toml", "table_angle"), ("b.toml", "flat_to"), ("c.toml", "transfer_test")] {
        let said = sagnac(folder.path(), &["check", file]);
        assert_ne!(said.code, 0, "{file}: {}", said.out);
        assert!((said.out.clone() + &said.err).contains(says), "{file}: {said:?}");
    }
}
