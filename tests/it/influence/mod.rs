//! Switching off and on, and comparisons without and with an influence: the samples, the shipped procedures on them,
//! mistakes by their names, and intervals against simulated truth (`study`).
//!
//! `cargo test --test it influence -- --ignored write_the_samples` writes the samples anew.

mod declared;
mod study;

use crate::support::pairs::sample_once;
use crate::support::{altered, sagnac, shipped};
use sagnac_studies::bench::influence::{
    FIELD, NOISE, PRESSURE, SUPPLY, SWITCHED, series, shaken, turned, turns,
};
use sagnac_studies::bench::influence::{Recorded, Series, Turned, Turns, linear, parabola, present, squared};
use sagnac_studies::bench::vibration::{OnShaker, two_bands};
use serde_json::Value;
use std::fmt::Write;
use std::path::PathBuf;
use std::process::Command;
use tempfile::tempdir;

fn root(path: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(path)
}

fn text(serial: &str, level: &str, r: &Recorded) -> String {
    let mut out = format!("# serial: {serial}\ntime_s,rate_deg_h,temp_degC{level}\n");
    for i in 0..r.time_s.len() {
        let t = (r.time_s[i] * 10.0).round() / 10.0;
        let _ = write!(out, "{t},{:.4},{:.3}", r.rate[i], r.temperature[i]);
        if !level.is_empty() {
            let _ = write!(out, ",{}", r.level[i]);
        }
        out.push('\n');
    }
    out
}

/// Pressures with a bias that follows them by a parabola.
fn pressure(per_kpa: f64) -> Turns {
    Turns { bias: parabola, ..turns(&PRESSURE, per_kpa) }
}

/// A field that is switched on and off.
fn switched(change: f64) -> Turns {
    Turns { bias: present, ..turns(&SWITCHED, change) }
}

/// A sample on a table.
fn on_table(serial: &str, turned: &Turned, seed: u64) -> String {
    let (r, table) = turned.record(seed);
    let mut out = format!("# serial: {serial}\ntime_s,rate_deg_h,temp_degC,table_rate_deg_s,pressure_kPa\n");
    for (i, table) in table.iter().enumerate() {
        let _ =
            writeln!(out, "{},{:.4},{:.3},{table},{}", r.time_s[i], r.rate[i], r.temperature[i], r.level[i]);
    }
    out
}

/// A sample on a shaker with an accelerometer.
fn on_shaker(serial: &str, shaker: &OnShaker, seed: u64) -> String {
    let r = shaker.record(seed);
    let mut out = format!("# serial: {serial}\ntime_s,rate_deg_h,acceleration_g\n");
    for i in 0..r.time_s.len() {
        let _ = writeln!(out, "{},{:.3},{:.3}", r.time_s[i], r.rate[i], r.acceleration[i]);
    }
    out
}

/// Every sample with its text.
fn files() -> Vec<(&'static str, String)> {
    vec![
        ("bias-repeatability-pass", text("SN-0111", "", &series(0.02).record(111))),
        ("bias-repeatability-fail", text("SN-0112", "", &series(0.3).record(112))),
        ("magnetic-sensitivity-pass", text("SN-0113", ",field_mT", &turns(&FIELD, 0.05).record(113))),
        ("magnetic-sensitivity-fail", text("SN-0114", ",field_mT", &turns(&FIELD, 0.6).record(114))),
        ("supply-sensitivity-pass", text("SN-0115", ",supply_V", &turns(&SUPPLY, 0.02).record(115))),
        ("supply-sensitivity-fail", text("SN-0116", ",supply_V", &turns(&SUPPLY, -0.6).record(116))),
        ("vibration-pass", text("SN-0117", "", &shaken(0.001, |g| 1.0 + 0.05 * g).record(117))),
        ("vibration-fail", text("SN-0118", "", &shaken(0.02, |g| 1.0 + 0.3 * g).record(118))),
        ("pressure-sensitivity-pass", text("SN-0121", ",pressure_kPa", &pressure(0.002).record(121))),
        ("pressure-sensitivity-fail", text("SN-0122", ",pressure_kPa", &pressure(0.02).record(122))),
        ("electromagnetic-immunity-pass", text("SN-0123", ",field_on", &switched(0.01).record(123))),
        ("electromagnetic-immunity-fail", text("SN-0124", ",field_on", &switched(0.3).record(124))),
        ("scale-factor-under-pressure-pass", on_table("SN-0125", &turned(0.001, 0.3), 125)),
        ("scale-factor-under-pressure-fail", on_table("SN-0126", &turned(0.001, -3.0), 126)),
        ("vibration-by-frequency-pass", on_shaker("SN-0127", &two_bands(0.01, 2.0), 127)),
        ("vibration-by-frequency-fail", on_shaker("SN-0128", &two_bands(0.3, 20.0), 128)),
    ]
}

