//! The samples over temperature: what writes them, and what the shipped procedures say of them.
//!
//! `cargo test --test it thermal_study samples -- --ignored` writes them anew.

use crate::support::pairs::sample_once;
use assert_cmd::Command;
use sagnac_studies::bench::chamber::{Leg, Unit, programme, record, warm_up};
use sagnac_studies::bench::chance::Noise;
use std::fmt::Write;
use std::path::{Path, PathBuf};

pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_path_buf()
}

/// A unit that meets procedures/limits/sample-temperature.toml.
fn good() -> Unit {
    Unit {
        a: [9e-4, 4e-6, 0.0],
        shupe: 0.04,
        lag_s: 600.0,
        hysteresis: (0.006, 3.0),
        noise: Noise { n: 0.002, b: 0.001, k: 0.0003 },
        level: 12.467 + 0.12,
    }
}

fn steep() -> Unit {
    Unit { a: [3.2e-3, 4e-6, 0.0], ..good() }
}

fn stairs() -> Vec<Leg> {
    let mut legs = vec![Leg::Hold(5400.0)];
    let up = [-20.0, 0.0, 20.0, 40.0, 60.0];
    let down = [40.0, 20.0, 0.0, -20.0, -40.0];
    for t in up.into_iter().chain(down) {
        legs.push(Leg::Ramp(t, 40.0));
        legs.push(Leg::Hold(5400.0));
    }
    legs
}

fn write(name: &str, serial: &str, unit: &Unit, legs: &[Leg], dt: f64, seed: u64) {
    let r = record(unit, -40.0, legs, dt, 0.01, seed);
    let mut text = format!("# serial: {serial}\ntime_s,rate_deg_h,temp_degC\n");
    for (i, (y, t)) in r.rate.iter().zip(&r.temperature).enumerate() {
        let _ = writeln!(text, "{},{y:.5},{t:.3}", i as f64 * dt);
    }
    std::fs::write(root().join("samples").join(name), text).unwrap();
}

fn write_warm_up(name: &str, serial: &str, decays: &[(f64, f64)], seed: u64) {
    let model = Noise { n: 0.001, b: 0.0005, k: 0.0 };
    let dt = 5.0;
    let y = warm_up(decays, 12.467 + 0.12, model, dt, 2880, seed);
    let mut text = format!("# serial: {serial}\ntime_s,rate_deg_h\n");
    for (i, v) in y.iter().enumerate() {
        let _ = writeln!(text, "{},{v:.5}", i as f64 * dt);
    }
    std::fs::write(root().join("samples").join(name), text).unwrap();
}

#[test]
#[ignore = "writes the samples"]
fn write_the_samples() {
    let ramps = programme(&[50.0, 16.0], 3600.0);
    write("temperature-pass.csv", "SN-0101", &good(), &ramps, 10.0, 101);
    write("temperature-fail.csv", "SN-0102", &steep(), &ramps, 10.0, 102);
    let mut cut = programme(&[50.0, 16.0], 3600.0);
    cut.truncate(7);
    cut.push(Leg::Ramp(12.0, 16.0));
    write("temperature-aborted.csv", "SN-0103", &good(), &cut, 20.0, 103);
    write("temperature-soak-pass.csv", "SN-0104", &good(), &stairs(), 20.0, 104);
    write("temperature-soak-fail.csv", "SN-0105", &steep(), &stairs(), 20.0, 105);
    write_warm_up("warm-up-pass.csv", "SN-0106", &[(0.30, 120.0), (0.05, 300.0)], 106);
    write_warm_up("warm-up-fail.csv", "SN-0107", &[(0.10, 180.0), (0.60, 1500.0)], 107);
}

/// Runs a sample and gives exit code and result.
pub fn run(procedure: &str, limits: &str, sample: &str, serial: &str) -> (i32, serde_json::Value) {
    let out = tempfile::tempdir().unwrap();
    let report = out.path().join("report");
    let done = Command::cargo_bin("sagnac")
        .unwrap()
        .current_dir(root())
        .args(["run", procedure, sample, "--limits", limits, "--serial", serial, "--lang", "en", "--out"])
        .arg(&report)
        .output()
        .unwrap();
    let text = std::fs::read_to_string(report.join("result.json")).unwrap_or_default();
    let result =
        serde_json::from_str(&text).unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&done.stderr)));
    (done.status.code().unwrap(), result)
}

pub fn row<'a>(result: &'a serde_json::Value, id: &str) -> &'a serde_json::Value {
    let rows = result["measurands"].as_array().unwrap();
    rows.iter().find(|r| r["id"] == id).unwrap_or_else(|| panic!("{id}"))
}

fn holds(result: &serde_json::Value, id: &str, truth: f64) {
    let r = row(result, id);
    let (low, high) = (&r["interval"]["low"], &r["interval"]["high"]);
    let (low, high) = (low.as_f64().unwrap(), high.as_f64().unwrap());
    // Of the few intervals here none may miss by more than half its width.
    let half = 0.25 * (high - low);
    assert!((low - half..=high + half).contains(&truth), "{id}: {low} … {high}, truth {truth}");
}

