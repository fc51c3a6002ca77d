//! Changes of quantities between phases: rows of their own, judged, without what both phases have in common.

use crate::support::quick::Quick;
use crate::support::synthetic::white;
use crate::support::{Said, altered, result, sagnac};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Runs a test of two phases on recordings whose means differ by `shift_deg_h`, with tables of changes.
fn run(folder: &Path, shift_deg_h: f64, changes: &str) -> Said {
    let quick = Quick::new("pass");
    let site = "[site]\nlatitude = \"55.98 deg\"\nlatitude_uncertainty = \"0.5 deg\"\nelevation = \"90 deg\"\n\
                [[instrument]]\nname = \"counter\"\nserial = \"7\"\n[[measurand]]\nid = \"static_bias\"\n[[measurand]]";
    altered(folder, "one.toml", &quick.procedure, &[("[[measurand]]", site)]);
    for (name, seed, mean) in [("before", 1, 12.5), ("after", 2, 12.5 + shift_deg_h)] {
        let row = |i: u64| format!("{i},{:.5}\n", mean + 0.1 * white(seed, i));
        let rows: String = (0..3000).map(row).collect();
        fs::write(folder.join(format!("{name}.csv")), format!("time_s,rate_deg_h\n{rows}")).unwrap();
    }
    let procedure = format!(
        "format = \"procedure/1\"\n[procedure]\nid = \"shock\"\ntitle = \"Shock\"\nrevision = \"A\"\n\
         [[phase]]\nid = \"before\"\nprocedure = \"one.toml\"\n[[phase]]\nid = \"after\"\nprocedure = \"one.toml\"\n{changes}"
    );
    fs::write(folder.join("shock.toml"), procedure).unwrap();
    let manifest = "format = \"manifest/1\"\nserial = \"SN-1\"\nseveral_phases = true\n\
                    [[file]]\npath = \"before.csv\"\nphase = \"before\"\n[[file]]\npath = \"after.csv\"\nphase = \"after\"\n";
    fs::write(folder.join("unit.toml"), manifest).unwrap();
    sagnac(folder, &["run", "shock.toml", "unit.toml", "--out", "r"])
}

fn change(measurand: &str, most: &str) -> String {
    format!(
        "[[compare]]\nmeasurand = \"{measurand}\"\nbefore = \"before\"\nafter = \"after\"\nmax_change = \"{most}\"\n"
    )
}

fn row(folder: &Path, id: &str) -> Value {
    let result = result(&folder.join("r"));
    let rows = result["measurands"].as_array().unwrap();
    rows.iter().find(|r| r["id"] == id).unwrap_or_else(|| panic!("no {id}")).clone()
}

#[test]
fn a_change_is_known_far_better_than_either_value_where_the_site_is_common() {
    let folder = tempfile::tempdir().unwrap();
    let said = run(folder.path(), 0.03, &change("static_bias", "0.05 deg/h"));
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    let found = row(folder.path(), "static_bias_change");
    let (value, low, high) = (
        found["value"].as_f64().unwrap(),
        found["interval"]["low"].as_f64().unwrap(),
        found["interval"]["high"].as_f64().unwrap(),
    );
    assert!(low < 0.03 && 0.03 < high && (value - 0.03).abs() < 0.02, "{found}");
    // Half a degree of latitude is 0.07 deg/h of Earth rate, in both phases alike.
    let single = row(folder.path(), "static_bias");
    let half =
        0.5 * (single["interval"]["high"].as_f64().unwrap() - single["interval"]["low"].as_f64().unwrap());
    assert!(half > 0.1 && high - low < 0.25 * half, "{single} {found}");
    assert_eq!(found["verdict"], "pass");
    let page = fs::read_to_string(folder.path().join("r/report.html")).unwrap();
    assert!(
        page.contains("Before and after") && page.contains("Static bias, change"),
        "the page tells the change"
    );

    assert_eq!(run(folder.path(), 0.2, &change("static_bias", "0.05 deg/h")).code, 1);
    assert_eq!(row(folder.path(), "static_bias_change")["verdict"], "fail");
    assert_eq!(run(folder.path(), 0.05, &change("static_bias", "0.05 deg/h")).code, 3);
}

#[test]
fn a_change_decides_nothing_where_a_phase_is_no_valid_test() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(run(folder.path(), 0.03, &change("static_bias", "0.05 deg/h")).code, 0);
    altered(
        folder.path(),
        "one.toml",
        &folder.path().join("one.toml").to_string_lossy(),
        &[("minimum_duration = \"10 min\"", "minimum_duration = \"10 h\"")],
    );
    let said = sagnac(folder.path(), &["run", "shock.toml", "unit.toml", "--out", "r"]);
    assert_eq!(said.code, 3, "{}{}", said.out, said.err);
    assert_eq!(row(folder.path(), "static_bias_change")["verdict"], "pass");
}

#[test]
fn a_change_without_a_limit_is_stated_and_judged_by_nobody() {
    let folder = tempfile::tempdir().unwrap();
    let change = "[[compare]]\nmeasurand = \"angle_random_walk\"\nbefore = \"before\"\nafter = \"after\"\n";
    let said = run(folder.path(), 0.0, change);
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    let found = row(folder.path(), "angle_random_walk_change");
    assert_eq!((found["verdict"].as_str(), found["limit"].is_null()), (Some("none"), true));
    assert!(found["value"].as_f64().unwrap().abs() < 2e-4, "{found}");
}

#[test]
fn mistakes_in_changes_are_named_at_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let swapped = |from: &str, to: &str| change("static_bias", "0.05 deg/h").replace(from, to);
    for (changes, says) in [
        (swapped("\"after\"\n", "\"aftre\"\n"), "after"),
        (swapped("\"before\"\n", "\"after\"\n"), "same phase"),
        (swapped("0.05 deg/h", "0.05 V"), "V"),
        (swapped("0.05 deg/h", "-1 deg/h"), "above 0"),
        (change("rate_random_walk", "1 deg/h/sqrt(h)"), "does not determine"),
    ] {
        let said = run(folder.path(), 0.0, &changes);
        assert_eq!(said.code, 2, "{changes}: {}", said.out);
        assert!(said.err.contains(says) && said.err.contains("shock.toml:"), "{changes}: {}", said.err);
    }
}
