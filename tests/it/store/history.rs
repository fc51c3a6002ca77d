//! What a store tells over time.

use crate::store::{a_result, kept, store, with_store, write_result};
use crate::support::{Said, names, sagnac};
use serde_json::{Value, json};
use std::path::Path;

/// Writes units of a line: each tested once a day, from a day on.
fn write_line(folder: &Path, values: &[f64], station: &str, first_day: usize) {
    for (i, value) in values.iter().enumerate() {
        let at = format!("2026-03-{:02}T10:00:00Z", first_day + i);
        let mut result = a_result(&format!("{station}-{i}"), "L1", &at, *value);
        result["session"]["station"] = station.into();
        write_result(folder, &format!("{station}-{i}"), &result);
    }
}

fn ask(folder: &Path, args: &[&str]) -> Said {
    let said = sagnac(folder, &[&["history", "--store", "store"], args].concat());
    assert_eq!(said.code, 0, "{args:?}: {said:?}");
    said
}

fn asked(folder: &Path, args: &[&str]) -> Value {
    serde_json::from_str(&ask(folder, &[args, &["--format", "json"]].concat()).out).unwrap()
}

#[test]
fn yields_count_the_first_and_the_last_test_of_products() {
    let dir = with_store();
    let made = dir.path().join("made");
    // Passes at once; passes at the second attempt; never passes; aborted, then passes.
    for (serial, values) in [("1", &[0.5][..]), ("2", &[1.5, 0.5]), ("3", &[1.5, 1.4])] {
        for (i, value) in values.iter().enumerate() {
            let at = format!("2026-03-0{serial}T1{i}:00:00Z");
            write_result(&made, &format!("{serial}-{i}"), &a_result(serial, "L1", &at, *value));
        }
    }
    let mut aborted = a_result("4", "L1", "2026-03-04T10:00:00Z", 1.5);
    aborted["verdict"] = "error".into();
    write_result(&made, "4-0", &aborted);
    write_result(&made, "4-1", &a_result("4", "L1", "2026-03-04T11:00:00Z", 0.5));
    let mut invalid = a_result("3", "L1", "2026-03-05T11:00:00Z", 0.5);
    invalid["verdict"] = "indeterminate".into();
    invalid["conditions"] = json!([{"id": "temperature", "status": "invalid"}]);
    write_result(&made, "3-2", &invalid);
    let mut reference = a_result("REF", "", "2026-03-06T10:00:00Z", 1.5);
    reference["unit_under_test"]["reference"] = true.into();
    write_result(&made, "ref", &reference);
    store(dir.path(), &["import", "store", "made"]);
    let history = asked(dir.path(), &[]);
    let first = &history["yields"][0]["first_pass"];
    let last = &history["yields"][0]["last_pass"];
    assert_eq!((&first["count"], &first["of"]), (&2.into(), &4.into()), "{history:#}");
    assert_eq!((&last["count"], &last["of"]), (&3.into(), &4.into()));
    // Clopper and Pearson, 2 of 4: 0.0676 to 0.9324.
    assert!((first["low"].as_f64().unwrap() - 0.0676).abs() < 1e-4, "{first}");
    assert!((first["high"].as_f64().unwrap() - 0.9324).abs() < 1e-4, "{first}");
    assert_eq!(history["counts"]["not_done"], 2);
    assert_eq!(history["counts"]["of_reference_units"], 1);
    let reasons: Vec<(&str, u64)> = history["reasons"]
        .as_array()
        .unwrap()
        .iter()
        .map(|r| (r["name"].as_str().unwrap(), r["results"].as_u64().unwrap()))
        .collect();
    assert_eq!(reasons, [("static_bias", 4), ("temperature", 1)]);
    let months = &history["months"];
    assert_eq!((&months[0]["month"], &months[0]["tests"]), (&"2026-03".into(), &6.into()));
}

