//! Every verb from the command line: exit codes, verdicts, files, messages.

mod diagnostics;
mod options;
mod report;
mod verbs;

use crate::support::quick::Quick;
use crate::support::shared::tested_once;
use crate::support::{altered, limits, measurand, names, procedure, result, sagnac, sample};
use std::path::Path;
use tempfile::tempdir;

const VERBS: [&str; 6] = ["run", "check", "inspect", "analyze", "schema", "selftest"];

/// One clear message on standard error that holds every fragment, exit code 2, nothing on standard output.
fn refused(folder: &Path, args: &[&str], fragments: &[&str]) {
    let said = sagnac(folder, args);
    assert_eq!(said.code, 2, "{args:?}: {said:?}");
    assert_eq!(said.out, "", "{args:?}");
    assert!(said.err.starts_with("error: "), "{args:?}: {}", said.err);
    assert_eq!(said.err.matches("error: ").count(), 1, "{args:?}: {}", said.err);
    for fragment in fragments {
        assert!(said.err.contains(fragment), "{args:?}: no `{fragment}` in\n{}", said.err);
    }
}

#[test]
fn help_of_every_verb_ends_with_an_example() {
    let dir = tempdir().unwrap();
    for verb in VERBS {
        let said = sagnac(dir.path(), &[verb, "--help"]);
        assert_eq!(said.code, 0);
        let title = if verb == "run" { "\nExamples:\n" } else { "\nExample:\n" };
        let (_, example) = said.out.split_once(title).expect(verb);
        assert!(example.trim_start().starts_with(&format!("sagnac {verb}")), "{example}");
        assert!(!example.contains("\n\n"), "the example ends the help of {verb}: {example}");
    }
    let all = sagnac(dir.path(), &["--help"]).out;
    assert!(VERBS.iter().filter(|v| **v != "schema").all(|v| all.contains(&format!("  {v} "))), "{all}");
    for hidden in ["prove", "approve", "man", "schema"] {
        assert!(!all.contains(&format!("\n  {hidden} ")), "{hidden} stands in\n{all}");
    }
    let headings = ["Look", "Test", "Understand", "Lots", "Sign", "Program", "Options"];
    let places = headings.map(|heading| all.find(&format!("\n{heading}:\n")));
    assert!(places.is_sorted() && places.iter().all(Option::is_some), "{all}");
    assert!(all.contains("Exit codes: 0 pass (or no limits), 1 fail, 2 could not run, 3 indeterminate."));
    let version = sagnac(dir.path(), &["--version"]).out;
    assert_eq!(version.trim(), format!("sagnac {}", env!("CARGO_PKG_VERSION")));
}

#[test]
fn samples_give_their_verdicts() {
    for (name, code, verdict) in [
        ("pass", 0, "pass"),
        ("fail", 1, "fail"),
        ("indeterminate", 3, "indeterminate"),
        ("faults", 3, "indeterminate"),
    ] {
        let run = tested_once(name);
        let said = &run.said;
        assert_eq!(said.code, code, "{name}: {said:?}");
        assert_eq!(run.result()["verdict"], verdict, "{name}");
        assert!(said.out.starts_with(&verdict.to_uppercase()), "{name}: {}", said.out);
        assert!(said.out.contains("\nReport: r/report.html\n"), "{name}: {}", said.out);
        assert_eq!(said.err, "", "no terminal, no progress");
        assert_eq!(
            names(&run.out),
            [
                "SHA256SUMS",
                "figures",
                "junit.xml",
                "limits.toml",
                "measurands.csv",
                "procedure.toml",
                "report.html",
                "report.md",
                "result.json",
                "sigma_tau.csv"
            ],
            "{name}"
        );
        crate::support::assert_no_nan(&run.out);
    }
}

#[test]
fn faults_of_the_sample_are_found_where_they_were_put() {
    let integrity = &tested_once("faults").result()["integrity"];
    // From examples/make_samples.rs: sample i stands in row i + 1, 90 rows fewer after the gap, one more after the
    // repeated row. The row whose stamp jumps back leaves a hole of one sample in the time base.
    let expected = [
        ("gap", 12_001, 90),
        ("duplicate_timestamp", 14_912, 1),
        ("backward_timestamp", 16_912, 1),
        ("non_finite", 19_912, 1),
        ("unparsable", 20_412, 1),
        ("outlier", 22_912, 1),
        ("outlier", 25_912, 1),
        ("outlier", 28_912, 1),
        ("stuck", 31_912, 40),
    ];
    for (kind, row, count) in expected {
        let found = integrity["faults"].as_array().unwrap();
        let here = found.iter().any(|f| f["kind"] == kind && f["row"] == row && f["count"] == count);
        assert!(here, "{kind} at row {row}: {found:#?}");
    }
    for (key, count) in [
        ("duplicate_timestamps", 1),
        ("backward_timestamps", 1),
        ("non_finite", 1),
        ("unparsable", 1),
        ("outliers", 3),
        ("stuck", 40),
        ("missing_samples", 91),
    ] {
        assert_eq!(integrity[key], count, "{key}");
    }
}

