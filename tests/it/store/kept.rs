//! Runs with a store.

use crate::store::{a_result, kept, store, with_store, write_result};
use crate::support::quick::Quick;
use crate::support::{Said, altered, limits, procedure, result, sagnac, sagnac_with, sample};
use serde_json::Value;
use std::path::Path;

fn run(folder: &Path, end: &str, out: &str, more: &[&str]) -> Said {
    Quick::new(end).run(folder, &[&["--out", out], more].concat())
}

#[test]
fn every_attempt_is_kept_and_the_next_one_tells_of_it() {
    let dir = with_store();
    let first = run(dir.path(), "fail", "a", &["--store", "store"]);
    assert_eq!(first.code, 1, "{first:?}");
    assert!(first.out.contains("Kept in store as "), "{}", first.out);
    assert!(!first.out.contains("Attempt"), "{}", first.out);
    let quick = Quick::new("pass");
    let changed = altered(dir.path(), "limits.toml", &quick.limits, &[("[limits]", "# anew\n[limits]")]);
    let second = Quick { limits: changed, ..quick }.run(dir.path(), &["--out", "b", "--store", "store"]);
    assert_eq!(second.code, 0, "{second:?}");
    for part in ["Attempt 2 at this test", "1: fail on", "Limits changed between attempts 1 and 2"] {
        assert!(second.out.contains(part), "{part}: {}", second.out);
        for page in ["b/report.html", "b/report.md"] {
            assert!(std::fs::read_to_string(dir.path().join(page)).unwrap().contains(part), "{page}: {part}");
        }
    }
    let attempt = &result(&dir.path().join("b"))["attempt"];
    assert_eq!(attempt["number"], 2);
    let earlier = &attempt["earlier"][0];
    let kept = kept(&dir.path().join("store"));
    assert!(kept.iter().any(|(address, _)| earlier["result"] == address.as_str()), "{earlier}");
    assert_eq!(earlier["verdict"], "fail");
    assert!(!earlier["reasons"].as_array().unwrap().is_empty());
    // What is kept is what was written.
    assert_eq!(kept.len(), 2);
    for (_, folder) in kept {
        let out = if result(&folder)["attempt"]["number"] == 2 { "b" } else { "a" };
        assert!(crate::support::files(&folder) == crate::support::files(&dir.path().join(out)), "{out}");
    }
    store(dir.path(), &["verify", "store"]);
}

#[test]
fn without_a_store_nothing_changes() {
    let dir = with_store();
    let plain = run(dir.path(), "pass", "a", &[]);
    assert!(!plain.out.contains("Kept"), "{}", plain.out);
    let record = result(&dir.path().join("a"));
    assert_eq!(record.get("attempt"), None);
    assert_eq!(record["unit_under_test"].as_object().unwrap().len(), 5, "{}", record["unit_under_test"]);
    assert!(kept(&dir.path().join("store")).is_empty());
}

#[test]
fn the_store_is_named_by_the_option_the_environment_or_the_settings() {
    let dir = with_store();
    let quick = Quick::new("pass");
    let run = |out: &str, more: &[&str], environment: &[(&str, &str)]| {
        sagnac_with(dir.path(), &[&quick.args()[..], &["--out", out], more].concat(), environment)
    };
    let count = || kept(&dir.path().join("store")).len();
    assert_eq!(run("a", &[], &[("SAGNAC_STORE", "store")]).code, 0);
    assert_eq!(count(), 1);
    let settings = dir.path().join("config/sagnac");
    std::fs::create_dir_all(&settings).unwrap();
    let path = dir.path().join("store").display().to_string();
    std::fs::write(settings.join("config.toml"), format!("[store]\npath = \"{path}\"\n")).unwrap();
    let home = dir.path().join("config").display().to_string();
    assert_eq!(run("b", &[], &[("XDG_CONFIG_HOME", &home)]).code, 0);
    assert_eq!(count(), 2);
    assert_eq!(run("c", &["--no-store"], &[("SAGNAC_STORE", "store")]).code, 0);
    assert_eq!(count(), 2);
    let said = run("d", &["--store", "elsewhere"], &[]);
    assert!(said.code == 2 && said.err.contains("sagnac store init"), "{said:?}");
    assert!(!dir.path().join("d").exists(), "a store that is none is said before the work");
}

