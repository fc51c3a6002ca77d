//! The verbs beside `run`: analyze, check, schema, selftest.

use crate::support::shared::{SharedRun, shared};
use crate::support::{altered, limits, measurand, names, procedure, sagnac, sample};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;
use tempfile::tempdir;

/// The averaging times of an estimator in the `sigma_tau.csv` of a result.
fn taus(run: &SharedRun, estimator: &str) -> Vec<String> {
    let text = run.text("sigma_tau.csv");
    let rows = text.lines().filter_map(|l| l.strip_prefix(&format!("{estimator},")));
    rows.map(|l| l.split(',').next().unwrap().to_owned()).collect()
}

/// A sample analysed with options.
fn analyze(name: &str, options: &[&str]) -> &'static SharedRun {
    let run = shared(&[&["analyze", &sample(name)], options].concat(), "a");
    assert_eq!(run.said.code, 0, "{options:?}: {:?}", run.said);
    assert!(run.said.out.starts_with("NO LIMITS"), "{}", run.said.out);
    crate::support::assert_no_nan(&run.out);
    run
}

fn refused(folder: &Path, options: &[&str], fragments: &[&str]) {
    let recording = sample("pass");
    let args = [&["analyze", &*recording], options].concat();
    let said = sagnac(folder, &args);
    assert_eq!(said.code, 2, "{args:?}: {said:?}");
    assert_eq!(said.err.matches("error: ").count(), 1, "{args:?}: {}", said.err);
    for fragment in fragments {
        assert!(said.err.contains(fragment), "{args:?}: no `{fragment}` in\n{}", said.err);
    }
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value}"))
}

#[test]
fn analyze_goes_by_the_names_of_the_columns() {
    let found = analyze("pass", &[]).result();
    assert_eq!(found["verdict"], "none");
    assert!(found["procedure"].is_null());
    // The sample was made with N = 0.002 and B = 0.003.
    let n = measurand(found, "angle_random_walk");
    assert!((number(&n["value"]) / 0.002 - 1.0).abs() < 0.02, "{n}");
    let b = &measurand(found, "bias_instability")["interval"];
    assert!(number(&b["low"]) < 0.003 && 0.003 < number(&b["high"]), "{b}");
    let roles: Vec<&str> = found["recording"][0]["columns"]
        .as_array()
        .unwrap()
        .iter()
        .map(|c| c["role"].as_str().unwrap())
        .collect();
    assert_eq!(roles, ["time", "rate", "temperature"]);
}

#[test]
fn analyze_takes_columns_by_name_and_by_position() {
    let by_name = analyze("pass", &["--rate", "rate_deg_h"]).result();
    let by_position = analyze("pass", &["--rate", "2", "--time", "1"]).result();
    assert_eq!(by_name["measurands"], by_position["measurands"]);
}

#[test]
fn a_unit_scales_every_angle() {
    let own = analyze("pass", &[]).result();
    let scaled = analyze("pass", &["--rate", "rate_deg_h", "--unit", "deg/s"]).result();
    for id in ["static_bias", "angle_random_walk", "bias_instability", "russian_drift_100s"] {
        let ratio = number(&measurand(scaled, id)["value"]) / number(&measurand(own, id)["value"]);
        assert!((ratio / 3600.0 - 1.0).abs() < 1e-3, "{id}: {ratio}");
    }
}

#[test]
fn without_stamps_the_sample_rate_is_the_time_base() {
    let dir = tempdir().unwrap();
    let own = analyze("pass", &[]).result();
    let same = analyze("pass", &["--time", "none", "--sample-rate", "0.1"]).result();
    assert_eq!(own["measurands"], same["measurands"]);
    let run = analyze("pass", &["--time", "none", "--sample-rate", "10"]);
    let faster = run.result();
    assert_eq!(number(&faster["recording"][0]["sample_interval_s"]), 0.1);
    assert_eq!(taus(run, "oadev")[..3], ["0.1", "0.2", "0.4"]);
    // White noise: σ(τ) = N/√τ, so the same σ at a tenth of a tenth of the interval is a tenth of N.
    let n = |r: &Value| number(&measurand(r, "angle_random_walk")["value"]);
    assert!((n(faster) / n(own) - 0.1).abs() < 1e-3);
    refused(dir.path(), &["--time", "none"], &["no time column", "--sample-rate HZ"]);
}

