//! Influences that a procedure declares: the same numbers as the tests with tables of their own, and mistakes by their names.

use super::{condition, on_table, pressure, root, row, run, switched, text};
use crate::support::pairs::sample_once;
use sagnac_studies::bench::influence::{PRESSURE, SWITCHED, Turned, Turns, turned};
use serde_json::Value;
use std::process::Command;

/// A shipped procedure with parts replaced.
fn changed(procedure: &str, parts: &[(&str, &str)]) -> String {
    let mut text = std::fs::read_to_string(root(&format!("procedures/{procedure}.toml"))).unwrap();
    for (old, new) in parts {
        assert!(text.contains(old), "{procedure}: {old}");
        text = text.replace(old, new);
    }
    text
}

/// Runs a procedure text on a recording text; gives the exit code and the result.
fn tested(procedure: &str, recording: &str) -> (i32, Value) {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    std::fs::write(at("p.toml"), procedure).unwrap();
    std::fs::write(at("r.csv"), recording).unwrap();
    run(&at("p.toml"), &at("r.csv"), "SN-1")
}

/// What `check` says of a procedure text that is wrong.
fn refused(procedure: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("p.toml"), procedure).unwrap();
    let done = Command::new(env!("CARGO_BIN_EXE_sagnac"))
        .current_dir(folder.path())
        .args(["check", "p.toml"])
        .output()
        .unwrap();
    assert_eq!(done.status.code(), Some(2), "{}", String::from_utf8_lossy(&done.stdout));
    String::from_utf8_lossy(&done.stderr).into_owned() + &String::from_utf8_lossy(&done.stdout)
}

#[test]
fn a_declared_field_has_the_numbers_of_the_magnetic_test() {
    let own = sample_once("magnetic-sensitivity-pass").result();
    let declared = changed(
        "magnetic-sensitivity",
        &[
            ("[magnetic_test]\nref", "[influence_test]\nchannel = \"field\"\nlaw = \"linear\"\nref"),
            ("\"magnetic_sensitivity\"", "\"influence_sensitivity\""),
        ],
    );
    let recording = std::fs::read_to_string(root("samples/magnetic-sensitivity-pass.csv")).unwrap();
    let (code, found) = tested(&declared, &recording.replace("SN-0113", "SN-1"));
    assert_eq!(code, 0, "{:#}", found["summary"]);
    let (a, b) = (row(own, "magnetic_sensitivity"), row(&found, "influence_sensitivity"));
    for member in ["value", "interval", "unit", "verdict", "notes"] {
        assert_eq!(a[member], b[member], "{member}");
    }
    assert_eq!(b["channel"], "rate@field");
    assert_eq!(row(own, "bias_shift")["value"], row(&found, "bias_shift")["value"]);
}

#[test]
fn a_declared_switch_needs_evidence_as_other_influences_do() {
    let recording = text("SN-1", "", &switched(0.01).record(41));
    let mut intervals = String::new();
    for (i, level) in SWITCHED.iter().enumerate() {
        let (from, to) = (2 * i, 2 * i + 2);
        intervals += &format!(
            "[[influence_test.interval]]\nfrom = \"{from} min\"\nto = \"{to} min\"\nlevel = \"{level}\"\n"
        );
    }
    let of = |keys: &str| {
        let shipped = changed(
            "electromagnetic-immunity",
            &[
                ("channel = \"emi\"", &format!("name = \"emi\"\n{keys}")),
                ("[conditions]", &format!("{intervals}\n[conditions]")),
            ],
        );
        let (head, tail) = shipped.split_once("[[channel]]\nid = \"emi\"").unwrap();
        let tail = tail.split_once("[influence_test]").unwrap().1;
        tested(&format!("{head}[influence_test]{tail}"), &recording)
    };
    let (code, found) = of("");
    assert_eq!(code, 3, "{:#}", found["summary"]);
    assert_eq!(condition(&found, "influence_acted")["status"], "invalid");
    let (code, found) = of("evidence = \"declared\"");
    assert_eq!(code, 0, "{:#}", found["summary"]);
    assert_eq!(row(&found, "bias_shift")["channel"], "rate@emi:1");
}

#[test]
fn one_level_tells_no_line_from_a_parabola() {
    let once =
        Turns { levels: PRESSURE.map(|p| if p == 80.0 { 150.0 } else { p }).to_vec(), ..pressure(0.002) };
    let procedure = changed("pressure-sensitivity", &[]);
    let (code, found) = tested(&procedure, &text("SN-1", ",pressure_kPa", &once.record(42)));
    assert_eq!(code, 3, "{:#}", found["summary"]);
    for id in ["influence_sensitivity", "influence_sensitivity_quadratic"] {
        let r = row(&found, id);
        assert!(r["value"].is_null() && r["verdict"] == "indeterminate", "{r}");
        assert!(r["notes"].to_string().contains("compared.few_levels"), "{r}");
    }
    assert!(row(&found, "bias_shift")["value"].is_number());
}

#[test]
fn a_table_that_keeps_one_rate_separates_nothing() {
    let one = Turned { rates: vec![10.0], ..turned(0.001, 0.3) };
    let procedure = changed("scale-factor-under-pressure", &[]);
    let (code, found) = tested(&procedure, &on_table("SN-1", &one, 43));
    assert_eq!(code, 3, "{:#}", found["summary"]);
    let rates = condition(&found, "influence_rates");
    assert_eq!((&rates["status"], &rates["message"]["id"]), (&"invalid".into(), &"compared.one_rate".into()));
    assert!(row(&found, "scale_factor_influence_sensitivity")["value"].is_null());
}

#[test]
fn mistakes_of_a_declared_influence_name_themselves() {
    let pressure = |old: &str, new: &str| refused(&changed("pressure-sensitivity", &[(old, new)]));
    let said = pressure("\"linear_quadratic\"", "\"linear\"");
    assert!(said.contains("`influence_sensitivity_quadratic` is no term of the law"), "{said}");
    assert!(said.contains("p.toml:") && said.contains("linear_quadratic"), "{said}");
    let said = pressure("channel = \"baro\"", "channel = \"temp\"");
    assert!(said.contains("`temp` is no channel that tells a level"), "{said}");
    let said = pressure("\"101.3 kPa\"", "\"101.3 V\"");
    assert!(said.contains("`V`") || said.contains("a voltage"), "{said}");
    let said = pressure("law = ", "unit = \"kPa\"\nlaw = ");
    assert!(said.contains("the unit of the level is that of its channel"), "{said}");
    let said = pressure("\"0.005 deg/h/kPa\"", "\"0.005 deg/h/V\"");
    assert!(said.contains("deg/h/kPa") && said.contains("deg/h/V"), "{said}");
    let said = pressure("\"0.005 deg/h/kPa\"", "\"0.005 deg/h\"");
    assert!(said.contains("`deg/h` is not a unit of a change per level"), "{said}");
    let said = pressure("law = ", "acts_on = \"bias_and_scale_factor\"\nlaw = ");
    assert!(said.contains("the scale factor needs a channel with the role `table_rate`"), "{said}");
    let table = |old: &str, new: &str| refused(&changed("scale-factor-under-pressure", &[(old, new)]));
    let said = table("\"bias_and_scale_factor\"", "\"bias\"");
    assert!(said.contains("`scale_factor_influence_sensitivity` needs a test in which"), "{said}");
    let said = table("channel = \"baro\"", "name = \"baro\"");
    assert!(said.contains("the level of the influence is unknown"), "{said}");
}