#[test]
fn units_have_what_the_table_and_the_manifest_know_of_them() {
    let dir = with_store();
    let Quick { procedure, recording, limits } = Quick::new("pass");
    let demanding = altered(
        dir.path(),
        "procedure.toml",
        &procedure,
        &[("[unit_under_test]\n", "[unit_under_test]\nrequires = [\"lot\", \"build_date\"]\n")],
    );
    std::fs::write(dir.path().join("units.csv"), "serial,lot,build_date,coil\nSN-001,L7,2026-02-01,K12\n")
        .unwrap();
    std::fs::copy(recording, dir.path().join("unit.csv")).unwrap();
    let run = |recording: &str, out: &str, more: &[&str]| {
        let args = ["run", &demanding, recording, "--limits", &limits, "--out", out];
        sagnac(dir.path(), &[&args[..], more].concat())
    };
    let lacking = run("unit.csv", "a", &["--serial", "1"]);
    assert_eq!(lacking.code, 2, "{lacking:?}");
    let said = result(&dir.path().join("a"))["errors"][0]["text"].as_str().unwrap().to_owned();
    assert!(said.contains("Lot, Built on"), "{said}");
    let told = run("unit.csv", "b", &["--serial", "1", "--unit-data", "units.csv"]);
    assert_eq!(told.code, 0, "{told:?}");
    let unit: Value = result(&dir.path().join("b"))["unit_under_test"].clone();
    assert_eq!((&unit["lot"], &unit["build_date"]), (&"L7".into(), &"2026-02-01".into()));
    assert_eq!(unit["attributes"]["coil"], "K12");
    let manifest = "format = \"manifest/1\"\nserial = \"SN-1\"\nfiles = \"unit.csv\"\n[unit]\nlot = \"L8\"\n\
        [[unit.attribute]]\nname = \"coil\"\nvalue = \"K99\"\n";
    std::fs::write(dir.path().join("manifest.toml"), manifest).unwrap();
    let both = run("manifest.toml", "c", &["--unit-data", "units.csv"]);
    assert_eq!(both.code, 0, "{both:?}");
    let unit: Value = result(&dir.path().join("c"))["unit_under_test"].clone();
    assert_eq!((&unit["lot"], &unit["build_date"]), (&"L8".into(), &"2026-02-01".into()));
    assert_eq!(unit["attributes"]["coil"], "K99", "the manifest comes first");
}

#[test]
fn the_units_of_a_lot_are_kept_one_by_one() {
    let dir = with_store();
    for name in ["pass", "fail"] {
        let rows = std::fs::read_to_string(Quick::new(name).recording).unwrap();
        std::fs::write(dir.path().join(format!("u-{name}.csv")), format!("# serial: SN-7\n{rows}")).unwrap();
    }
    let procedure = Quick::new("pass").procedure;
    let args =
        ["run", &procedure, "u-*.csv", "--each", "--serial-from", "{stem}", "--store", "store", "--out"];
    for (out, number) in [("x", 1), ("y", 2)] {
        let said = sagnac(dir.path(), &[&args[..], &[out]].concat());
        // Each recording states another serial number than its name.
        assert_eq!(said.code, 3, "{said:?}");
        assert_eq!(said.out.matches("Kept in store").count(), 2, "{}", said.out);
        let unit = result(&dir.path().join(out).join("u-pass"));
        assert_eq!(unit["attempt"]["number"], number);
    }
    assert_eq!(kept(&dir.path().join("store")).len(), 4);
    store(dir.path(), &["verify", "store"]);
}

