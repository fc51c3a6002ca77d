//! `[[derived]]`: quantities by a formula, their checks without data, their rows and their limits.

use crate::support::synthetic::white;
use crate::support::{measurand, result, sagnac};
use std::fmt::Write;
use std::path::Path;
use tempfile::tempdir;

const HEAD: &str = "format = \"procedure/1\"\n[procedure]\nid = \"own\"\ntitle = \"Own\"\nrevision = \"A\"\n\
    [unit_under_test]\nserial_required = false\n\
    [[channel]]\nid = \"time\"\ncolumn = \"time_s\"\nrole = \"time\"\nunit = \"s\"\n\
    [[channel]]\nid = \"x\"\ncolumn = \"x\"\nrole = \"rate\"\nunit = \"deg/h\"\n\
    [[channel]]\nid = \"y\"\ncolumn = \"y\"\nrole = \"rate\"\nunit = \"deg/h\"\n\
    [conditions]\nminimum_duration = \"10 min\"\n\
    [[measurand]]\nid = \"angle_random_walk\"\n[[measurand]]\nid = \"rate_random_walk\"\n\
    [[measurand]]\nid = \"static_bias\"\noptions = { earth_rate = \"keep\" }\n[report]\nfigures = [\"rate\"]\n";

/// One formula as a table.
fn derived(id: &str, unit: &str, value: &str) -> String {
    format!("[[derived]]\nid = \"{id}\"\nunit = \"{unit}\"\nvalue = \"{value}\"\n")
}

fn procedure(folder: &Path, formulas: &str) {
    std::fs::write(folder.join("own.toml"), format!("{HEAD}{formulas}")).unwrap();
}

/// White noise of 0.1 and of 0.3 deg/h at 1 Hz about 12.5 and −40 deg/h.
fn recording(folder: &Path) {
    let mut text = String::from("time_s,x,y\n");
    for i in 0..4000 {
        let _ = writeln!(text, "{i},{:.5},{:.5}", 12.5 + 0.1 * white(1, i), -40.0 + 0.3 * white(2, i));
    }
    std::fs::write(folder.join("r.csv"), text).unwrap();
}

#[test]
fn a_formula_is_checked_without_data() {
    let dir = tempdir().unwrap();
    let at = dir.path();
    for (formula, why, place) in [
        (
            derived("a", "deg/h", "static_bias + angle_random_walk"),
            "an angle random walk",
            "angle_random_walk\"",
        ),
        (derived("a", "deg/sqrt(h)", "static_bias"), "an angle random walk", "static_bias\""),
        (derived("a", "deg/h", "static_bias +"), "ends where a value is needed", "+\""),
        (derived("a", "deg/h", "static_bais"), "static_bias", "static_bais"),
        (
            derived("a", "deg/h", "bias_instability"),
            "does not determine `bias_instability`",
            "bias_instability\"",
        ),
        (derived("a", "deg/h", "static_bias@z"), "no gyro channel is named `z`", "static_bias@z"),
        (derived("a", "deg/h", "root(static_bias)"), "no function `root`", "root("),
        (
            derived("static_bias", "deg/h", "2 * static_bias"),
            "a formula cannot replace it",
            "static_bias\"\nunit",
        ),
        (derived("a", "deg/h", "static_bias").repeat(2), "a second formula", ""),
        (
            derived("a", "deg/h", "b") + &derived("b", "deg/h", "static_bias"),
            "nor an earlier formula",
            "b\"\n[[",
        ),
        (
            derived("a", "deg/h", "static_bias") + "[[derived_limit]]\nderived = \"a\"\nmax = \"3 degC\"\n",
            "degC",
            "3 degC",
        ),
        (
            derived("a", "deg/h", "static_bias") + "[[derived_limit]]\nderived = \"c\"\nmax = \"3 deg/h\"\n",
            "no `[[derived]]` with the id `c`",
            "",
        ),
    ] {
        procedure(at, &formula);
        let said = sagnac(at, &["check", "own.toml"]);
        let all = said.out.clone() + &said.err;
        assert!(said.code != 0 && all.contains(why), "{formula}\n{all}");
        if !place.is_empty() {
            // The line and column of the diagnostic are those of the part that is wrong.
            let text = std::fs::read_to_string(at.join("own.toml")).unwrap();
            let byte = text.rfind(place).unwrap();
            let line = text[..byte].matches('\n').count() + 1;
            assert!(all.contains(&format!("own.toml:{line}:")), "{formula}: line {line}\n{all}");
        }
    }
    procedure(at, &derived("a", "mdeg/s", "rss(static_bias@x, static_bias@y) + 0.1 [deg/h]"));
    let said = sagnac(at, &["check", "own.toml"]);
    assert_eq!(said.code, 0, "{said:?}");
}