#[test]
#[ignore = "writes the samples"]
fn write_the_samples() {
    for (name, text) in files() {
        std::fs::write(root(&format!("samples/{name}.csv")), text).unwrap();
    }
}

#[test]
fn the_samples_are_what_the_generator_gives() {
    for (name, text) in files() {
        let stored = std::fs::read_to_string(root(&format!("samples/{name}.csv"))).unwrap();
        assert!(stored == text, "{name}");
    }
}

/// Runs a procedure on a recording; gives the exit code and the result.
fn run(procedure: &str, recording: &str, serial: &str) -> (i32, Value) {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("report");
    let done = Command::new(env!("CARGO_BIN_EXE_sagnac"))
        .args(["run", procedure, recording, "--serial", serial, "--out"])
        .arg(&out)
        .output()
        .unwrap();
    let text = std::fs::read_to_string(out.join("result.json"))
        .unwrap_or_else(|e| panic!("{e}: {}", String::from_utf8_lossy(&done.stderr)));
    for name in ["report.html", "report.md", "interval_means.csv"] {
        assert!(out.join(name).exists(), "{name}");
    }
    (done.status.code().unwrap(), serde_json::from_str(&text).unwrap())
}

fn path(name: &str) -> String {
    root(name).to_string_lossy().into_owned()
}

fn row<'a>(result: &'a Value, id: &str) -> &'a Value {
    let rows = result["measurands"].as_array().unwrap();
    rows.iter().find(|r| r["id"] == id).unwrap_or_else(|| panic!("{id}"))
}

/// The truth lies within the interval widened by half: of the few intervals here none may miss by more.
fn holds(result: &Value, id: &str, truth: f64) {
    let r = row(result, id);
    let end = |name: &str| r["interval"][name].as_f64().unwrap_or_else(|| panic!("{r}"));
    let (low, high) = (end("low"), end("high"));
    let half = 0.25 * (high - low);
    assert!((low - half..=high + half).contains(&truth), "{id}: {low} … {high}, truth {truth}");
}

#[test]
fn every_shipped_procedure_passes_one_sample_and_does_not_pass_another() {
    let names = [
        "bias-repeatability",
        "magnetic-sensitivity",
        "supply-sensitivity",
        "vibration",
        "pressure-sensitivity",
        "electromagnetic-immunity",
        "scale-factor-under-pressure",
        "vibration-by-frequency",
    ];
    for name in &names {
        for (end, code) in [("pass", 0), ("fail", 1)] {
            let run = sample_once(&format!("{name}-{end}"));
            let result = run.result();
            assert_eq!(
                run.said.code, code,
                "{name}-{end}: {:#} {:#}",
                result["summary"], result["measurands"]
            );
            match (*name, end) {
                ("bias-repeatability", _) if result["integrity"]["missing_samples"] != 0 => {
                    panic!("switching off is no gap: {}", result["integrity"])
                }
                ("bias-repeatability", "pass") => holds(result, "bias_repeatability", 0.02),
                ("bias-repeatability", _) => holds(result, "bias_repeatability", 0.3),
                ("magnetic-sensitivity", "pass") => holds(result, "magnetic_sensitivity", 0.05),
                ("magnetic-sensitivity", _) => holds(result, "magnetic_sensitivity", 0.6),
                ("supply-sensitivity", "pass") => holds(result, "supply_sensitivity", 0.02),
                ("supply-sensitivity", _) => holds(result, "supply_sensitivity", -0.6),
                ("pressure-sensitivity", _) => {
                    let k = if end == "pass" { 0.002 } else { 0.02 };
                    holds(result, "influence_sensitivity", k);
                    holds(result, "influence_sensitivity_quadratic", 0.005 * k);
                }
                ("electromagnetic-immunity", "pass") => holds(result, "bias_shift", 0.01),
                ("electromagnetic-immunity", _) => holds(result, "bias_shift", 0.3),
                ("scale-factor-under-pressure", _) => {
                    let k = if end == "pass" { 0.3 } else { -3.0 };
                    holds(result, "influence_sensitivity", 0.001);
                    holds(result, "scale_factor_influence_sensitivity", k);
                    // The first level is 80 kPa.
                    holds(result, "scale_factor_shift", k * (80.0 - 101.3));
                }
                ("vibration-by-frequency", _) => {
                    let (per_square, response) = if end == "pass" { (0.01, 2.0) } else { (0.3, 20.0) };
                    // The first band.
                    holds(result, "vibration_rectification_in_band", per_square);
                    holds(result, "vibration_resonance_frequency", 24.0);
                    holds(result, "vibration_resonance_quality", 8.0);
                    holds(result, "vibration_resonance_response", response);
                }
                (_, "pass") => {
                    holds(result, "vibration_sensitivity", 0.001);
                    // N at 2 g is 1.1 times that at rest.
                    holds(result, "angle_random_walk_shift", 0.1 * NOISE.n);
                    holds(result, "noise_density_ratio", 1.1);
                }
                _ => {
                    holds(result, "angle_random_walk_shift", 0.6 * NOISE.n);
                    holds(result, "noise_density_ratio", 1.6);
                }
            }
        }
    }
}

