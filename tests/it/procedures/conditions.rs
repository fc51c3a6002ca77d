//! Conditions on channels beside the output: ranges of pressure and the like, bits of status words.

use crate::support::quick::Quick;
use crate::support::synthetic::white;
use crate::support::{Said, altered, result, sagnac};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Channels and conditions of the quick test with a barometer and a status word.
const CHANNELS: &str = "[[channel]]\nid = \"baro\"\ncolumn = \"baro_hPa\"\nrole = \"pressure\"\nunit = \"hPa\"\n\
    [[channel]]\nid = \"status\"\ncolumn = \"status\"\nrole = \"status\"\nunit = \"1\"\n[conditions]\n";

/// Runs the quick test with tables of conditions. The pressure is 101.3 kPa with an excursion to 102; bit 0 of the status
/// says that data are valid, and bit 4 tells a failure in three samples.
fn run(folder: &Path, tables: &str) -> Said {
    let quick = Quick::new("pass");
    let row = |i: u64| {
        let hecto_pascals = if (1500..1530).contains(&i) { 1020.0 } else { 1013.0 } + 0.01 * white(3, i);
        let status = if (1000..1003).contains(&i) { 17 } else { 1 };
        format!("{i},{:.5},{hecto_pascals:.3},{status}\n", 12.5 + 0.1 * white(1, i))
    };
    let rows: String = (0..3000).map(row).collect();
    fs::write(folder.join("bench.csv"), format!("time_s,rate_deg_h,baro_hPa,status\n{rows}")).unwrap();
    let changes = [("[conditions]\n", CHANNELS), ("[[measurand]]", &format!("{tables}\n[[measurand]]"))];
    let procedure = altered(folder, "bench.toml", &quick.procedure, &changes);
    let args = ["run", &procedure, "bench.csv", "--limits", &quick.limits, "--serial", "SN-1", "--out", "r"];
    sagnac(folder, &args)
}

fn condition(folder: &Path, id: &str) -> Value {
    let result = result(&folder.join("r"));
    let found = result["conditions"].as_array().unwrap().iter().find(|c| c["id"] == id).cloned();
    found.unwrap_or_else(|| panic!("no condition {id}"))
}

#[test]
fn a_range_holds_in_the_unit_of_the_channel_and_is_broken_by_an_excursion() {
    let folder = tempfile::tempdir().unwrap();
    let range = |max: &str| {
        format!(
            "[[conditions.range]]\nchannel = \"baro\"\nmin = \"95 kPa\"\nmax = \"{max}\"\n\
             sensor_uncertainty = \"0.2 hPa\""
        )
    };
    let said = run(folder.path(), &range("1050 hPa"));
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    let held = condition(folder.path(), "range.baro");
    assert_eq!(held["status"], "ok");
    assert!((held["observed"]["max"].as_f64().unwrap() - 102.0).abs() < 0.01, "{held}");

    let said = run(folder.path(), &range("1015 hPa"));
    assert_eq!(said.code, 3, "{}{}", said.out, said.err);
    assert_eq!(condition(folder.path(), "range.baro")["status"], "invalid");

    // 102.00 kPa lies within the uncertainty of the sensor of the bound.
    let said = run(folder.path(), &range("1020.3 hPa"));
    assert_eq!(said.code, 3, "{}{}", said.out, said.err);
    let note = condition(folder.path(), "range.baro")["note"].to_string();
    assert!(note.contains("not proven"), "{note}");
}

#[test]
fn failure_bits_have_a_budget_and_valid_bits_must_be_there() {
    let folder = tempfile::tempdir().unwrap();
    let status = |keys: &str| format!("[[conditions.status]]\nchannel = \"status\"\n{keys}");
    let said = run(folder.path(), &status("failure_mask = 240\nvalid_mask = 1"));
    assert_eq!(said.code, 3, "{}{}", said.out, said.err);
    let broken = condition(folder.path(), "status.status");
    assert_eq!(broken["observed"]["count"], 3.0, "{broken}");
    assert!(broken["note"].as_str().unwrap().contains("1000"), "{broken}");

    let said = run(folder.path(), &status("failure_mask = 240\nallowed = \"0.1 %\""));
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    assert_eq!(condition(folder.path(), "status.status")["status"], "remark");

    let said = run(folder.path(), &status("valid_mask = 2"));
    assert_eq!(said.code, 3, "{}{}", said.out, said.err);
    assert_eq!(condition(folder.path(), "status.status")["observed"]["count"], 3000.0);
}

#[test]
fn conditions_that_judge_nothing_or_cannot_be_met_are_refused_at_their_place() {
    let folder = tempfile::tempdir().unwrap();
    for (tables, place, says) in [
        ("[[conditions.range]]\nchannel = \"baro\"", "bench.toml:", "neither `min` nor `max`"),
        ("[[conditions.range]]\nchannel = \"baro\"\nmin = \"5 V\"", "bench.toml:", "V"),
        (
            "[[conditions.range]]\nchannel = \"baro\"\nmin = \"2 kPa\"\nmax = \"1 kPa\"",
            "bench.toml:",
            "below",
        ),
        ("[[conditions.range]]\nchannel = \"bara\"\nmin = \"2 kPa\"", "bench.toml:", "baro"),
        ("[[conditions.status]]\nchannel = \"status\"", "bench.toml:", "no bit is judged"),
        ("[[conditions.status]]\nchannel = \"baro\"\nvalid_mask = 1", "bench.toml:", "role `status`"),
    ] {
        let said = run(folder.path(), tables);
        assert_eq!(said.code, 2, "{tables}: {}", said.out);
        assert!(said.err.contains(place) && said.err.contains(says), "{tables}: {}", said.err);
    }
}