#[test]
fn rows_follow_from_others_and_are_judged() {
    let dir = tempdir().unwrap();
    let at = dir.path();
    recording(at);
    let formulas = [
        derived("worst_noise", "deg/sqrt(h)", "worst(angle_random_walk)"),
        derived("twice", "deg/h", "2 * static_bias"),
        derived("difference", "mdeg/s", "static_bias@x - static_bias@y"),
        derived("walk_of_a_day", "deg/h", "rate_random_walk * sqrt(24 h)"),
        derived("floor", "deg/h", "max(abs(static_bias), walk_of_a_day)"),
        derived("ratio", "1", "worst_noise / angle_random_walk@x"),
    ]
    .concat();
    let limits = "[[derived_limit]]\nderived = \"worst_noise\"\nmax = \"0.01 deg/sqrt(h)\"\n\
        [[derived_limit]]\nderived = \"twice\"\nmin = \"-70 deg/h\"\n\
        [[derived_limit]]\nderived = \"floor\"\nmax = \"1 deg/h\"\n\
        [[derived_limit]]\nderived = \"walk_of_a_day\"\nmax = \"1e-6 deg/h\"\n";
    procedure(at, &format!("{formulas}{limits}"));
    let said = sagnac(at, &["run", "own.toml", "r.csv", "--out", "r"]);
    assert_eq!(said.code, 1, "{said:?}");
    let result = result(&at.join("r"));
    let rows = result["measurands"].as_array().unwrap();
    let row = |id: &str, channel: &str| {
        let found = rows.iter().find(|r| r["id"] == id && r["channel"] == channel);
        found.unwrap_or_else(|| panic!("no {id} of {channel}"))
    };
    let value = |id: &str, channel: &str| row(id, channel)["value"].as_f64().unwrap();
    let end = |id: &str, channel: &str, end: &str| row(id, channel)["interval"][end].as_f64().unwrap();

    assert_eq!(value("worst_noise", "x+y"), value("angle_random_walk", "y"));
    assert_eq!(row("worst_noise", "x+y")["verdict"], "pass");
    // One row a channel; an exact multiple keeps the interval of its input.
    for channel in ["x", "y"] {
        let of = |id: &str, name: &str| end(id, channel, name);
        assert!((value("twice", channel) / value("static_bias", channel) - 2.0).abs() < 1e-12);
        for name in ["low", "high"] {
            let scale = of("static_bias", "high") - of("static_bias", "low");
            assert!(
                (of("twice", name) - 2.0 * of("static_bias", name)).abs() < 2e-3 * scale,
                "{channel} {name}"
            );
        }
    }
    assert_eq!(
        (row("twice", "x")["verdict"].as_str(), row("twice", "y")["verdict"].as_str()),
        (Some("pass"), Some("fail"))
    );
    // Both err together in the worst way: half intervals add up.
    let half = |id: &str, c: &str| 0.5 * (end(id, c, "high") - end(id, c, "low"));
    let sum = (half("static_bias", "x") + half("static_bias", "y")) / 3.6;
    assert!((half("difference", "x+y") / sum - 1.0).abs() < 5e-3, "{} {sum}", half("difference", "x+y"));
    assert!(
        (value("difference", "x+y") - (value("static_bias", "x") - value("static_bias", "y")) / 3.6).abs()
            < 1e-9
    );
    // K is not resolved: the formula has a bound and no value, and so has what is at least something.
    let walk = row("walk_of_a_day", "x");
    assert!(
        walk["value"].is_null() && walk["identifiable"] == false && walk["verdict"] == "indeterminate",
        "{walk}"
    );
    let k = row("rate_random_walk", "x")["upper_limit"]["value"].as_f64().unwrap();
    assert!(
        (walk["upper_limit"]["value"].as_f64().unwrap() / (k * 24_f64.sqrt()) - 1.0).abs() < 1e-9,
        "{walk}"
    );
    let floor = row("floor", "x");
    assert!(floor["value"].is_null() && floor["lower_limit"]["value"].as_f64().unwrap() > 10.0, "{floor}");
    assert_eq!(floor["verdict"], "fail", "what is at least 12 is above 1 whatever the other is: {floor}");
    assert!(value("ratio", "x+y") > 2.5 && value("ratio", "x+y") < 3.5);
    assert_eq!(measurand(&result, "ratio")["method"], "formula");
    let report = std::fs::read_to_string(at.join("r/report.md")).unwrap();
    assert!(report.contains("worst(angle_random_walk)"), "the formula stands in the report");
}