#[test]
fn averaging_times_are_those_asked_for() {
    let listed = analyze("pass", &["--taus", "10,100,3000"]);
    for estimator in ["oadev", "mdev", "hdev", "totdev"] {
        assert_eq!(taus(listed, estimator), ["10", "100", "3000"], "{estimator}");
    }
    let exact = analyze("pass", &["--taus", "10,100,3000", "--exact"]);
    let table = "sigma_tau.csv";
    assert_eq!(listed.text(table), exact.text(table), "short records are always exact");
    let decade = analyze("pass", &["--taus", "decade"]);
    assert_eq!(taus(decade, "oadev")[..8], ["10", "20", "30", "40", "50", "60", "80", "100"]);
    let octave = analyze("pass", &["--taus", "octave"]);
    assert_eq!(taus(octave, "oadev")[..5], ["10", "20", "40", "80", "160"]);
}

#[test]
fn wrong_usages_of_analyze_are_refused_in_one_message() {
    let dir = tempdir().unwrap();
    let cases: &[(&[&str], &[&str])] = &[
        (&["--rate", "rate_deg"], &["no column `rate_deg`", "did you mean `rate_deg_h`?"]),
        (&["--rate", "gyro"], &["no column `gyro`", "time_s, rate_deg_h, temp_degC"]),
        (&["--rate", "4"], &["no column 4", "columns 1 to 3"]),
        (&["--rate", "0"], &["no column 0", "columns 1 to 3"]),
        (&["--rate", "rate_deg_h", "--rate", "2"], &["`rate_deg_h`", "twice"]),
        (&["--time", "zeit"], &["no column `zeit`"]),
        (&["--unit", "furlong"], &["--unit", "`furlong` is not a unit"]),
        (&["--rate", "rate_deg_h", "--unit", "degC"], &["`degC` measures a temperature", "angular rate"]),
        (&["--rate", "temp_degC"], &["`temp_degC`", "--unit"]),
        (&["--taus", "15"], &["15 s is not a multiple of the sample interval 10 s", "10 s and 20 s"]),
        (&["--taus", "10,x"], &["--taus", "`x`"]),
        (&["--taus", "0"], &["0"]),
        (&["--time", "none", "--sample-rate", "0"], &["sample rate 0", "positive"]),
        (&["--time", "none", "--sample-rate", "NaN"], &["sample rate NaN", "positive"]),
        (&["--warm-up", "NaN"], &["--warm-up", "NaN"]),
        (&["--warm-up=-5"], &["--warm-up", "-5"]),
        (&["--warm-up", "1e9"], &["nothing is left after the warm-up of"]),
    ];
    for (options, fragments) in cases {
        refused(dir.path(), &[options, &["--out", "o"][..]].concat(), fragments);
    }
}

#[test]
fn check_finds_the_shipped_files_sound() {
    let dir = tempdir().unwrap();
    let mut files = vec![procedure()];
    for entry in std::fs::read_dir(crate::support::root().join("procedures/limits")).unwrap() {
        files.push(entry.unwrap().path().to_string_lossy().into_owned());
    }
    assert!(files.len() >= 7, "{files:?}");
    for file in &files {
        let said = sagnac(dir.path(), &["check", file]);
        assert_eq!((said.code, said.err.as_str()), (0, ""), "{file}");
        // What a user has to fill in is named: the instruments of a place have serial numbers there.
        let mut lines = said.out.lines();
        let first = lines.next().unwrap();
        let named = first.contains("; valid; instruments without a serial number: ");
        assert!(named || first.ends_with("; valid"), "{}", said.out);
        assert!(lines.all(|line| line.contains(" h of recording")), "{}", said.out);
    }
    let all: Vec<&str> = std::iter::once("check").chain(files.iter().map(String::as_str)).collect();
    assert_eq!(sagnac(dir.path(), &all).code, 0);
    assert!(names(dir.path()).is_empty(), "check writes nothing");
}

