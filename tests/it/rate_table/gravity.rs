//! Positions in the field of gravity: the samples, the shipped procedure on them, and what positions do not tell.

use crate::support::pairs::sample_once;
use crate::support::{altered, result, sagnac, shipped};
use sagnac_studies::bench::gravity::{FOURTEEN, Gravity};
use serde_json::Value;
use tempfile::tempdir;

/// Coefficients of the unit that passes and of the one that fails, along I, O and S, then II, OO, IO, IS, OS.
const PASS: ([f64; 3], [f64; 5]) = ([0.05, -0.03, 0.02], [0.01, 0.0, -0.01, 0.02, 0.0]);
const FAIL: ([f64; 3], [f64; 5]) = ([0.05, -0.4, 0.02], [0.01, 0.0, 0.3, 0.02, 0.0]);

/// Samples with what stands in them.
pub fn files() -> [(&'static str, String); 2] {
    [("samples/acceleration-pass.csv", csv(PASS, 61)), ("samples/acceleration-fail.csv", csv(FAIL, 63))]
}

fn csv((linear, quadratic): ([f64; 3], [f64; 5]), seed: u64) -> String {
    let unit = Gravity { linear, quadratic, ..Gravity::default() };
    let mut out = String::from("time_s,rate_deg_h\n");
    for (i, rate) in unit.record(&FOURTEEN, seed).iter().enumerate() {
        out.push_str(&format!("{i},{rate:.4}\n"));
    }
    out
}

const IDS: [&str; 8] = [
    "g_sensitivity_i",
    "g_sensitivity_o",
    "g_sensitivity_s",
    "g2_sensitivity_ii",
    "g2_sensitivity_oo",
    "g2_sensitivity_io",
    "g2_sensitivity_is",
    "g2_sensitivity_os",
];

fn row<'a>(result: &'a Value, id: &str) -> &'a Value {
    result["measurands"].as_array().unwrap().iter().find(|r| r["id"] == id).unwrap_or_else(|| panic!("{id}"))
}

fn holds(row: &Value, truth: f64) {
    let end = |name: &str| row["interval"][name].as_f64().unwrap_or_else(|| panic!("{row}"));
    // Of the few intervals here none may miss by half its width.
    let half = 0.25 * (end("high") - end("low"));
    assert!((end("low") - half..=end("high") + half).contains(&truth), "{truth}: {row}");
}

#[test]
fn every_term_comes_back_from_the_shipped_schedule() {
    for (name, (linear, quadratic)) in [("acceleration-pass", PASS), ("acceleration-fail", FAIL)] {
        let r = sample_once(name).result();
        for (id, truth) in IDS.iter().zip(linear.iter().chain(&quadratic)) {
            holds(row(r, id), *truth);
        }
    }
    let failed = sample_once("acceleration-fail").result();
    let verdict = |id: &str| row(failed, id)["verdict"].as_str().unwrap().to_owned();
    assert_eq!((verdict("g_sensitivity_o"), verdict("g2_sensitivity_io")), ("fail".into(), "fail".into()));
    assert_eq!(verdict("g_sensitivity_s"), "pass");
}

#[test]
fn check_tells_the_rank_before_anything_is_recorded() {
    let dir = tempdir().unwrap();
    let shipped = shipped("procedures/acceleration.toml");
    let said = sagnac(dir.path(), &["check", &shipped, "--lang", "en"]);
    let text = format!("{said:?}");
    assert!(text.contains("14 positions determine 9 of 9 terms"), "{text}");
    // 0.467·0.002.
    assert!(text.contains("I 0.00093"), "{text}");
    altered(
        dir.path(),
        "p.toml",
        &shipped,
        &[
            ("elevation = \"45 deg\"", "elevation = \"90 deg\""),
            ("elevation = \"-45 deg\"", "elevation = \"-90 deg\""),
        ],
    );
    let said = sagnac(dir.path(), &["check", "p.toml", "--lang", "en"]);
    let text = format!("{said:?}");
    assert!(text.contains("not determined: IO, IS"), "{text}");
}

#[test]
fn terms_that_the_positions_do_not_tell_decide_nothing() {
    let dir = tempdir().unwrap();
    let shipped_procedure = shipped("procedures/acceleration.toml");
    // The stretches of the tilts lie beyond the end of the recording.
    let text = std::fs::read_to_string(&shipped_procedure).unwrap();
    let without: String = text
        .split_inclusive("\n\n")
        .filter(|part| !(part.contains("[[acceleration_test.position]]") && part.contains("45 deg")))
        .collect();
    std::fs::write(dir.path().join("p.toml"), without).unwrap();
    let sample = shipped("samples/acceleration-pass.csv");
    let said = sagnac(dir.path(), &["run", "p.toml", &sample, "--serial", "SN-1", "--out", "o"]);
    assert_eq!(said.code, 3, "{said:?}");
    let r = result(&dir.path().join("o"));
    let open = row(&r, "g2_sensitivity_io");
    assert!(open["value"].is_null() && open["verdict"] == "indeterminate", "{open}");
    assert!(open["notes"].to_string().contains("acceleration.not_determined"), "{open}");
}

#[test]
fn tests_that_make_no_sense_are_refused_with_the_place() {
    let dir = tempdir().unwrap();
    let shipped = shipped("procedures/acceleration.toml");
    let first = "[[acceleration_test.position]]\nfrom = \"10 s\"\nto = \"300 s\"\n";
    let backwards = first.replace("300 s", "5 s");
    for (from, to, expected) in [
        ("[site]", "[expected_site]", "needs [site]"),
        (first, &*backwards, "`to` must be later than `from`"),
        (first, "[[acceleration_test.position]]\n", "neither a phase nor a time"),
        ("elevation = \"90 deg\"\nroll", "elevation = \"91 deg\"\nroll", "90 deg"),
        ("order = \"quadratic\"", "order = \"cubic\"", "quadratic"),
        ("id = \"g_sensitivity_i\"", "id = \"static_bias\"", "static_bias"),
    ] {
        altered(dir.path(), "p.toml", &shipped, &[(from, to)]);
        let said = sagnac(dir.path(), &["check", "p.toml", "--lang", "en"]);
        assert_eq!(said.code, 2, "{from}: {said:?}");
        let text = format!("{}{}", said.out, said.err);
        assert!(text.contains(expected) && text.contains("p.toml:"), "{expected}: {text}");
    }
}