#[test]
fn a_point_beyond_its_limits_is_named_and_capability_has_its_bound() {
    let dir = with_store();
    let mut values: Vec<f64> = (0..20).map(|i| if i % 2 == 0 { 0.40 } else { 0.60 }).collect();
    values.push(2.0);
    write_line(&dir.path().join("made"), &values, "S1", 1);
    store(dir.path(), &["import", "store", "made"]);
    let history = asked(dir.path(), &["--measurand", "static_bias"]);
    let chart = &history["charts"][0];
    assert_eq!((&chart["of"], &chart["control"]["in_control"]), (&"process".into(), &false.into()));
    let broken = chart["control"]["points"][20]["broken"].as_array().unwrap();
    assert!(broken.contains(&"beyond".into()), "{broken:?}");
    // The uncertainty of a point widens its limits: 95 % interval of ±0.1.
    let process = chart["control"]["process"].as_f64().unwrap();
    let reach = chart["control"]["points"][0]["reach"].as_f64().unwrap();
    let standard = 0.1 / 1.959_964;
    assert!((reach - 3.0 * (process * process + standard * standard).sqrt()).abs() < 1e-6, "{reach}");
    let capability = &chart["capability"];
    assert!(capability["cpk_at_least"].as_f64() < capability["cpk"].as_f64(), "{capability}");
    let shown = ask(dir.path(), &["--measurand", "static_bias"]);
    assert!(shown.out.contains("out of control") && shown.out.contains("Value 21 (S1-20"), "{}", shown.out);
    let few = asked(dir.path(), &["--since", "2026-03-18"]);
    assert_eq!(few["charts"][0]["capability"], Value::Null);
    assert!(few["charts"][0]["notes"].to_string().contains("no_capability"), "{few:#}");
}

/// A unit tested at these hours of days of March, with its values.
fn write_days(folder: &Path, days: &[&[f64]]) {
    for (day, runs) in days.iter().enumerate() {
        for (run, value) in runs.iter().enumerate() {
            let at = format!("2026-03-{:02}T{:02}:00:00Z", 1 + 3 * day, 8 + run);
            write_result(folder, &format!("{day}-{run}"), &a_result("SN-7", "L1", &at, *value));
        }
    }
}

#[test]
fn runs_within_days_tell_the_scatter_of_both_and_the_trend() {
    let dir = with_store();
    // Runs differ by 0.01, days by some 0.1, and 0.02 is gained every third day.
    let levels = [0.10, -0.08, 0.05, -0.11, 0.09, -0.02];
    let days: Vec<Vec<f64>> = levels
        .iter()
        .enumerate()
        .map(|(i, level)| [0.0, 0.01].iter().map(|run| 0.4 + 0.02 * i as f64 + level + run).collect())
        .collect();
    write_days(&dir.path().join("made"), &days.iter().map(Vec::as_slice).collect::<Vec<_>>());
    store(dir.path(), &["import", "store", "made"]);
    let of_unit = asked(dir.path(), &["7", "--measurand", "static_bias"]);
    let found = &of_unit["stabilities"][0];
    assert_eq!((&found["runs"], &found["days"]), (&12.into(), &6.into()), "{found}");
    let number = |name: &str, end: &str| found[name][end].as_f64().unwrap_or_else(|| panic!("{found}"));
    // Square sum 6·0.00005 of 6 degrees of freedom.
    assert!((number("run_deviation", "value") - 0.00005_f64.sqrt()).abs() < 1e-9);
    let holds = |name: &str, truth: f64| number(name, "low") < truth && truth < number(name, "high");
    // χ² of 6 at 2.5 and 97.5 % is 1.2373 and 14.449.
    assert!((number("run_deviation", "high") - (0.0003_f64 / 1.2373).sqrt()).abs() < 1e-6);
    assert!(holds("day_deviation", 0.09) && number("day_deviation", "low") > 0.03, "{found}");
    assert!(holds("per_month", 0.02 / 3.0 * 30.4375), "{found}");
    assert_eq!(found["notes"], json!([]));
    let english = ask(dir.path(), &["7", "--measurand", "static_bias"]).out;
    assert!(english.contains("Stability over days") && english.contains("σ of a day"), "{english}");
    let russian = ask(dir.path(), &["7", "--measurand", "static_bias", "--lang", "ru"]).out;
    assert!(russian.contains("Стабильность по дням"), "{russian}");
    // Of all units together there is no such thing.
    assert_eq!(asked(dir.path(), &[])["stabilities"], json!([]));
}

