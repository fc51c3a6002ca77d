//! A test rehearsed on simulated units: shares of verdicts, risks, the row that costs the hours, and what cannot be rehearsed.

use crate::support::{Said, sagnac, sagnac_with, shipped};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// A test of an hour whose limits decide quickly: N and the bias.
const PROCEDURE: &str = r#"format = "procedure/1"
[procedure]
id = "short-rest"
title = "Short rest"
revision = "A"
[[channel]]
id = "time"
column = "t"
role = "time"
unit = "s"
[[channel]]
id = "x"
column = "gyro"
role = "rate"
unit = "deg/s"
[[channel]]
id = "temp"
column = "housing"
role = "temperature"
unit = "degC"
[conditions]
minimum_duration = "40 min"
warm_up = "5 min"
[conditions.temperature]
channel = "temp"
nominal = "20 degC"
tolerance = "0.4 degC"
sensor_uncertainty = "0.05 degC"
[[measurand]]
id = "static_bias"
options.earth_rate = "keep"
[[measurand]]
id = "angle_random_walk"
[[limit]]
measurand = "static_bias"
max_abs = "0.5 deg/h"
[[limit]]
measurand = "angle_random_walk"
max = "0.01 deg/sqrt(h)"
"#;

fn rehearsed(folder: &Path, more: &[&str]) -> Said {
    fs::write(folder.join("p.toml"), PROCEDURE).unwrap();
    sagnac(folder, &[&["rehearse", "p.toml", "--units", "6"], more].concat())
}

fn record(said: &Said) -> Value {
    serde_json::from_str(&said.out).unwrap_or_else(|e| panic!("{e}: {}", said.err))
}

#[test]
fn good_units_pass_bad_ones_fail_and_those_at_a_limit_hardly_ever_pass() {
    let folder = tempfile::tempdir().unwrap();
    let output = rehearsed(folder.path(), &["--format", "json", "--length", "40min"]);
    assert_eq!(output.code, 0, "{}", output.err);
    let record = record(&output);
    assert_eq!(record["format"], "rehearsal/1");
    let length = &record["lengths"][0];
    assert_eq!(length["nominal"]["pass"], 6, "{length:#}");
    for level in length["levels"].as_array().unwrap() {
        let passes = level["whole"]["pass"].as_u64().unwrap();
        match level["factor"].as_f64().unwrap() {
            f if f < 1.0 => assert_eq!(passes, 6, "{level:#}"),
            // At its limit a unit passes in 5 % of tests: two of six have a chance of 3 %.
            1.0 => assert!(passes <= 2, "{level:#}"),
            _ => assert_eq!(level["row"]["fail"], 6, "{level:#}"),
        }
    }
    assert_eq!(length["levels"].as_array().unwrap().len(), 6);
    // Half of its limit where no typical value is stated.
    assert_eq!(record["nominal"][0]["value"], 0.005);
    assert_eq!(record["nominal"][0]["from"], "limit");
    assert!(record["needed"][0]["needed_h"].as_f64().unwrap() < 0.7);
    assert!((record["shortest_h"].as_f64().unwrap() - 2.0 / 3.0).abs() < 1e-9);
}

#[test]
fn equal_seeds_give_equal_rehearsals_and_others_other_units() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("p.toml"), PROCEDURE).unwrap();
    let with = |seed: &str, threads: &str| {
        let arguments = ["rehearse", "p.toml", "--units", "2", "--format", "json", "--seed", seed];
        let mut record = record(&sagnac_with(folder.path(), &arguments, &[("RAYON_NUM_THREADS", threads)]));
        record["made_at"].take();
        record
    };
    let one = with("1", "1");
    assert_eq!(one, with("1", "2"));
    let other = with("2", "2");
    assert_eq!(other["seed"], 2);
}

#[test]
fn a_page_is_written_in_both_languages() {
    let folder = tempfile::tempdir().unwrap();
    for (lang, heading) in [("en", "Rehearsal of a test"), ("ru", "Репетиция испытания")] {
        let out = folder.path().join(lang);
        let place = out.display().to_string();
        let output = rehearsed(folder.path(), &["--out", &place, "--lang", lang]);
        assert_eq!(output.code, 0, "{}", output.err);
        for page in ["report.html", "report.md"] {
            let page = fs::read_to_string(out.join(page)).unwrap();
            assert!(page.contains(heading), "{lang}");
        }
        assert!(out.join("rehearsal.json").is_file());
    }
}

#[test]
fn what_cannot_be_rehearsed_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("p.toml"), PROCEDURE).unwrap();
    let refused = |arguments: &[&str], reason: &str| {
        let said = sagnac(folder.path(), &[&["rehearse"], arguments].concat());
        assert_eq!(said.code, 2, "{arguments:?}");
        assert!(said.err.contains(reason), "{arguments:?}: {}", said.err);
    };
    refused(&[&shipped("procedures/scale-factor.toml")], "no test at rest");
    refused(&["p.toml", "--length", "10min"], "below the minimum duration");
    refused(&["p.toml", "--risk", "1.5"], "between 0 and 1");
    refused(&["p.toml", "--sample-rate", "1e6"], "samples");
    refused(&["p.toml", "--units", "0"], "--units");
}
