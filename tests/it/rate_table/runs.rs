//! Table tests from the command line: every shipped procedure on its samples, and every mistake by its name.

use crate::support::pairs::sample_once;
use crate::support::shared::shared;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

fn root(path: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// Runs a procedure on a recording; gives the exit code and the result.
pub fn run(procedure: &Path, recording: &Path) -> (i32, Value) {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("report");
    let status = Command::new(env!("CARGO_BIN_EXE_sagnac"))
        .args(["run".as_ref(), procedure.as_os_str(), recording.as_os_str()])
        .args(["--serial", "SN-1", "--out"])
        .arg(&out)
        .output()
        .unwrap();
    let text = std::fs::read_to_string(out.join("result.json"))
        .unwrap_or_else(|e| panic!("{e}: {}", String::from_utf8_lossy(&status.stderr)));
    for page in ["report.html", "report.md"] {
        assert!(out.join(page).exists(), "{page}");
    }
    (status.status.code().unwrap(), serde_json::from_str(&text).unwrap())
}

#[test]
fn every_shipped_procedure_passes_one_sample_and_does_not_pass_another() {
    for (sample, code) in [
        ("scale-factor-pass", 0),
        ("scale-factor-fail", 1),
        ("threshold-pass", 0),
        ("threshold-fail", 1),
        ("misalignment-pass", 0),
        ("misalignment-fail", 1),
        ("multi-position-pass", 0),
        ("multi-position-software", 3),
    ] {
        let run = sample_once(sample);
        assert_eq!(run.said.code, code, "{sample}: {:#}", run.result()["summary"]);
        assert!(!run.result()["measurands"].as_array().unwrap().is_empty(), "{sample}");
    }
}

/// The sentences of the conditions that are invalid, by name, and what they say.
fn invalid(result: &Value) -> Vec<(String, String)> {
    let list = result["conditions"].as_array().unwrap();
    list.iter()
        .filter(|c| c["status"] == "invalid")
        .map(|c| (c["message"]["id"].as_str().unwrap().to_owned(), c["note"].as_str().unwrap().to_owned()))
        .collect()
}

/// Runs a shipped procedure with texts replaced on a sample with its rows changed; gives the invalid conditions.
fn mistaken(
    procedure: &str,
    changes: &[(&str, &str)],
    sample: &str,
    row: impl Fn(&mut Vec<f64>),
) -> Vec<(String, String)> {
    let folder = tempfile::tempdir().unwrap();
    let mut text = std::fs::read_to_string(root(&format!("procedures/{procedure}.toml"))).unwrap();
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    let path = folder.path().join("procedure.toml");
    std::fs::write(&path, text).unwrap();
    let recording = std::fs::read_to_string(root(&format!("samples/{sample}.csv"))).unwrap();
    let mut out = String::new();
    for (i, line) in recording.lines().enumerate() {
        if i == 0 {
            out.push_str(line);
        } else {
            let mut values: Vec<f64> = line.split(',').map(|v| v.parse().unwrap()).collect();
            row(&mut values);
            out.push_str(&values.iter().map(f64::to_string).collect::<Vec<_>>().join(","));
        }
        out.push('\n');
    }
    let data = folder.path().join("recording.csv");
    std::fs::write(&data, out).unwrap();
    let (code, result) = run(&path, &data);
    assert_eq!(code, 3, "{:#}", result["conditions"]);
    invalid(&result)
}

fn names(found: &[(String, String)], id: &str) -> bool {
    found.iter().any(|(name, _)| name == id)
}

#[test]
fn mistakes_name_themselves() {
    let keep = |_: &mut Vec<f64>| {};
    let sign = mistaken("scale-factor", &[], "scale-factor-pass", |v| v[1] = -v[1]);
    assert!(names(&sign, "on_table.reversed"), "{sign:?}");

    let short = mistaken(
        "scale-factor",
        &[("full_scale = \"100 deg/s\"", "full_scale = \"300 deg/s\"")],
        "scale-factor-pass",
        keep,
    );
    assert!(names(&short, "on_table.not_reached"), "{short:?}");

    // The table was asked for the rates and turned at nine tenths of them.
    let slow = mistaken("scale-factor", &[], "scale-factor-pass", |v| v[2] /= 0.9);
    assert!(names(&slow, "on_table.fell_short"), "{slow:?}");

    let unit = mistaken(
        "threshold",
        &[(
            "column = \"rate_deg_h\"\nrole = \"rate\"\nunit = \"deg/h\"",
            "column = \"rate_deg_h\"\nrole = \"rate\"\nunit = \"deg/s\"",
        )],
        "threshold-pass",
        keep,
    );
    assert!(unit.iter().any(|(id, said)| id == "on_table.mistaken" && said.contains("deg/h")), "{unit:?}");

    let other = mistaken("scale-factor", &[], "scale-factor-pass", |v| v[1] = (v[0] * 7.3).sin().round());
    assert!(names(&other, "on_table.does_not_follow"), "{other:?}");

    let latitude = mistaken(
        "multi-position",
        &[("latitude = \"55.98 deg\"", "latitude = \"36 deg\"")],
        "multi-position-pass",
        keep,
    );
    assert!(
        latitude.iter().any(|(id, said)| id == "known.latitude" && said.contains("56.0")),
        "{latitude:?}"
    );

    let swapped = mistaken("multi-position", &[], "multi-position-pass", |v| v[1] = -v[1]);
    assert!(names(&swapped, "known.reversed"), "{swapped:?}");

    let software = mistaken("multi-position", &[], "multi-position-software", keep);
    assert!(names(&software, "known.software"), "{software:?}");

    let per_second = mistaken("multi-position", &[], "multi-position-pass", |v| v[1] /= 3600.0);
    assert!(
        per_second.iter().any(|(id, said)| id == "on_table.mistaken" && said.contains("deg/s")),
        "{per_second:?}"
    );

    let southern = mistaken(
        "multi-position",
        &[("latitude = \"55.98 deg\"", "latitude = \"-55.98 deg\"")],
        "multi-position-pass",
        keep,
    );
    assert!(southern.iter().any(|(_, said)| said.contains("of the latitude")), "{southern:?}");

    let lying = mistaken("multi-position", &[], "multi-position-pass", |v| {
        if ((v[0] / 600.0) as u32) % 2 == 1 {
            v[1] += 2.0 * 12.467;
        }
    });
    assert!(names(&lying, "known.not_turned"), "{lying:?}");
}

#[test]
fn a_full_scale_far_below_the_rates_and_an_exchanged_unit_are_named() {
    let low = mistaken(
        "scale-factor",
        &[("full_scale = \"100 deg/s\"", "full_scale = \"10 deg/s\"")],
        "scale-factor-pass",
        |_| {},
    );
    assert!(names(&low, "on_table.beyond"), "{low:?}");
    // A dead zone takes a part of the output away, and the unit is identified all the same.
    let unit = mistaken("threshold", &[], "threshold-pass", |v| v[1] /= 3600.0);
    assert!(unit.iter().any(|(id, said)| id == "on_table.mistaken" && said.contains("deg/s")), "{unit:?}");
}

#[test]
fn the_inner_axis_of_a_misalignment_test_shows_mistakes_of_its_own() {
    let (rate, inner_rate, angle, outer) = (1, 2, 3, 4);
    let of = |row: &dyn Fn(&mut Vec<f64>)| mistaken("misalignment", &[], "misalignment-pass", row);
    let unit = of(&|v| v[rate] /= 3600.0);
    assert!(unit.iter().any(|(id, said)| id == "on_table.mistaken" && said.contains("deg/s")), "{unit:?}");
    let backwards = of(&|v| v[angle] = -v[angle]);
    assert!(names(&backwards, "on_table.angle_reversed"), "{backwards:?}");
    let radians = of(&|v| v[angle] = v[angle].to_radians());
    assert!(names(&radians, "on_table.angle_in_radians"), "{radians:?}");
    let creeps = of(&|v| {
        if v[outer].abs() > 1.0 {
            v[inner_rate] += 0.5;
        }
    });
    assert!(names(&creeps, "on_table.inner_moves"), "{creeps:?}");
}

#[test]
fn twice_the_earth_rate_with_the_opposite_sign_is_no_bias() {
    use sagnac::acceptance::condition::table::{ChannelFact, TableFacts, judge};
    use sagnac::record::ConditionStatus;
    let status = |bias: f64, limit: Option<f64>| {
        let channel = ChannelFact {
            channel: "z".into(),
            asked: true,
            polarity_judged: false,
            unit: "deg/h".into(),
            factor: Some(1.0),
            standard: 1e-6,
            bias_and_earth: Some((bias, -12.467)),
            bias_limit: limit,
        };
        let facts = TableFacts { steps: 20, levels: 10, channels: vec![channel], ..TableFacts::default() };
        judge(&facts).into_iter().find(|c| c.id == "table_earth_rate").map(|c| c.status)
    };
    assert_eq!(status(25.25, Some(0.5)), Some(ConditionStatus::Invalid));
    assert_eq!(status(25.25, None), Some(ConditionStatus::Remark));
    assert_eq!(
        (status(0.3, Some(0.5)), status(3.1, Some(0.5)), status(-25.0, Some(0.5))),
        (None, None, None)
    );
}

#[test]
fn a_recording_that_repeats_itself_is_invalid() {
    for (name, sample) in [
        ("scale-factor", "scale-factor-pass"),
        ("threshold", "threshold-pass"),
        ("misalignment", "misalignment-pass"),
        ("multi-position", "multi-position-pass"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let text = std::fs::read_to_string(root(&format!("samples/{sample}.csv"))).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        let stamp = |line: &str| line.split(',').next().and_then(|t| t.parse::<f64>().ok());
        let length =
            stamp(lines[lines.len() - 1]).unwrap() + stamp(lines[2]).unwrap() - stamp(lines[1]).unwrap();
        let mut twice = text.clone();
        for line in &lines[1..] {
            let (at, rest) = line.split_once(',').unwrap();
            let later = at.parse::<f64>().unwrap() + length - stamp(lines[1]).unwrap();
            twice.push_str(&format!("{later:.4},{rest}\n"));
        }
        let data = folder.path().join("recording.csv");
        std::fs::write(&data, twice).unwrap();
        let (code, result) = run(&root(&format!("procedures/{name}.toml")), &data);
        let conditions = result["conditions"].as_array().unwrap();
        let repeated = conditions.iter().any(|c| c["id"] == "repeated" && c["status"] == "invalid");
        assert!(code == 3 && repeated, "{name}: {:#}", result["summary"]);
    }
}

#[test]
fn swapped_axes_are_told_from_an_axis_that_does_not_turn() {
    use sagnac::acceptance::condition::table::{ChannelFact, TableFacts, judge};
    let channel = |name: &str, factor: f64| ChannelFact {
        channel: name.into(),
        asked: name != "unasked",
        polarity_judged: false,
        unit: "deg/s".into(),
        factor: Some(factor),
        standard: 1e-5,
        bias_and_earth: None,
        bias_limit: None,
    };
    let facts = TableFacts {
        steps: 20,
        levels: 10,
        lowest: -3600.0,
        highest: 3600.0,
        channels: vec![channel("z", 0.002), channel("x", 0.9998)],
        ..TableFacts::default()
    };
    let judged = judge(&facts);
    let said: Vec<&str> = judged.iter().map(|c| c.message.as_ref().map_or("", |m| m.id.as_ref())).collect();
    assert!(said.contains(&"on_table.another_axis") && said.contains(&"on_table.follows"), "{said:?}");
    // Of three channels one lies along the axis; one of which nothing is asked may lie across.
    let triad = TableFacts {
        channels: vec![channel("x", 0.004), channel("unasked", -0.002), channel("z", 1.0001)],
        ..facts
    };
    let judged = judge(&triad);
    let said: Vec<&str> = judged.iter().map(|c| c.message.as_ref().map_or("", |m| m.id.as_ref())).collect();
    let one_axis = said.iter().filter(|s| **s == "table_motion.one_axis").count();
    assert!(one_axis == 1 && said.contains(&"on_table.follows"), "{said:?}");
}

#[test]
fn steps_are_shown_with_the_unit_that_reads_well_and_what_was_recorded() {
    for (name, lang, sentence, column, temperatures) in [
        ("threshold", "en", "from −13.717 °/h to −11.216 °/h", "Rate, °/h", false),
        ("threshold", "ru", "от −13,717 град/ч до −11,216 град/ч", "Скорость, град/ч", false),
        ("scale-factor", "en", "from −100.00 °/s to 100.00 °/s", "Rate, °/s", true),
    ] {
        let run = sample_once(&format!("{name}-pass"));
        let out = &shared(&["report", run.path(), "--lang", lang], "report").out;
        let text = std::fs::read_to_string(out.join("report.md")).unwrap();
        assert!(text.contains(sentence) && text.contains(column), "{name} {lang}: {text}");
        assert_eq!(text.contains("Temperature, °C |") || text.contains("Температура, °C |"), temperatures);
        let figure = std::fs::read_to_string(out.join("figures/table_steps.svg")).unwrap();
        assert!(figure.contains(column.rsplit(' ').next().unwrap()), "{name} {lang}");
    }
}