#[test]
fn too_few_days_or_runs_are_named_in_place_of_a_value() {
    for (days, present, notes) in [
        (&[&[0.5, 0.6][..], &[0.4, 0.5], &[0.3, 0.35]][..], [true, false, false], &["few_days"][..]),
        (&[&[0.5], &[0.4], &[0.3], &[0.45], &[0.41]], [false, false, true], &["few_repeats"]),
        (&[&[0.5, 0.6], &[0.4]], [false; 3], &["few_repeats", "few_days"]),
        (&[&[0.5, 0.5], &[0.5, 0.5], &[0.4, 0.4], &[0.5]], [false, false, true], &["alike"]),
    ] {
        let dir = with_store();
        write_days(&dir.path().join("made"), days);
        store(dir.path(), &["import", "store", "made"]);
        let of_unit = asked(dir.path(), &["7", "--measurand", "static_bias"]);
        let found = &of_unit["stabilities"][0];
        let values = ["run_deviation", "day_deviation", "per_month"];
        assert_eq!(values.map(|name| !found[name].is_null()), present, "{found}");
        let said: Vec<String> = found["notes"]
            .as_array()
            .unwrap()
            .iter()
            .map(|n| n["id"].as_str().unwrap().replace("history.stability.", ""))
            .collect();
        assert_eq!(said, notes, "{found}");
    }
    let dir = with_store();
    write_days(&dir.path().join("made"), &[&[0.5], &[0.4]]);
    store(dir.path(), &["import", "store", "made"]);
    assert_eq!(asked(dir.path(), &["7"])["stabilities"], json!([]));
}

#[test]
fn what_is_common_to_the_tests_of_a_unit_cancels_in_its_drift() {
    let dir = with_store();
    for (i, value) in [0.50, 0.55, 0.60].iter().enumerate() {
        let at = format!("202{}-03-01T10:00:00Z", 4 + i);
        write_result(&dir.path().join("made"), &format!("{i}"), &a_result("SN-7", "L1", &at, *value));
    }
    store(dir.path(), &["import", "store", "made"]);
    let drift = |more: &[&str]| {
        asked(dir.path(), &[&["7", "--measurand", "static_bias"], more].concat())["drifts"][0].clone()
    };
    let (apart, common) = (drift(&[]), drift(&["--common", "0.045"]));
    assert!((apart["change"].as_f64().unwrap() - 0.1).abs() < 1e-12);
    let half = |d: &Value| d["change_half_width"].as_f64().unwrap();
    assert!((half(&apart) - 0.1 * 2.0_f64.sqrt()).abs() < 1e-6, "{apart}");
    assert!(half(&common) < 0.1 && half(&apart) > 0.1, "{common}");
    assert!((apart["per_year"].as_f64().unwrap() - 0.05).abs() < 1e-4, "{apart}");
    let said = ask(dir.path(), &["SN-007", "--measurand", "static_bias", "--common", "0.045"]);
    assert!(said.out.contains("Drift of the unit"), "{}", said.out);
    assert_eq!(asked(dir.path(), &["7"])["charts"][0]["of"], "unit");
}

#[test]
fn a_bench_that_wanders_is_told_by_its_reference_unit() {
    let dir = with_store();
    let made = dir.path().join("made");
    for (station, step) in [("S1", 0.0), ("S2", 1.2)] {
        for i in 0..24 {
            let value = 0.5 + 0.05 * f64::from(i % 3) + if i > 14 { step } else { 0.0 };
            let at = format!("2026-04-{:02}T10:00:00Z", i + 1);
            let mut result = a_result("REF-1", "", &at, value);
            result["unit_under_test"]["reference"] = true.into();
            result["session"]["station"] = station.into();
            write_result(&made, &format!("{station}-{i}"), &result);
        }
    }
    store(dir.path(), &["import", "store", "made"]);
    let history = asked(dir.path(), &[]);
    let charts = history["charts"].as_array().unwrap();
    let state = |station: &str| {
        let chart = charts.iter().find(|c| c["of"] == "bench" && c["station"] == station).unwrap();
        chart["control"]["in_control"].as_bool().unwrap()
    };
    assert!(state("S1") && !state("S2"), "{history:#}");
    assert!(history["yields"].as_array().unwrap().is_empty());
    let said = ask(dir.path(), &[]);
    assert!(said.out.contains("Benches that wander") && said.out.contains("S2: "), "{}", said.out);
}