#[test]
fn check_says_what_a_short_record_cannot_show() {
    let dir = tempdir().unwrap();
    let own = "minimum_duration = \"10 h\"\nplanned_duration = \"100 h\"";
    let cases = [
        ("minimum_duration = \"1 h\"", true),
        ("minimum_duration = \"50 min\"\nplanned_duration = \"1 h\"", true),
        ("minimum_duration = \"1 h\"\nplanned_duration = \"100 h\"", false),
        ("minimum_duration = \"100 h\"", false),
    ];
    for (duration, warned) in cases {
        let p = altered(dir.path(), "p.toml", &procedure(), &[(own, duration)]);
        let said = sagnac(dir.path(), &["check", &p, &limits()]);
        assert_eq!(said.code, 0, "a warning is no error: {said:?}");
        let about = said.out.contains("1 h cannot decide bias_instability <= 0.005 deg/h");
        assert_eq!(about, warned, "{}", said.out);
        assert_eq!(said.out.contains("sample-unit.toml:30:1"), warned, "{}", said.out);
        let length = said.out.contains("0.005 deg/h is decided by 9.8 h of recording");
        assert_eq!(length, !warned, "a warning says how long it would take: {}", said.out);
    }
}

#[test]
fn check_reports_all_problems_of_a_procedure() {
    let dir = tempdir().unwrap();
    altered(
        dir.path(),
        "broken.toml",
        &procedure(),
        &[
            ("unit = \"deg/h\"", "unit = \"degC\""),
            ("nominal = \"20 degC\"", "nominal = \"20 deg\""),
            ("gaps = 10", "gapz = 10"),
            ("id = \"rate_ramp\"", "id = \"rate_rmap\""),
        ],
    );
    let said = sagnac(dir.path(), &["check", "broken.toml"]);
    assert_eq!(said.code, 2);
    insta::assert_snapshot!("check_of_a_broken_procedure", said.out);
}

#[test]
fn check_goes_on_after_a_file_that_is_missing() {
    let dir = tempdir().unwrap();
    let said = sagnac(dir.path(), &["check", "none.toml", &procedure()]);
    assert_eq!(said.code, 2);
    assert!(said.out.contains("--> none.toml") && said.out.contains("check the path"), "{}", said.out);
    assert!(said.out.contains("static-bias.toml: procedure `static-bias`"), "{}", said.out);
}

#[test]
fn schemas_are_json_and_name_their_keys() {
    let dir = tempdir().unwrap();
    for (kind, keys) in [
        ("procedure", &["procedure", "channel", "conditions", "measurand", "limit", "report", "phase"][..]),
        ("limits", &["limits", "limit", "expected"]),
        ("result", &["verdict", "measurands", "integrity", "conditions", "recording"]),
    ] {
        let said = sagnac(dir.path(), &["schema", kind]);
        assert_eq!((said.code, said.err.as_str()), (0, ""));
        let schema: Value = serde_json::from_str(&said.out).unwrap();
        assert!(schema["$schema"].as_str().unwrap().contains("json-schema.org"), "{kind}");
        let forms = schema["oneOf"].as_array().cloned().unwrap_or_else(|| vec![schema]);
        let properties: BTreeSet<&String> =
            forms.iter().flat_map(|f| f["properties"].as_object().unwrap().keys()).collect();
        for key in keys {
            assert!(properties.iter().any(|p| p == key), "{kind}: no `{key}` in {properties:?}");
        }
    }
}

#[test]
fn selftest_passes_and_names_its_sources() {
    let dir = tempdir().unwrap();
    let said = sagnac(dir.path(), &["selftest"]);
    assert_eq!((said.code, said.err.as_str()), (0, ""), "{}", said.out);
    assert!(said.out.trim_end().ends_with(", 0 differ"), "{}", said.out);
    for source in ["NIST SP 1065", "IEEE Std 952"] {
        assert!(said.out.contains(source), "{source}");
    }
    // NIST SP 1065, 1000 points: overlapping Allan deviation at m = 10.
    assert!(said.out.contains("0.09159953"), "{}", said.out);
    assert!(names(dir.path()).is_empty(), "nothing is written");
}