#[test]
fn a_ratio_of_noise_names_its_band_and_needs_one() {
    let result = sample_once("vibration-fail").result();
    let rows = result["measurands"].as_array().unwrap();
    let ratios: Vec<&Value> = rows.iter().filter(|r| r["id"] == "noise_density_ratio").collect();
    let channels: Vec<&str> = ratios.iter().map(|r| r["channel"].as_str().unwrap()).collect();
    assert_eq!(channels, ["rate@2:0.5-2Hz", "rate@4:0.5-2Hz"]);
    assert!(ratios.iter().all(|r| r["verdict"] == "fail" && r["unit"] == "1"), "{ratios:?}");
    let folder = tempdir().unwrap();
    let band = "[[noise_test.band]]\nfrom = \"0.5 Hz\"\nto = \"2 Hz\"\n";
    altered(folder.path(), "p.toml", &shipped("procedures/vibration.toml"), &[(band, "")]);
    let said = sagnac(folder.path(), &["check", "p.toml"]);
    assert!(said.code != 0 && (said.out.clone() + &said.err).contains("noise_test"), "{said:?}");
}

/// Ids of the sentences of the conditions that are not met.
fn invalid(result: &Value) -> Vec<String> {
    let list = result["conditions"].as_array().unwrap();
    let unmet = list.iter().filter(|c| c["status"] != "ok");
    unmet.map(|c| c["message"]["id"].as_str().unwrap().to_owned()).collect()
}

/// Runs a shipped procedure on a recording that is written for it.
fn on(procedure: &str, level: &str, recorded: &Recorded) -> (i32, Value) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("recording.csv");
    std::fs::write(&file, text("SN-1", level, recorded)).unwrap();
    run(&path(&format!("procedures/{procedure}.toml")), &file.to_string_lossy(), "SN-1")
}

#[test]
fn files_of_a_manifest_are_the_runs() {
    let folder = tempfile::tempdir().unwrap();
    let all = series(0.02).record(111);
    let each = all.time_s.len() / 8;
    let mut manifest = String::from("format = \"manifest/1\"\nserial = \"SN-1\"\n");
    for k in 0..8 {
        let part = |v: &[f64]| v[k * each..(k + 1) * each].to_vec();
        // Every file starts its own clock.
        let time_s = (0..each).map(|i| i as f64).collect();
        let r =
            Recorded { time_s, rate: part(&all.rate), temperature: part(&all.temperature), level: vec![] };
        std::fs::write(folder.path().join(format!("run{k}.csv")), text("SN-1", "", &r)).unwrap();
        let _ = write!(manifest, "\n[[file]]\npath = \"run{k}.csv\"\n");
    }
    let path_of = folder.path().join("manifest.toml");
    std::fs::write(&path_of, manifest).unwrap();
    let (code, result) = run(&path("procedures/bias-repeatability.toml"), &path_of.to_string_lossy(), "SN-1");
    assert_eq!(code, 0, "{:#}", result["summary"]);
    let means = result["interval_means"].as_array().unwrap();
    assert_eq!((means.len(), means[3]["name"].as_str()), (8, Some("run3.csv")));
    let one = sample_once("bias-repeatability-pass").result();
    for (a, b) in means.iter().zip(one["interval_means"].as_array().unwrap()) {
        let (a, b) = (a["mean_deg_h"].as_f64().unwrap(), b["mean_deg_h"].as_f64().unwrap());
        assert!((a - b).abs() < 0.004, "{a} {b}");
    }
}