#[test]
fn stations_are_set_against_each_other() {
    let dir = with_store();
    let made = dir.path().join("made");
    let near = |center: f64| (0..12).map(|i| center + 0.02 * f64::from(i % 4)).collect::<Vec<f64>>();
    for (station, center) in [("S1", 0.4), ("S2", 0.4), ("S3", 0.8)] {
        write_line(&made, &near(center), station, 1);
    }
    store(dir.path(), &["import", "store", "made"]);
    let history = asked(dir.path(), &[]);
    let differs: Vec<bool> =
        history["stations"].as_array().unwrap().iter().map(|s| s["differs"].as_bool().unwrap()).collect();
    assert_eq!(differs.len(), 3);
    assert!(differs[2], "{:#}", history["stations"]);
}

#[test]
fn every_form_has_the_same_results_and_the_index_made_anew_the_same_bytes() {
    let dir = with_store();
    write_line(&dir.path().join("made"), &[0.4, 0.5, 0.6, 0.5, 0.4, 1.2], "S1", 1);
    store(dir.path(), &["import", "store", "made"]);
    let forms = |folder: &Path| ["table", "csv", "json", "html"].map(|f| ask(folder, &["--format", f]).out);
    let before = forms(dir.path());
    store(dir.path(), &["rebuild", "store"]);
    assert!(forms(dir.path()) == before);
    let [_, csv, json, html] = &before;
    for (address, _) in kept(&dir.path().join("store")) {
        assert!(csv.contains(&address) && json.contains(&address) && html.contains(&address[..12]));
    }
    assert_eq!(csv.lines().count(), 7);
    // One file that needs no other, in both languages.
    let russian = sagnac(dir.path(), &["history", "--store", "store", "--format", "html", "--lang", "ru"]);
    for page in [html, &russian.out] {
        assert!(
            page.contains("<svg") && !page.contains("src=") && !page.contains("href=\"http"),
            "self-contained"
        );
        assert!(!page.contains("history."), "a key without words");
    }
    assert!(russian.out.contains("Контрольные границы") || russian.out.contains("контрольные границы"));
    ask(dir.path(), &["--format", "html", "--out", "page.html"]);
    assert!(names(dir.path()).contains(&"page.html".to_owned()));
    let again = sagnac(dir.path(), &["history", "--store", "store", "--format", "csv", "--out", "page.html"]);
    assert_eq!(again.code, 0, "the helper adds --force: {again:?}");
}

#[test]
fn what_cannot_be_answered_is_said() {
    let dir = with_store();
    for (args, part) in [
        (&["--store", "store"][..], "no result that suits"),
        (&["--store", "store", "--measurand", "bias"], "`bias` is no measurand"),
        (&["--store", "elsewhere"], "no store"),
    ] {
        let said = sagnac(dir.path(), &[&["history"], args].concat());
        assert!(said.code == 2 && said.err.contains(part), "{args:?}: {said:?}");
    }
}

#[test]
fn a_data_sheet_is_made_of_what_counts_in_the_store() {
    let dir = with_store();
    let made = dir.path().join("made");
    write_line(&made, &[0.40, 0.52, 0.61, 0.55, 0.43, 0.72, 0.58, 0.49], "S1", 1);
    let mut reference = a_result("REF", "L1", "2026-03-20T10:00:00Z", 0.3);
    reference["unit_under_test"]["reference"] = true.into();
    write_result(&made, "ref", &reference);
    write_result(&made, "other", &a_result("B-1", "L9", "2026-03-20T10:00:00Z", 0.9));
    store(dir.path(), &["import", "store", "made"]);
    let args = ["datasheet", "--store", "store", "--device-model", "A-1", "--lot", "L1", "--out", "sheet"];
    let said = sagnac(dir.path(), &args);
    assert_eq!(said.code, 0, "{said:?}");
    let sheet: Value =
        serde_json::from_slice(&std::fs::read(dir.path().join("sheet/datasheet.json")).unwrap()).unwrap();
    assert_eq!((&sheet["units"], &sheet["lots"]), (&8.into(), &1.into()));
    assert!(sheet["notes"].to_string().contains("left_out"), "{}", sheet["notes"]);
    // The same as of the files themselves.
    let files = sagnac(dir.path(), &["datasheet", "made/S1-*/result.json", "--out", "files"]);
    assert_eq!(files.code, 0, "{files:?}");
    let of_files: Value =
        serde_json::from_slice(&std::fs::read(dir.path().join("files/datasheet.json")).unwrap()).unwrap();
    assert_eq!(sheet["quantities"], of_files["quantities"]);
    let none = sagnac(dir.path(), &["datasheet", "--out", "x"]);
    assert_eq!(none.code, 2, "{none:?}");
}