#[test]
fn a_missing_serial_is_an_error_and_the_report_is_written() {
    let dir = tempdir().unwrap();
    let quick = Quick::new("pass");
    let run = ["run", &quick.procedure, &quick.recording, "--limits", &quick.limits, "--out", "o"];
    for serial in [None, Some(""), Some("  ")] {
        let mut args = run.to_vec();
        args.extend(serial.map(|s| ["--serial", s]).into_iter().flatten());
        let said = sagnac(dir.path(), &args);
        assert_eq!(said.code, 2, "{serial:?}");
        assert!(format!("{}{}", said.out, said.err).contains("--serial"), "{said:?}");
        let result = result(&dir.path().join("o"));
        assert_eq!(result["verdict"], "error", "{serial:?}");
        assert_eq!(result["errors"][0]["id"], "error.serial_missing");
        let row = measurand(&result, "angle_random_walk");
        assert_eq!(row["verdict"], "pass", "rows are evaluated all the same");
    }
}

#[test]
fn the_serial_number_that_a_recording_states_is_used_and_said_to_be() {
    let dir = tempdir().unwrap();
    let said = sagnac(dir.path(), &["run", &procedure(), &sample("pass"), "--limits", &limits()]);
    assert_eq!(said.code, 0, "{said:?}");
    assert!(said.out.starts_with("PASS  Static bias and noise · SN-0001"), "{}", said.out);
    let words = said.out.split_whitespace().collect::<Vec<_>>().join(" ");
    let used = "The recording states `SN-0001`. No other serial number was given, so this one is used.";
    assert!(words.contains(&format!("remark: Serial number in the recording: {used}")), "{}", said.out);
    let folder = names(dir.path()).pop().unwrap();
    assert!(folder.starts_with("static-bias_SN-0001_"), "{folder}");
    let result = result(&dir.path().join(folder));
    assert_eq!(result["unit_under_test"]["serial"], "SN-0001");
    let conditions = result["conditions"].as_array().unwrap();
    let named = conditions.iter().find(|c| c["id"] == "unit_named").unwrap();
    assert_eq!((&named["status"], &named["note"]), (&"remark".into(), &used.into()));
}

#[test]
fn an_overdue_calibration_makes_the_test_indeterminate() {
    let dir = tempdir().unwrap();
    let name = "name = { en = \"thermal chamber\", ru = \"термокамера\" }\ncalibration_due = ";
    for (sample_name, changed) in [("pass", "2020-01-01"), ("fail", "2020-01-01")] {
        let overdue = altered(
            dir.path(),
            "p.toml",
            &procedure(),
            &[(&format!("{name}2030-12-31"), &format!("{name}{changed}"))],
        );
        let said = sagnac(
            dir.path(),
            &["run", &overdue, &sample(sample_name), "--limits", &limits(), "--serial", "SN-1", "--out", "o"],
        );
        assert_eq!(said.code, 3, "{said:?}");
        let result = result(&dir.path().join("o"));
        assert_eq!(result["verdict"], "indeterminate");
        assert_eq!(result["instruments"][0]["status"], "invalid");
        // The others are in date, but nobody can tell which instruments they are.
        assert_eq!(result["instruments"][1]["status"], "remark");
        let conditions = result["conditions"].as_array().unwrap();
        let invalid: Vec<_> = conditions.iter().filter(|c| c["status"] == "invalid").collect();
        assert_eq!(invalid.len(), 1, "{invalid:?}");
        assert!(invalid[0]["note"].as_str().unwrap().contains("2020-01-01"), "{invalid:?}");
    }
}

