//! Rules: mistakes in them, and the serial number that they tell.

use super::{Bench, pairs};
use crate::support::quick::Quick;
use crate::support::{sagnac, sagnac_as_typed};
use serde_json::Value;
use std::fs;

#[test]
fn a_mistake_in_the_rules_is_one_diagnostic_with_its_place() {
    for (more, place) in [
        ("complete = \"soon\"\n", "watch.toml:7:13"),
        ("serial_column = \"sn\"\n", "watch.toml:7:17"),
        ("hook = \"to_mes\"\n", "watch.toml:7:8"),
        ("hok = [\"to_mes\"]\n", "watch.toml:7:1"),
        ("after = \"60\"\n", "watch.toml:7:10"),
    ] {
        let bench = Bench::new(more);
        let said = bench.once();
        let errors = said.err.matches("error").count();
        assert!(said.code == 2 && errors == 1 && said.err.contains(place), "{more}: {said:?}");
        assert!(!bench.at("out").exists());
    }
}

#[test]
fn the_schema_of_rules_has_every_key_with_its_description() {
    let dir = tempfile::tempdir().unwrap();
    let said = sagnac(dir.path(), &["schema", "watch"]);
    let schema: Value = serde_json::from_str(&said.out).unwrap();
    let keys = schema["properties"]["rule"]["items"]["properties"].as_object().unwrap();
    assert_eq!(keys.len(), 11);
    assert!(keys.values().all(|key| key["description"].as_str().is_some_and(|d| !d.is_empty())));
    assert_eq!(keys["after"]["default"], "60 s");
}

#[test]
fn the_example_of_the_guide_is_taken() {
    let page = fs::read_to_string(crate::support::root().join("docs/guide/watch.md")).unwrap();
    let blocks = page.split("```toml\n").skip(1).map(|rest| rest.split("```").next().unwrap());
    let example = blocks.into_iter().find(|block| block.contains("watch/1")).unwrap();
    let dir = tempfile::tempdir().unwrap();
    for name in ["unit-limits.toml", "temperature.toml"] {
        fs::write(dir.path().join(name), "").unwrap();
    }
    let rules = sagnac::config::watch::parse("watch.md", example.as_bytes(), dir.path());
    let rules = rules.unwrap_or_else(|problems| panic!("{problems}"));
    assert_eq!(rules.rules.len(), 2);
    assert_eq!(rules.rules[0].hook, ["python3", "to_mes.py"]);
}

#[test]
fn the_serial_number_is_from_the_name_the_header_or_a_column() {
    let text = fs::read_to_string(Quick::new("pass").recording).unwrap();
    let with_column = |serial: &str| {
        let rows = text.lines().skip(1).map(|row| format!("{row},{serial}\n")).collect::<String>();
        format!("time_s,rate_deg_h,unit_sn\n{rows}")
    };
    let bench = Bench::with_pattern("{serial}/*.csv", "");
    bench.write("SN-7/a.csv", &text);
    assert_eq!(bench.once().code, 0);
    assert_eq!(bench.verdicts(), pairs(&[("SN-7", "pass")]));

    let bench = Bench::with_pattern("*.csv", "");
    bench.write("a.csv", &format!("# serial: SN-8\n{text}"));
    bench.write("SN-9.csv", &text);
    assert_eq!(bench.once().code, 0);
    assert_eq!(bench.verdicts(), pairs(&[("SN-8", "pass"), ("SN-9", "pass")]));

    let bench = Bench::with_pattern("*.csv", "serial_column = \"unit_sn\"\n");
    bench.write("a.csv", &with_column("1234"));
    bench.write("b.csv", &with_column("SN-11"));
    bench.write("c.csv", &with_column("1.5"));
    bench.write("d.csv", &text);
    assert_eq!(bench.once().code, 0);
    assert_eq!(bench.verdicts(), pairs(&[("1234", "pass"), ("SN-11", "pass")]));
    let lacks = "watch.no_serial_column";
    assert_eq!(bench.untested(), pairs(&[("c.csv", lacks), ("d.csv", lacks)]));
}

#[test]
fn a_serial_number_is_no_path_and_no_option() {
    let text = fs::read_to_string(Quick::new("pass").recording).unwrap();
    let bench = Bench::with_pattern("*.csv", "");
    bench.write("a.csv", &format!("# serial: ../../../x\n{text}"));
    bench.write("--force.csv", &text.replacen("\n0,12.", "\n0,12.001", 1));
    assert_eq!(bench.once().code, 0);
    assert_eq!(bench.verdicts(), pairs(&[("--force", "pass"), ("../../../x", "pass")]));
    for (place, _) in bench.results() {
        let inside = place.canonicalize().unwrap();
        assert!(inside.starts_with(bench.at("out/results").canonicalize().unwrap()), "{}", place.display());
    }
    assert!(!bench.at("x").exists());
}

#[test]
fn a_folder_is_watched_by_one_procedure_without_rules() {
    let bench = Bench::new("");
    bench.put("SN-1.csv", "pass");
    let quick = &bench.quick;
    let args =
        ["watch", "in", "--procedure", &quick.procedure, "--limits", &quick.limits, "--out", "out", "--once"];
    let said = sagnac_as_typed(bench.folder(), &args, &[]);
    assert_eq!((said.code, bench.verdicts()), (0, pairs(&[("SN-1", "pass")])), "{said:?}");
    let said = sagnac_as_typed(bench.folder(), &["watch", "in"], &[]);
    assert!(said.code == 2 && said.err.contains("--procedure"), "{said:?}");
}
