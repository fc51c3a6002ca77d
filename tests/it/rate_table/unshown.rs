//! What a test cannot show has its row, and a limit on it decides nothing.

use super::runs::run;
use super::{root, tilted, two_axes_csv};
use sagnac_studies::bench::two_axes::TwoAxes;
use serde_json::Value;
use std::path::Path;
use std::process::Command;

/// A shipped procedure with texts replaced, in a folder.
fn changed(folder: &Path, name: &str, changes: &[(&str, &str)], more: &str) -> std::path::PathBuf {
    let mut text = std::fs::read_to_string(root(&format!("procedures/{name}.toml"))).unwrap();
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    let path = folder.join("procedure.toml");
    std::fs::write(&path, text + more).unwrap();
    path
}

fn row<'a>(result: &'a Value, id: &str) -> &'a Value {
    let rows = result["measurands"].as_array().unwrap();
    rows.iter().find(|r| r["id"] == id).unwrap_or_else(|| panic!("no row {id}"))
}

/// The row is there, shows nothing, decides nothing, and says why by this note.
fn is_not_shown(result: &Value, id: &str, note: &str) {
    let row = row(result, id);
    assert_eq!(row["value"], Value::Null, "{row}");
    assert_eq!((&row["identifiable"], &row["verdict"]), (&false.into(), &"indeterminate".into()), "{row}");
    let said: Vec<&str> = row["notes"].as_array().unwrap().iter().filter_map(|n| n["id"].as_str()).collect();
    assert!(said.contains(&note), "{id}: {said:?}");
}

fn tilts_at(inner: &[f64]) -> (i32, Value) {
    let folder = tempfile::tempdir().unwrap();
    let bench = TwoAxes { inner: inner.to_vec(), tilt: (0.4e-3, -0.3e-3), ..tilted() };
    let data = folder.path().join("recording.csv");
    std::fs::write(&data, two_axes_csv(&bench)).unwrap();
    let shorter = [("minimum_duration = \"6 min\"", "minimum_duration = \"1 min\"")];
    run(&changed(folder.path(), "misalignment", &shorter, ""), &data)
}

#[test]
fn two_inner_angles_a_quarter_of_a_turn_apart_show_both_tilts_and_fewer_say_what_they_lack() {
    let (code, two) = tilts_at(&[0.0, 90.0]);
    assert_eq!(code, 0, "{}", two["summary"]);
    for (id, truth) in [("misalignment_x", 0.4), ("misalignment_y", -0.3)] {
        let interval = &row(&two, id)["interval"];
        let (low, high) = (interval["low"].as_f64().unwrap(), interval["high"].as_f64().unwrap());
        assert!(low <= truth && truth <= high && high - low < 1.0, "{id}: {low} .. {high}");
    }
    let (code, opposite) = tilts_at(&[0.0, 180.0]);
    assert_eq!(code, 3);
    is_not_shown(&opposite, "misalignment_x", "known.no_inner_angle");
    assert!((row(&opposite, "misalignment_y")["value"].as_f64().unwrap() + 0.3).abs() < 0.1);
    let (code, one) = tilts_at(&[0.0]);
    assert_eq!(code, 3);
    is_not_shown(&one, "misalignment_x", "known.few_outer_turns");
    is_not_shown(&one, "misalignment_y", "known.few_outer_turns");
}

const TWO_LIMITS: &str = "
[[limit]]
measurand = \"scale_factor_error\"
max_abs = \"2000 ppm\"
";

#[test]
fn positions_between_which_the_earth_rate_does_not_differ_show_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let same = [("elevation = \"-90 deg\"", "elevation = \"90 deg\"")];
    let procedure = changed(folder.path(), "multi-position", &same, TWO_LIMITS);
    let (code, result) = run(&procedure, &root("samples/multi-position-pass.csv"));
    assert_eq!(code, 3, "{}", result["summary"]);
    is_not_shown(&result, "scale_factor_error", "unshown.few_positions");
    is_not_shown(&result, "scale_factor_bias", "unshown.few_positions");
    assert!(checked(&procedure).contains("cannot determine `scale_factor_error`"));
}

fn checked(procedure: &Path) -> String {
    let done = Command::new(env!("CARGO_BIN_EXE_sagnac"))
        .args(["check", "--lang", "en"])
        .arg(procedure)
        .output()
        .unwrap();
    assert_eq!(done.status.code(), Some(0), "{done:?}");
    String::from_utf8_lossy(&done.stdout).into_owned()
}

#[test]
fn a_limit_on_what_the_test_never_gives_is_not_counted_as_met() {
    let folder = tempfile::tempdir().unwrap();
    let cross =
        "\n[[measurand]]\nid = \"cross_axis\"\n[[limit]]\nmeasurand = \"cross_axis\"\nmax_abs = \"0.001\"\n";
    let procedure = changed(folder.path(), "scale-factor", &[], cross);
    let (code, result) = run(&procedure, &root("samples/scale-factor-pass.csv"));
    assert_eq!(code, 3, "{}", result["summary"]);
    is_not_shown(&result, "cross_axis", "unshown.needs_turns");
    assert_eq!(row(&result, "scale_factor_error")["verdict"], "pass");
    assert!(checked(&procedure).contains("cannot determine `cross_axis`"));
    // A lower limit below zero is not met by a quantity of either sign of which nothing is known.
    let below = cross.replace("max_abs = \"0.001\"", "min = \"-0.001\"");
    let (code, result) =
        run(&changed(folder.path(), "scale-factor", &[], &below), &root("samples/scale-factor-pass.csv"));
    assert_eq!(code, 3, "{}", result["summary"]);
}

#[test]
fn a_limit_on_the_scale_factor_is_stated_in_the_unit_of_the_result() {
    let folder = tempfile::tempdir().unwrap();
    let sample = root("samples/scale-factor-pass.csv");
    let limit = |text: &str| format!("\n[[limit]]\nmeasurand = \"scale_factor\"\n{text}\n");
    for (text, code, verdict) in [
        ("min = \"19.9 count/arcsec\"\nmax = \"20.1 count/arcsec\"", 0, "pass"),
        // The same in other words: 20 counts an arc second.
        ("min = \"71640 count/deg\"\nmax = \"72360 count/deg\"", 0, "pass"),
        ("max = \"19.9 count/arcsec\"", 1, "fail"),
    ] {
        let (got, result) = run(&changed(folder.path(), "scale-factor", &[], &limit(text)), &sample);
        assert_eq!(got, code, "{text}: {}", result["summary"]);
        let row = row(&result, "scale_factor");
        assert_eq!((&row["verdict"], &row["limit"]["unit"]), (&verdict.into(), &"count/arcsec".into()));
    }
    for (text, words) in [
        ("max = \"20.1 V\"", "count/arcsec"),
        ("max = \"20.1\"", "is given in count/arcsec"),
        ("max = 20.1", "count/(deg/h)"),
        ("min = \"0.9\"\nmax = \"20.1 count/arcsec\"", "in one unit"),
    ] {
        let path = changed(folder.path(), "scale-factor", &[], &limit(text));
        let done = Command::new(env!("CARGO_BIN_EXE_sagnac"))
            .args(["check", "--lang", "en"])
            .arg(&path)
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&done.stdout).into_owned();
        assert_eq!(done.status.code(), Some(2), "{text}: {said}");
        assert!(said.contains(words), "{text}: {said}");
    }
}