#[test]
fn a_limits_file_judges_formulas_too() {
    let dir = tempdir().unwrap();
    let at = dir.path();
    recording(at);
    procedure(
        at,
        &(derived("worst_noise", "deg/sqrt(h)", "worst(angle_random_walk)")
            + "[[derived_limit]]\nderived = \"worst_noise\"\nmax = \"0.01 deg/sqrt(h)\"\n"),
    );
    let limits = |max: &str| {
        let head = "format = \"limits/1\"\n[limits]\nid = \"l\"\ntitle = \"L\"\nrevision = \"A\"\n";
        let text = format!("{head}[[derived_limit]]\nderived = \"worst_noise\"\nmax = \"{max}\"\n");
        std::fs::write(at.join("l.toml"), text).unwrap();
    };
    // Tighter than the limit of the procedure, which it replaces.
    limits("0.001 deg/sqrt(h)");
    let said = sagnac(at, &["run", "own.toml", "r.csv", "--limits", "l.toml", "--out", "a"]);
    assert_eq!(said.code, 1, "{said:?}");
    // A limit that measures something else decides nothing, and is no pass.
    limits("3 degC");
    let said = sagnac(at, &["run", "own.toml", "r.csv", "--limits", "l.toml", "--out", "b"]);
    assert_eq!(said.code, 3, "{said:?}");
    let checked = sagnac(at, &["check", "own.toml", "l.toml"]);
    assert!((checked.out + &checked.err).contains("degC"));
}

#[test]
fn the_covariance_of_one_fit_narrows_the_interval() {
    let dir = tempdir().unwrap();
    let at = dir.path();
    // 0.1 deg/√h and 0.6 deg/h/√h on both axes: the fit resolves N and K.
    let mut text = String::from("time_s,x,y\n");
    let (mut x, mut y) = (0.0, 0.0);
    for i in 0..40_000 {
        x += 0.01 * white(1001, i);
        y += 0.01 * white(1003, i);
        let _ = writeln!(text, "{i},{:.5},{:.5}", x + 6.0 * white(1002, i), y + 6.0 * white(1004, i));
    }
    std::fs::write(at.join("r.csv"), text).unwrap();
    procedure(
        at,
        &[
            derived("one_fit", "deg/h", "400 * angle_random_walk / sqrt(1 h) + rate_random_walk * sqrt(1 h)"),
            derived("two_fits", "deg/sqrt(h)", "angle_random_walk@x + angle_random_walk@y"),
        ]
        .concat(),
    );
    let said = sagnac(at, &["run", "own.toml", "r.csv", "--out", "r"]);
    assert_eq!(said.code, 0, "{said:?}");
    let result = result(&at.join("r"));
    let half = |id: &str, channel: &str| {
        let rows = result["measurands"].as_array().unwrap();
        let row = rows.iter().find(|r| r["id"] == id && r["channel"] == channel).unwrap();
        let end = |name: &str| row["interval"][name].as_f64().unwrap_or_else(|| panic!("{row}"));
        0.5 * (end("high") - end("low"))
    };
    let worst = 400.0 * half("angle_random_walk", "x") + half("rate_random_walk", "x");
    let ratio = half("one_fit", "x") / worst;
    assert!(ratio > 0.3 && ratio < 0.95, "N and K of one fit are not correlated in the worst way: {ratio}");
    let sum = half("angle_random_walk", "x") + half("angle_random_walk", "y");
    assert!((half("two_fits", "x+y") / sum - 1.0).abs() < 0.01, "of two fits nothing is known");
}
