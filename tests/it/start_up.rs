//! Start-up and power: the samples, and a recording that begins after switching on.

use crate::support::pairs::sample_once;
use crate::support::{altered, result, sagnac, shipped};
use sagnac_studies::bench::start_up::{SwitchedOn, over_temperature};
use serde_json::Value;
use std::fs;
use tempfile::tempdir;

fn fast() -> SwitchedOn {
    SwitchedOn::default()
}

fn slow() -> SwitchedOn {
    SwitchedOn { valid_s: 9.6, steady_a: 0.92, ..SwitchedOn::default() }
}

/// Samples with what stands in them.
fn files() -> [(&'static str, String); 2] {
    [("samples/start-up-pass.csv", fast().csv(81)), ("samples/start-up-fail.csv", slow().csv(83))]
}

fn row<'a>(result: &'a Value, id: &str) -> &'a Value {
    result["measurands"].as_array().unwrap().iter().find(|r| r["id"] == id).unwrap_or_else(|| panic!("{id}"))
}

fn holds(row: &Value, truth: f64) {
    let end = |name: &str| row["interval"][name].as_f64().unwrap_or_else(|| panic!("{row}"));
    let half = 0.25 * (end("high") - end("low"));
    assert!((end("low") - half..=end("high") + half).contains(&truth), "{truth}: {row}");
}

#[test]
fn the_samples_are_what_the_generator_gives() {
    for (path, text) in files() {
        let stands = fs::read_to_string(shipped(path)).unwrap_or_default();
        assert!(stands == text, "{path} differs: write the samples anew");
    }
}

#[test]
#[ignore = "writes the samples: cargo test --test it start_up -- --ignored write_the_samples"]
fn write_the_samples() {
    for (path, text) in files() {
        fs::write(shipped(path), text).unwrap();
    }
}

#[test]
fn times_and_powers_of_the_samples_come_back() {
    for (name, unit) in [("start-up-pass", fast()), ("start-up-fail", slow())] {
        let r = sample_once(name).result();
        holds(row(r, "time_to_first_sample"), unit.first_s);
        holds(row(r, "time_to_valid_data"), unit.valid_s);
        holds(row(r, "power_steady"), 5.0 * unit.steady_a);
        assert!((row(r, "inrush_current")["value"].as_f64().unwrap() - 1.9).abs() < 0.5);
    }
    let failed = sample_once("start-up-fail").result();
    assert_eq!(row(failed, "time_to_valid_data")["verdict"], "fail");
    assert_eq!(row(failed, "time_to_first_sample")["verdict"], "pass");
}

#[test]
fn a_recording_that_begins_after_switching_on_gives_bounds_only() {
    let folder = tempdir().unwrap();
    fs::write(folder.path().join("r.csv"), SwitchedOn { on_s: -1.0, ..fast() }.csv(5)).unwrap();
    let procedure = shipped("procedures/start-up.toml");
    let said = sagnac(folder.path(), &["run", &procedure, "r.csv", "--serial", "SN-1", "--out", "o"]);
    assert_eq!(said.code, 3, "{}{}", said.out, said.err);
    let r = result(&folder.path().join("o"));
    for id in ["time_to_first_sample", "time_to_valid_data", "power_peak", "inrush_current"] {
        assert!(row(&r, id)["value"].is_null(), "{}", row(&r, id));
    }
    let valid = row(&r, "time_to_valid_data")["lower_limit"]["value"].as_f64().unwrap();
    assert!((valid - 3.18).abs() < 0.03, "{valid}");
    holds(row(&r, "power_steady"), 3.5);
}