#[test]
fn limits_on_the_command_line_replace_those_of_the_procedure() {
    let dir = tempdir().unwrap();
    let own = "[[limit]]\nmeasurand = \"angle_random_walk\"\nmax = \"0.0001 deg/sqrt(h)\"\n\n\
               [[limit]]\nmeasurand = \"russian_sigma_10s\"\nmax = \"1 deg/h\"\n\n[report]\n";
    let p = altered(dir.path(), "p.toml", &procedure(), &[("[report]\n", own)]);
    let base = ["run", &p, &sample("pass"), "--serial", "SN-1", "--out", "o"];
    assert_eq!(sagnac(dir.path(), &base).code, 1);
    let alone = result(&dir.path().join("o"));
    assert_eq!(measurand(&alone, "angle_random_walk")["verdict"], "fail");
    assert_eq!(measurand(&alone, "static_bias")["verdict"], "none");

    let said = sagnac(dir.path(), &[&base[..], &["--limits", &limits()]].concat());
    assert_eq!(said.code, 0, "{said:?}");
    let both = result(&dir.path().join("o"));
    let row = measurand(&both, "angle_random_walk");
    assert_eq!((&row["verdict"], &row["limit"]["max"]), (&"pass".into(), &0.0026.into()));
    assert_eq!(row["limit"]["source"].as_str().unwrap(), limits());
    let kept = measurand(&both, "russian_sigma_10s");
    assert_eq!(kept["limit"]["source"].as_str().unwrap(), p, "a limit that is not replaced stays");
    assert_eq!(kept["verdict"], "pass");
}

#[test]
fn the_default_folder_is_named_after_what_and_when() {
    let dir = tempdir().unwrap();
    let said = sagnac(dir.path(), &["run", &procedure(), &sample("pass"), "--serial", "SN/0001"]);
    assert_eq!(said.code, 0, "{said:?}");
    let said = sagnac(dir.path(), &["analyze", &sample("pass")]);
    assert_eq!(said.code, 0, "{said:?}");
    let found = names(dir.path());
    assert_eq!(found.len(), 2, "{found:?}");
    for (name, stem) in found.iter().zip(["analysis_unit-pass_", "static-bias_SN_0001_"]) {
        let stamp = name.strip_prefix(stem).unwrap_or_else(|| panic!("{name}"));
        let shape: String = stamp.chars().map(|c| if c.is_ascii_digit() { '9' } else { c }).collect();
        assert_eq!(shape, "99999999T999999Z");
        assert!(dir.path().join(name).join("report.html").is_file());
    }
}

#[test]
fn wrong_usages_of_run_are_refused_in_one_message() {
    let dir = tempdir().unwrap();
    let (p, r) = (&*procedure(), &*sample("pass"));
    let wrong = altered(dir.path(), "l.toml", &limits(), &[("0.5 deg/h", "0.5 deg/s^2")]);
    let cases: &[(&[&str], &[&str])] = &[
        (&["run", "none.toml", r], &["none.toml", "cannot be read", "check the path"]),
        (&["run", p, "none.csv"], &["none.csv", "cannot be read", "check the path"]),
        (&["run", p, r, "--limits", "none.toml"], &["none.toml", "cannot be read"]),
        (&["run", p, r, "--limits", &wrong], &["l.toml:24:16", "deg/s^2", "deg/h"]),
        (&["run", p, r, "--limits", p], &["static-bias.toml"]),
        (&["run", p, r, "--templates", "none"], &["none"]),
        (&["run", p, r, "--taus", "octaves"], &["--taus", "`octaves`", "octave, decade, all"]),
        (&["run", p], &["<RECORDING>", "--help"]),
        (&["run", p, r, "--seriel", "x"], &["--seriel", "--serial"]),
        (&["analyse", r], &["analyse", "analyze"]),
        (&["schema", "report"], &["procedure, limits, layout, result, manifest"]),
        (&["check"], &["<FILES>"]),
    ];
    for (args, fragments) in cases {
        refused(dir.path(), args, fragments);
    }
    assert_eq!(names(dir.path()), ["l.toml"], "nothing is left behind");
    // A recording is no procedure: that is said at its first line, whatever else is wrong with it.
    let said = sagnac(dir.path(), &["run", r, r]);
    assert_eq!(said.code, 2);
    assert!(said.err.starts_with("error: this is not TOML"), "{}", said.err);
    assert!(said.err.contains("unit-pass.csv:2:7"), "{}", said.err);
    assert_eq!(said.err.matches("error: ").count(), 5, "not one for each of 36 180 lines: {}", said.err);
}

#[test]
fn the_pass_sample_has_this_report() {
    let dir = tempdir().unwrap();
    let out = dir.path().join("o").to_string_lossy().into_owned();
    let said = sagnac(
        crate::support::root(),
        &[
            "run",
            "procedures/static-bias.toml",
            "samples/unit-pass.csv",
            "--limits",
            "procedures/limits/sample-unit.toml",
            "--serial",
            "SN-0001",
            "--operator",
            "A. Ivanova",
            "--station",
            "ST-3",
            "--out",
            &out,
        ],
    );
    assert_eq!(said.code, 0, "{said:?}");
    let report = std::fs::read_to_string(dir.path().join("o/report.md")).unwrap();
    let text = crate::support::steady(&report, &result(&dir.path().join("o")));
    insta::assert_snapshot!("report_of_the_pass_sample", text);
}