#[test]
fn a_correction_supersedes_and_both_stay() {
    let dir = with_store();
    for (name, at, value) in [("a", "2026-03-01T10:00:00Z", 1.2), ("b", "2026-03-01T11:00:00Z", 0.7)] {
        let mut result = a_result("SN-1", "L", at, value);
        result["procedure"]["id"] = "quick".into();
        write_result(dir.path(), name, &result);
        store(dir.path(), &["import", "store", name]);
    }
    let addresses = kept(&dir.path().join("store"));
    let failed = addresses.iter().find(|(_, f)| result(f)["verdict"] == "fail").unwrap();
    let passed = addresses.iter().find(|(_, f)| result(f)["verdict"] == "pass").unwrap();
    let by = |old: &str, new: &str| {
        crate::store::store_says(
            dir.path(),
            &["supersede", "store", old, "--by", new, "--reason", "wrong connector"],
        )
    };
    assert_eq!(by(&failed.0[..8], &passed.0[..8]).code, 0);
    let said = by(&passed.0, &failed.0);
    assert!(said.code == 2 && said.err.contains("counts in place"), "{said:?}");
    let said = by("zzzz", &passed.0);
    assert!(said.code == 2 && said.err.contains("begins with `zzzz`"), "{said:?}");
    assert_eq!(kept(&dir.path().join("store")).len(), 2);
    store(dir.path(), &["verify", "store"]);
    let next = run(dir.path(), "pass", "c", &["--store", "store"]);
    assert!(next.out.contains("1: superseded; 2: pass"), "{}", next.out);
}

/// A unit of the lot whose coefficient of random walk is `factor` of one that was measured, more or less by its number.
fn a_sibling(number: usize, measured: &Value, factor: f64) -> Value {
    let mut result = a_result(&format!("SN-2{number:03}"), "L7", "2026-03-01T10:00:00Z", 0.5);
    let scatter = (0.05 * ((number * 7) % 11) as f64 - 0.25).exp();
    let value = measured.as_f64().unwrap() * factor * scatter;
    let id = "angle_random_walk";
    let more = serde_json::json!({"id": id, "channel": "rate", "unit": "deg/sqrt(h)", "value": value,
        "interval": {"low": 0.9 * value, "high": 1.1 * value, "coverage": 0.95}, "verdict": "none"});
    result["measurands"].as_array_mut().unwrap().push(more);
    result
}

#[test]
fn a_unit_that_passes_and_is_unlike_its_lot_is_named() {
    let dir = with_store();
    std::fs::copy(sample("pass"), dir.path().join("unit.csv")).unwrap();
    std::fs::write(dir.path().join("units.csv"), "serial,model,lot\nSN-1,A-1,L7\n").unwrap();
    let tested = |out: &str, store: &str| {
        let (procedure, limits) = (procedure(), limits());
        let args = ["run", &procedure, "unit.csv", "--limits", &limits, "--serial", "SN-1"];
        let more = ["--unit-data", "units.csv", "--store", store, "--out", out];
        let said = sagnac(dir.path(), &[&args[..], &more[..]].concat());
        assert_eq!(said.code, 0, "{said:?}");
        (said, result(&dir.path().join(out)))
    };
    let (alone, record) = tested("alone", "store");
    assert!(record.get("siblings").is_none(), "{}", record["siblings"]);
    assert!(!alone.out.contains("Unlike"), "{}", alone.out);
    let measured = record["measurands"].as_array().unwrap().iter();
    let measured = measured.clone().find(|m| m["id"] == "angle_random_walk").unwrap()["value"].clone();
    for (store_name, factor) in [("like", 1.0), ("unlike", 0.2)] {
        store(dir.path(), &["init", store_name]);
        for i in 0..20 {
            write_result(dir.path(), &format!("{store_name}-{i}"), &a_sibling(i, &measured, factor));
        }
        let folders: Vec<String> = (0..20).map(|i| format!("{store_name}-{i}")).collect();
        let mut args = vec!["import", store_name];
        args.extend(folders.iter().map(String::as_str));
        store(dir.path(), &args);
    }
    let (like, record) = tested("as-they", "like");
    assert_eq!((&record["siblings"]["units"], &record["siblings"]["unlike"]), (&20.into(), &false.into()));
    assert!(!like.out.contains("Unlike"), "{}", like.out);
    let (other, record) = tested("other", "unlike");
    assert_eq!(record["siblings"]["unlike"], true, "{}", record["siblings"]);
    assert_eq!(record["siblings"]["quantities"][0]["id"], "angle_random_walk");
    assert_eq!(record["verdict"], "pass");
    for part in ["Unlike the other units of lot L7", "standard deviations of the others"] {
        assert!(other.out.split_whitespace().collect::<Vec<_>>().join(" ").contains(part), "{}", other.out);
        for page in ["other/report.html", "other/report.md"] {
            assert!(std::fs::read_to_string(dir.path().join(page)).unwrap().contains(part), "{page}: {part}");
        }
    }
}