#[test]
fn ramps_pass_fail_and_break_off() {
    let run = sample_once("temperature-pass");
    let result = run.result();
    assert_eq!(run.said.code, 0, "{:#}", result["summary"]);
    for name in ["compensation.toml", "compensation.json", "compensation.h"] {
        assert!(run.out.join(name).exists(), "{name}");
    }
    let u = good();
    let (pp, rms, slope, _) = u.statistics(-40.0, 60.0);
    holds(result, "bias_over_temperature_peak_to_peak", pp);
    holds(result, "bias_over_temperature_3sigma", 3.0 * rms);
    holds(result, "bias_temperature_sensitivity", slope);
    holds(result, "bias_temperature_rate_sensitivity", u.shupe);
    holds(result, "thermal_lag", u.lag_s);
    holds(result, "thermal_hysteresis", 2.0 * u.hysteresis.0);
    holds(result, "angle_random_walk_at_temperature", u.noise.n);
    let fails = sample_once("temperature-fail");
    assert_eq!((fails.said.code, fails.result()["verdict"].as_str()), (1, Some("fail")));
    let aborted = sample_once("temperature-aborted");
    assert_eq!(aborted.said.code, 3);
    let result = aborted.result();
    let course = result["conditions"].as_array().unwrap().iter().find(|c| c["id"] == "temperature_course");
    assert!(course.unwrap()["note"].as_str().unwrap().contains("too early"), "{course:?}");
}

/// Runs a sample with its rows altered and gives what the conditions that are not met say.
fn complaints(alter: impl Fn(&[&str]) -> Option<String>) -> Vec<String> {
    complaints_by("procedures/temperature-ramp.toml", alter)
}

fn complaints_by(procedure: &str, alter: impl Fn(&[&str]) -> Option<String>) -> Vec<String> {
    let text = std::fs::read_to_string(root().join("samples/temperature-pass.csv")).unwrap();
    let rows: Vec<String> = text
        .lines()
        .filter_map(|line| {
            let fields: Vec<&str> = line.split(',').collect();
            if fields.len() == 3 && fields[0] != "time_s" { alter(&fields) } else { Some(line.to_owned()) }
        })
        .collect();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("altered.csv");
    std::fs::write(&file, rows.join("\n") + "\n").unwrap();
    let limits = "procedures/limits/sample-temperature.toml";
    let (code, result) = run(procedure, limits, file.to_str().unwrap(), "SN-0101");
    assert_eq!(code, 3);
    let conditions = result["conditions"].as_array().unwrap();
    let unmet = conditions.iter().filter(|c| c["status"] == "invalid");
    unmet.map(|c| format!("{}: {}", c["id"].as_str().unwrap(), c["note"].as_str().unwrap())).collect()
}

#[test]
fn likely_mistakes_are_named() {
    let says = |found: &[String], words: &str| {
        assert!(found.iter().any(|n| n.contains(words)), "{words}: {found:#?}");
    };
    let flat = complaints(|f| Some(format!("{},{},21.3", f[0], f[1])));
    says(&flat, "was the chamber not started");
    let none = complaints(|f| Some(format!("{},{},", f[0], f[1])));
    says(&none, "is the column missing");
    let scaled = |f: &[&str], scale: &dyn Fn(f64) -> f64| {
        Some(format!("{},{},{:.4}", f[0], f[1], scale(f[2].parse().unwrap())))
    };
    says(&complaints(|f| scaled(f, &|t| t + 273.15)), "look like kelvin");
    says(&complaints(|f| scaled(f, &|t| 1.8 * t + 32.0)), "look like degrees Fahrenheit");
    // The mean is 1/3600 of the Earth rate along the axis, and nothing else would have said so.
    let per_second =
        complaints(|f| Some(format!("{},{},{}", f[0], f[1].parse::<f64>().unwrap() / 3600.0, f[2])));
    says(&per_second, "look like deg/s");
    let one_way = complaints(|f| (f[0].parse::<f64>().unwrap() < 14_000.0).then(|| f.join(",")));
    says(&one_way, "temperature_course");
    // The time in minutes taken for seconds: ramps sixty times too fast.
    let folder = tempfile::tempdir().unwrap();
    let brief = folder.path().join("brief.toml");
    let asked = std::fs::read_to_string(root().join("procedures/temperature-ramp.toml")).unwrap();
    let asked = asked
        .replace("\"30 min\"", "\"0 s\"")
        .replace("minimum_duration = \"10 h\"", "minimum_duration = \"10 min\"");
    std::fs::write(&brief, asked).unwrap();
    let minutes = complaints_by(brief.to_str().unwrap(), |f| {
        Some(format!("{},{},{}", f[0].parse::<f64>().unwrap() / 60.0, f[1], f[2]))
    });
    says(&minutes, "sixty times the required rate");
}

#[test]
fn soaks_pass_and_fail() {
    let run = sample_once("temperature-soak-pass");
    assert_eq!(run.said.code, 0, "{:#}", run.result()["summary"]);
    let slope = good().statistics(-40.0, 60.0).2;
    holds(run.result(), "bias_temperature_sensitivity", slope);
    assert_eq!(sample_once("temperature-soak-fail").said.code, 1);
}

#[test]
fn warm_ups_pass_and_fail() {
    let run = sample_once("warm-up-pass");
    assert_eq!(run.said.code, 0, "{:#}", run.result()["summary"]);
    assert_eq!(sample_once("warm-up-fail").said.code, 1);
}