/// The result of the shipped test of vibration on a recording, with lines put into the table of the test.
fn shaker(recorded: &Recorded, keys: &str) -> (i32, Value, String) {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("recording.csv"), text("SN-1", "", recorded)).unwrap();
    let shipped = std::fs::read_to_string(root("procedures/vibration.toml")).unwrap();
    let procedure = shipped.replacen("[vibration_test]\n", &format!("[vibration_test]\n{keys}"), 1);
    std::fs::write(at("p.toml"), procedure).unwrap();
    let done = Command::new(env!("CARGO_BIN_EXE_sagnac"))
        .current_dir(folder.path())
        .args(["run", "p.toml", "recording.csv", "--serial", "SN-1", "--out", "o"])
        .output()
        .unwrap();
    let result = std::fs::read_to_string(at("o/result.json")).unwrap();
    let report = std::fs::read_to_string(at("o/report.md")).unwrap();
    let said = String::from_utf8_lossy(&done.stdout).into_owned() + &report;
    (done.status.code().unwrap(), serde_json::from_str(&result).unwrap(), said)
}

fn condition<'a>(result: &'a Value, id: &str) -> &'a Value {
    result["conditions"].as_array().unwrap().iter().find(|c| c["id"] == id).unwrap()
}

#[test]
fn a_declared_influence_is_not_one_that_acted() {
    // White noise at rest: the shaker was off.
    let rest = shaken(0.0, |_| 1.0).record(31);
    let (code, result, said) = shaker(&rest, "");
    assert_eq!(code, 3, "{said}");
    let acted = condition(&result, "influence_acted");
    assert_eq!((&acted["status"], &acted["evidence"]), (&"invalid".into(), &"declared".into()), "{acted}");
    assert!(!said.contains("Observed"), "{said}");

    let (code, result, said) = shaker(&rest, "evidence = \"declared\"\n");
    assert_eq!(code, 0, "{said}");
    let acted = condition(&result, "influence_acted");
    assert_eq!((&acted["status"], &acted["evidence"]), (&"remark".into(), &"declared".into()));
    assert!(said.matches("declared only").count() >= 2, "{said}");
    assert!(result["interval_means"].as_array().unwrap().iter().all(|m| m["evidence"] == "declared"));

    let (code, result, said) = shaker(&shaken(0.001, |g| 1.0 + 0.07 * g).record(32), "");
    assert_eq!(code, 0, "{said}");
    let acted = condition(&result, "influence_acted");
    assert_eq!((&acted["status"], &acted["evidence"]), (&"ok".into(), &"inferred".into()));
}

#[test]
fn every_condition_says_how_it_is_known() {
    let result = sample_once("supply-sensitivity-pass").result();
    for c in result["conditions"].as_array().unwrap() {
        assert!(c["evidence"].is_string(), "{c}");
    }
    assert_eq!(condition(result, "influence_acted")["evidence"], "recorded");
    assert_eq!(condition(result, "calibration")["evidence"], "declared");
    assert!(result["interval_means"].as_array().unwrap().iter().all(|m| m["evidence"] == "recorded"));
}

