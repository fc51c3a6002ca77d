//! Results of other tests: a row each, judged as any row, and never taken for measured.

use crate::support::quick::Quick;
use crate::support::{Said, altered, result, sagnac};
use serde_json::Value;
use std::fs;
use std::path::Path;

const ASKED: &str = "[[external]]\nid = \"leak_rate\"\nunit = \"Pa\"\n\
    [[derived_limit]]\nderived = \"leak_rate\"\nmax = \"0.03 Pa\"\n";

/// Runs the quick test of a procedure that asks for a leak rate, with the tables of a manifest.
fn run(folder: &Path, asked: &str, manifest: &str) -> Said {
    let quick = Quick::new("pass");
    let tables = format!("{asked}\n[[measurand]]");
    let procedure = altered(folder, "p.toml", &quick.procedure, &[("[[measurand]]", &tables)]);
    fs::copy(&quick.recording, folder.join("r.csv")).unwrap();
    let text = format!("format = \"manifest/1\"\nserial = \"SN-1\"\n[[file]]\npath = \"r.csv\"\n{manifest}");
    fs::write(folder.join("unit.toml"), text).unwrap();
    sagnac(folder, &["run", &procedure, "unit.toml", "--limits", &quick.limits, "--out", "r"])
}

fn row(folder: &Path) -> Value {
    let result = result(&folder.join("r"));
    result["measurands"].as_array().unwrap().iter().find(|r| r["id"] == "leak_rate").unwrap().clone()
}

#[test]
fn a_stated_result_is_judged_in_the_unit_of_the_row_with_its_certificate() {
    let folder = tempfile::tempdir().unwrap();
    let stated = |value: &str, interval: &str| {
        format!(
            "[[external]]\nid = \"leak_rate\"\nunit = \"kPa\"\nvalue = {value}\ninterval = {interval}\n\
             certificate = \"LT-7\"\nlaboratory = \"Leak bench\"\nsha256 = \"{}\"\n",
            "ab".repeat(32)
        )
    };
    let said = run(folder.path(), ASKED, &stated("2e-5", "[1.8e-5, 2.2e-5]"));
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    let found = row(folder.path());
    assert!((found["value"].as_f64().unwrap() - 0.02).abs() < 1e-12, "{found}");
    assert!((found["interval"]["high"].as_f64().unwrap() - 0.022).abs() < 1e-5, "{found}");
    assert_eq!((found["method"].as_str(), found["verdict"].as_str()), (Some("external"), Some("pass")));
    let told = found["notes"].to_string();
    assert!(told.contains("LT-7") && told.contains("Not measured from this recording"), "{told}");
    let page = fs::read_to_string(folder.path().join("r/report.html")).unwrap();
    assert!(page.contains("LT-7"), "the certificate stands on the page");

    assert_eq!(run(folder.path(), ASKED, &stated("5e-5", "[4.8e-5, 5.2e-5]")).code, 1);
    assert_eq!(run(folder.path(), ASKED, &stated("3e-5", "[2.5e-5, 3.5e-5]")).code, 3);
}

#[test]
fn a_result_that_is_missing_or_has_no_interval_decides_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let said = run(folder.path(), ASKED, "");
    assert_eq!(said.code, 3, "{}{}", said.out, said.err);
    assert!(row(folder.path())["value"].is_null());
    let said = run(folder.path(), ASKED, "[[external]]\nid = \"leak_rate\"\nunit = \"Pa\"\nvalue = 0.001\n");
    assert_eq!(said.code, 3, "{}{}", said.out, said.err);
    let other = "[[external]]\nid = \"leak_rate\"\nunit = \"V\"\nvalue = 0.001\ninterval = [0, 1]\n";
    assert_eq!(run(folder.path(), ASKED, other).code, 3);
}

#[test]
fn the_procedure_may_state_the_result_and_the_manifest_goes_before_it() {
    let folder = tempfile::tempdir().unwrap();
    let own = ASKED.replace("unit = \"Pa\"", "unit = \"Pa\"\nvalue = 0.01\ninterval = [0.009, 0.011]");
    assert_eq!(run(folder.path(), &own, "").code, 0);
    let worse = "[[external]]\nid = \"leak_rate\"\nunit = \"Pa\"\nvalue = 0.2\ninterval = [0.19, 0.21]\n";
    assert_eq!(run(folder.path(), &own, worse).code, 1);
}

#[test]
fn mistakes_are_named_at_their_place() {
    let folder = tempfile::tempdir().unwrap();
    for (asked, manifest, says) in [
        ("[[external]]\nid = \"static_bias\"\nunit = \"deg/h\"\n", "", "static_bias"),
        ("[[external]]\nid = \"a\"\nunit = \"Pa\"\n[[external]]\nid = \"a\"\nunit = \"Pa\"\n", "", "second"),
        (ASKED, "[[external]]\nid = \"leak_rate\"\nunit = \"Pa\"\n", "value"),
        (
            ASKED,
            "[[external]]\nid = \"leak_rate\"\nunit = \"Pa\"\nvalue = 1\ninterval = [2, 3]\n",
            "interval",
        ),
        (ASKED, "[[external]]\nid = \"leak_rate\"\nunit = \"Pa\"\nvalue = 1\nsha256 = \"12\"\n", "SHA-256"),
    ] {
        let said = run(folder.path(), asked, manifest);
        assert_eq!(said.code, 2, "{asked}{manifest}: {}", said.out);
        assert!(said.err.contains(says) && said.err.contains(".toml:"), "{asked}{manifest}: {}", said.err);
    }
}
