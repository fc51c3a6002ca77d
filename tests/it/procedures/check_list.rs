//! Which checks were made, and why the others were not: in the result and in both reports, from what was executed.

use crate::support::pairs::sample_once;
use crate::support::shared::tested_once;
use crate::support::{altered, limits, procedure, result, sagnac, sample};
use serde_json::Value;
use std::path::Path;
use tempfile::tempdir;

fn run(folder: &Path, procedure: &str, recording: &str, more: &[&str]) -> Value {
    let mut args = vec!["run", procedure, recording, "--out", "r", "--lang", "en"];
    args.extend(more);
    let _ = std::fs::remove_dir_all(folder.join("r"));
    sagnac(folder, &args);
    result(&folder.join("r"))
}

fn check<'a>(result: &'a Value, id: &str) -> &'a Value {
    let all = result["checks"].as_array().unwrap();
    all.iter().find(|c| c["id"] == id).unwrap_or_else(|| panic!("no {id} in {all:#?}"))
}

#[test]
fn a_check_that_lacks_what_it_needs_is_listed_with_the_reason() {
    let dir = tempdir().unwrap();
    let limits = limits();
    let more = ["--limits", limits.as_str(), "--serial", "SN-0001"];
    let r = tested_once("pass").result();
    assert_eq!((check(r, "earth_rate")["status"].as_str()), Some("made"));
    assert_eq!(check(r, "earth_rate")["evidence"], "earth_rate");
    assert_eq!(check(r, "serial_number")["status"], "made");
    assert_eq!(check(r, "column_units")["status"], "made");
    // Without the site the sign of the output cannot be checked, and the report says so.
    std::fs::write(
        dir.path().join("bare.toml"),
        "format = \"procedure/1\"\n[procedure]\nid = \"p\"\ntitle = \"P\"\nrevision = \"A\"\n[[channel]]\nid = \"time\"\n\
         column = \"time_s\"\nrole = \"time\"\nunit = \"s\"\n[[channel]]\nid = \"rate\"\ncolumn = \"rate_deg_h\"\n\
         role = \"rate\"\nunit = \"deg/h\"\n[[measurand]]\nid = \"angle_random_walk\"\n",
    )
    .unwrap();
    let r = run(dir.path(), "bare.toml", &sample("pass"), &more);
    let unmade = check(&r, "earth_rate");
    assert_eq!(unmade["status"], "not_made");
    assert_eq!(unmade["reason"]["text"], "no site given");
    assert!(unmade["evidence"].is_null());
    for name in ["report.html", "report.md"] {
        let page = std::fs::read_to_string(dir.path().join("r").join(name)).unwrap();
        assert!(page.contains("Checks not made") && page.contains("no site given"), "{name}");
        assert!(page.contains("sign, axis and unit against the Earth rate"), "{name}");
    }
    // No typical noise, no time stamps, no serial number in the file.
    let rows: String = (0..4000).map(|i| format!("{}\n", 12.4 + 0.01 * f64::from(i % 7))).collect();
    std::fs::write(dir.path().join("r.csv"), format!("rate\n{rows}")).unwrap();
    std::fs::write(
        dir.path().join("p.toml"),
        "format = \"procedure/1\"\n[procedure]\nid = \"p\"\ntitle = \"P\"\nrevision = \"A\"\n[recording]\n\
         sample_rate = \"1 Hz\"\n[[channel]]\nid = \"rate\"\ncolumn = 1\nrole = \"rate\"\nunit = \"deg/h\"\n\
         [[measurand]]\nid = \"angle_random_walk\"\n",
    )
    .unwrap();
    let r = run(dir.path(), "p.toml", "r.csv", &["--serial", "S"]);
    for (id, reason) in [
        ("clock", "no timestamps"),
        ("noise_level", "no typical value"),
        ("column_units", "states no unit"),
        ("serial_number", "states no serial number"),
        ("temperature_unit", "no nominal temperature"),
    ] {
        let c = check(&r, id);
        assert_eq!(c["status"], "not_made", "{c}");
        assert!(c["reason"]["text"].as_str().unwrap().contains(reason), "{c}");
    }
}

#[test]
fn every_kind_of_test_lists_its_checks() {
    for (name, ids) in [
        ("scale-factor-pass", &["table_response", "table_reached", "earth_sign", "clock_by_turns"][..]),
        ("multi-position-pass", &["earth_in_positions"]),
        ("magnetic-sensitivity-pass", &["temperature_in_step", "earth_rate", "noise_level"]),
        ("bias-repeatability-pass", &["earth_rate", "distribution"]),
        ("warm-up-pass", &["earth_rate", "temperature_unit"]),
    ] {
        let r = sample_once(name).result();
        for id in ids.iter().chain(&["plausible", "full_scale", "column_units", "serial_number"]) {
            check(r, id);
        }
        for c in r["checks"].as_array().unwrap() {
            assert_eq!(c["status"] == "made", c["reason"].is_null(), "{name}: {c}");
            assert_eq!(c["status"] == "made", c["evidence"].is_string(), "{name}: {c}");
        }
    }
    assert_eq!(check(sample_once("warm-up-pass").result(), "plausible")["status"], "made");
}

#[test]
fn a_run_that_read_nothing_made_no_check() {
    let dir = tempdir().unwrap();
    std::fs::write(dir.path().join("empty.csv"), "").unwrap();
    let p = altered(dir.path(), "p.toml", &procedure(), &[]);
    let r = run(dir.path(), &p, "empty.csv", &["--serial", "S"]);
    assert_eq!(r["verdict"], "error");
    let all = r["checks"].as_array().unwrap();
    assert!(all.len() > 5 && all.iter().all(|c| c["status"] == "not_made"), "{all:#?}");
}