#[test]
fn a_field_stated_without_a_channel_is_no_field() {
    let folder = tempfile::tempdir().unwrap();
    let recorded = turns(&FIELD, 0.05).record(33);
    std::fs::write(folder.path().join("r.csv"), text("SN-1", "", &recorded)).unwrap();
    let shipped = std::fs::read_to_string(root("procedures/magnetic-sensitivity.toml")).unwrap();
    let (head, tail) = shipped.split_once("[[channel]]\nid = \"field\"").unwrap();
    let tail = tail.split_once("[magnetic_test]").unwrap().1;
    let mut stated = String::new();
    for (i, level) in FIELD.iter().enumerate() {
        let (from, to) = (2 * i, 2 * i + 2);
        let _ = write!(
            stated,
            "[[magnetic_test.interval]]\nfrom = \"{from} min\"\nto = \"{to} min\"\nlevel = \"{level} mT\"\n"
        );
    }
    let tail = tail.replacen("[conditions]", &format!("{stated}\n[conditions]"), 1);
    let procedure = folder.path().join("p.toml");
    for (keys, code) in [("", 3), ("\nevidence = \"declared\"", 0)] {
        std::fs::write(&procedure, format!("{head}[magnetic_test]{keys}{tail}")).unwrap();
        let recording = folder.path().join("r.csv");
        let (got, result) = run(&procedure.to_string_lossy(), &recording.to_string_lossy(), "SN-1");
        assert_eq!(got, code, "{:#}", result["summary"]);
    }
}

#[test]
fn a_further_channel_in_step_with_the_level_is_named() {
    let recorded = turns(&FIELD, 0.05).record(34);
    let folder = tempfile::tempdir().unwrap();
    let mut out = String::from("time_s,rate_deg_h,temp_degC,field_mT,supply_V\n");
    for i in 0..recorded.rate.len() {
        let supply = 5.0 + 0.002 * (i * 7919 % 97) as f64 / 97.0 - 0.1 * recorded.level[i];
        let _ = writeln!(
            out,
            "{},{:.4},{:.3},{},{supply:.5}",
            recorded.time_s[i], recorded.rate[i], recorded.temperature[i], recorded.level[i]
        );
    }
    let recording = folder.path().join("r.csv");
    std::fs::write(&recording, out).unwrap();
    let shipped = std::fs::read_to_string(root("procedures/magnetic-sensitivity.toml")).unwrap();
    let channel = "\n[[channel]]\nid = \"volts\"\ncolumn = \"supply_V\"\nrole = \"supply\"\nunit = \"V\"\n\n[magnetic_test]\n";
    let procedure = folder.path().join("p.toml");
    std::fs::write(&procedure, shipped.replacen("\n[magnetic_test]\n", channel, 1)).unwrap();
    let (code, result) = run(&procedure.to_string_lossy(), &recording.to_string_lossy(), "SN-1");
    assert_eq!(code, 3, "{:#}", result["summary"]);
    let said = condition(&result, "influence_beside.volts");
    assert_eq!(said["status"], "invalid", "{said}");
    assert!(row(&result, "magnetic_sensitivity")["value"].is_null());
}

#[test]
fn mistakes_name_themselves() {
    let says = |result: &Value, id: &str| {
        assert!(invalid(result).iter().any(|i| i == id), "{id}: {:?}", invalid(result))
    };
    let (code, few) = on("bias-repeatability", "", &Series { runs: 4, ..series(0.02) }.record(1));
    says(&few, "runs.too_few");
    assert_eq!(code, 3);
    let (code, one) =
        on("bias-repeatability", "", &Series { runs: 1, run_s: 3000.0, ..series(0.02) }.record(2));
    says(&one, "runs.one");
    assert_eq!(code, 3);

    let field = |levels: &[f64]| on("magnetic-sensitivity", ",field_mT", &turns(levels, 0.05).record(3)).1;
    says(&field(&[0.0; 9]), "compared.never_on");
    says(&field(&[0.5, -0.5, 0.5, -0.5, 0.5, -0.5, 0.5, -0.5]), "compared.never_off");
    says(&field(&[0.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.5, 0.5]), "compared.no_return");
    says(&field(&[0.0, 0.0, 0.0, 0.5, 0.5, 0.5, 0.0, 0.0, 0.0]), "compared.too_few");
    let warms = Turns { warms: 0.8, ..turns(&FIELD, 0.05) }.record(4);
    says(&on("magnetic-sensitivity", ",field_mT", &warms).1, "compared.with_temperature");

    // A bias that follows the level itself under vibration, and its square in a field.
    let bent = Turns { bias: linear, ..shaken(0.1, |_| 1.0) }.record(5);
    says(&on("vibration", "", &bent).1, "compared.off_square");
    let square = Turns { bias: squared, ..turns(&FIELD, 1.0) }.record(6);
    says(&on("magnetic-sensitivity", ",field_mT", &square).1, "compared.off_line");
}