#[test]
fn power_and_inrush_stand_in_a_row_of_every_zone_of_temperature() {
    let folder = tempdir().unwrap();
    let at = |steady_a, inrush_a| SwitchedOn { steady_a, inrush: (inrush_a, 0.05), seconds: 80.0, ..fast() };
    let starts = [(-40.0, at(1.1, 3.9)), (-39.0, at(1.0, 3.5)), (23.0, at(0.7, 1.9)), (60.0, at(0.6, 1.7))];
    fs::write(folder.path().join("r.csv"), over_temperature(&starts, 91)).unwrap();
    let warm =
        "[[channel]]\nid = \"temp\"\ncolumn = \"temp_degC\"\nrole = \"temperature\"\nunit = \"degC\"\n";
    let zones = ["-40", "23", "40"]
        .map(|t| format!("[[start_up_test.zone]]\nat = \"{t} degC\"\nwithin = \"3 degC\"\n"));
    let with_zones = format!("{warm}[start_up_test]\n");
    let file = shipped("procedures/start-up.toml");
    let conditions = format!("{}[conditions]\n", zones.concat());
    let changes = [("[start_up_test]\n", with_zones.as_str()), ("[conditions]\n", conditions.as_str())];
    let procedure = altered(folder.path(), "p.toml", &file, &changes);
    let said = sagnac(folder.path(), &["run", &procedure, "r.csv", "--serial", "SN-1", "--out", "o"]);
    let found = result(&folder.path().join("o"));
    let in_zone = |id: &str, zone: &str| -> Value {
        let name = format!("rate@{zone}");
        let rows = found["measurands"].as_array().unwrap();
        rows.iter()
            .find(|r| r["id"] == id && r["channel"] == name.as_str())
            .unwrap_or_else(|| panic!("{id} {said:?}"))
            .clone()
    };
    // At −40 °C the unit is switched on twice: the larger counts.
    holds(&in_zone("power_steady", "-40"), 5.5);
    holds(&in_zone("power_steady", "23"), 3.5);
    assert_eq!(in_zone("power_steady", "-40")["verdict"], "fail");
    assert_eq!(in_zone("power_steady", "23")["verdict"], "pass");
    assert_eq!(in_zone("inrush_current", "-40")["verdict"], "fail");
    assert_eq!(in_zone("inrush_current", "23")["verdict"], "pass");
    assert!(
        in_zone("power_peak", "-40")["value"].as_f64().unwrap()
            > in_zone("power_peak", "23")["value"].as_f64().unwrap()
    );
    let none = in_zone("power_steady", "40");
    assert!(none["value"].is_null() && none["notes"][0]["id"] == "start_up.zone_empty", "{none}");
    let without = altered(folder.path(), "q.toml", &file, &changes[1..]);
    let said = sagnac(folder.path(), &["check", &without]);
    assert!(said.code != 0 && (said.out.clone() + &said.err).contains("temperature"), "{said:?}");
}

#[test]
fn a_band_tells_valid_data_and_a_missing_sign_is_refused() {
    let folder = tempdir().unwrap();
    fs::write(folder.path().join("r.csv"), fast().csv(7)).unwrap();
    let shipped = shipped("procedures/start-up.toml");
    let band =
        altered(folder.path(), "band.toml", &shipped, &[("valid_mask = 1", "valid_band = \"0.5 deg/h\"")]);
    let said = sagnac(folder.path(), &["run", &band, "r.csv", "--serial", "SN-1", "--out", "o"]);
    assert_ne!(said.code, 2, "{}", said.err);
    let found = result(&folder.path().join("o"));
    let found = row(&found, "time_to_valid_data")["value"].as_f64().unwrap();
    // 3·e^(−t/2) falls to 0.5 after 3.6 s; means of 1 s.
    assert!((2.5..=6.0).contains(&found), "{found}");
    for (from, to, says) in [
        ("valid_mask = 1\n", "", "valid_mask"),
        ("role = \"current\"", "role = \"auxiliary\"", "current"),
        ("role = \"supply\"", "role = \"auxiliary\"", "supply"),
        ("valid_mask = 1\n", "valid_mask = 1\nvalid_band = \"1 deg/h\"\n", "valid_band"),
    ] {
        altered(folder.path(), "p.toml", &shipped, &[(from, to)]);
        let said = sagnac(folder.path(), &["check", "p.toml"]);
        assert!(said.code != 0 && (said.out.clone() + &said.err).contains(says), "{to}: {said:?}");
    }
}
