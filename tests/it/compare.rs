//! The verb `compare`, as a user runs it.

use crate::support::shared::{SharedRun, analyzed_once, shared, shared_input, tested_once};
use crate::support::{root, sagnac, sample, shipped};
use serde_json::Value;
use std::path::Path;
use tempfile::tempdir;

fn json(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn compare(folder: &Path, args: &[&str]) -> (String, Value) {
    let all = [&["compare"], args, &["--out", "c"]].concat();
    let said = sagnac(folder, &all);
    assert_eq!((said.code, said.err.as_str()), (0, ""), "{args:?}: {said:?}");
    let mut names: Vec<String> = std::fs::read_dir(folder.join("c"))
        .unwrap()
        .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
        .filter(|n| n != "figures")
        .collect();
    names.sort();
    assert_eq!(
        names,
        ["SHA256SUMS", "comparison.csv", "comparison.html", "comparison.json", "comparison.md"]
    );
    (said.out, json(&folder.join("c/comparison.json")))
}

/// A field of the first row of the table.
fn field(folder: &Path, row: usize, name: &str) -> String {
    let text = std::fs::read_to_string(folder.join("c/comparison.csv")).unwrap();
    let lines: Vec<Vec<&str>> = text.lines().map(|l| l.split(',').collect()).collect();
    let at = lines[0].iter().position(|c| *c == name).unwrap_or_else(|| panic!("no column {name}"));
    lines[row][at].to_owned()
}

fn number(folder: &Path, row: usize, name: &str) -> f64 {
    field(folder, row, name).parse().unwrap_or_else(|_| panic!("{name}: {}", field(folder, row, name)))
}

#[test]
fn a_recording_and_its_result_give_the_same_comparison() {
    let dir = tempdir().unwrap();
    let analysed = analyzed_once("pass").path();
    let record = format!("{analysed}/result.json");
    let (table, all) = compare(dir.path(), &[&sample("pass"), analysed, &record]);
    assert_eq!(all["format"], "comparison/1");
    let units = all["units"].as_array().unwrap();
    assert_eq!(units.len(), 3);
    let origins: Vec<&str> = units.iter().map(|u| u["origin"].as_str().unwrap()).collect();
    assert_eq!(origins, ["recording", "result", "result"]);
    for key in ["quantities", "rules", "detail", "says"] {
        assert_eq!(units[0][key], units[1][key], "{key}");
    }
    assert!(table.lines().next().unwrap().contains("σ100"), "{table}");
    // The sample was made with N = 0.002 and B = 0.003 in 100.5 h of 3618 windows.
    let n = 3618.0f64;
    let white = 36.0 * 0.002f64.powi(2);
    let flicker = 0.003f64.powi(2) / std::f64::consts::PI * n * n.ln() / (n - 1.0);
    let truth = (white + flicker).sqrt();
    let (low, high) = (number(dir.path(), 1, "predicted_low"), number(dir.path(), 1, "predicted_high"));
    assert!(low <= truth && truth <= high, "{low} {truth} {high}");
    assert_eq!(field(dir.path(), 1, "n_100s"), "3618");
    assert_eq!(field(dir.path(), 1, "detrend"), "mean");
    assert_eq!(field(dir.path(), 1, "largest_part"), "angle_random_walk");
    assert!((number(dir.path(), 1, "largest_share") - white / (white + flicker)).abs() < 0.06);
    assert_eq!(field(dir.path(), 1, "agreement"), "consistent");
    // The ratio is that of the two figures, and its inverse is its inverse.
    let ratio = number(dir.path(), 1, "sigma100_deg_h") / number(dir.path(), 1, "minimum_deg_h");
    assert!((number(dir.path(), 1, "ratio_minimum") / ratio - 1.0).abs() < 1e-12);
    assert!((number(dir.path(), 1, "ratio_minimum_inverse") * ratio - 1.0).abs() < 1e-12);
    // A floor lowers the ratio below what angle random walk alone would give.
    assert!(ratio < number(dir.path(), 1, "null_05"), "{ratio}");
    // (N/0.664 B)² h.
    let crossover = 3600.0 * (0.002f64 / (0.664_282_47 * 0.003)).powi(2);
    assert!((number(dir.path(), 1, "crossover_s") / crossover - 1.0).abs() < 0.4);
}

#[test]
fn the_octaves_add_up_to_the_drift() {
    let run = shared(&["compare", &sample("pass")], "c");
    let all = json(&run.out.join("comparison.json"));
    let o = &all["units"][0]["detail"]["octaves"];
    let windows = o["windows"].as_f64().unwrap();
    let sum: f64 = o["octaves"]
        .as_array()
        .unwrap()
        .iter()
        .map(|o| 0.5 * o["deviation_deg_h"].as_f64().unwrap().powi(2))
        .sum();
    let sigma = o["sigma"].as_f64().unwrap();
    assert_eq!(windows, 2048.0);
    assert!((sum * windows / (windows - 1.0) / (sigma * sigma) - 1.0).abs() < 1e-9);
    assert!(run.out.join("figures/octaves_1.svg").is_file());
    assert!(run.out.join("figures/ratios.svg").is_file());
}

/// The sample that passes, compared under limits of which one is on nothing that is compared.
fn compared_with_limits() -> &'static SharedRun {
    let head = "format = \"limits/1\"\n[limits]\nid = \"x\"\ntitle = \"X\"\nrevision = \"A\"\n";
    let limit = |id| format!("[[limit]]\nmeasurand = \"{id}\"\nmax = \"0.01 deg/h\"\n");
    let limits = shared_input("compared-limits.toml", || {
        [head.to_owned(), limit("static_bias"), limit("russian_drift_100s"), limit("bias_instability")]
            .concat()
    });
    shared(&["compare", &sample("pass"), "--limits", &limits], "c")
}

#[test]
fn a_limit_is_judged_against_the_figure_it_names() {
    let run = compared_with_limits();
    let (table, all) = (&run.said.out, json(&run.out.join("comparison.json")));
    let verdict = |id: &str| {
        let rows = all["units"][0]["quantities"].as_array().unwrap();
        rows.iter().find(|q| q["id"] == id).unwrap()["verdict"].as_str().unwrap().to_owned()
    };
    // The same 0.01 deg/h: the Russian drift of 0.013 breaks it, the fitted B of 0.003 keeps it.
    assert_eq!(verdict("russian_drift_100s"), "fail");
    assert_eq!(verdict("bias_instability"), "pass");
    assert_eq!(verdict("bias_instability_minimum"), "none");
    assert!(table.contains("fail") && table.contains("pass"), "{table}");
}

#[test]
fn a_limit_on_what_is_not_compared_is_told_to_be_left_out() {
    let page = compared_with_limits().text("comparison.md");
    assert_eq!(page.matches("Limits on Static bias are not applied here").count(), 1, "{page}");
    // A result says so of the limits it was judged by.
    let dir = tempdir().unwrap();
    compare(dir.path(), &[tested_once("pass").path()]);
    let page = std::fs::read_to_string(dir.path().join("c/comparison.md")).unwrap();
    assert!(page.contains("Static bias"), "{page}");
    assert_eq!(page.matches("are not applied here").count(), 1, "{page}");
}

#[test]
fn a_unit_against_the_name_of_the_column_is_told() {
    let dir = tempdir().unwrap();
    compare(dir.path(), &[&sample("pass"), "--unit", "deg/s"]);
    let page = std::fs::read_to_string(dir.path().join("c/comparison.md")).unwrap();
    assert!(page.contains("states deg/h but is read in deg/s"), "{page}");
    let said = &shared(&["analyze", &sample("pass"), "--rate", "rate_deg_h", "--unit", "deg/s"], "a").said;
    assert!(said.err.contains("column `rate_deg_h` states deg/h"), "{}", said.err);
    let said = sagnac(dir.path(), &["analyze", &sample("pass"), "--unit", "°/h", "--out", "b"]);
    assert!(!said.err.contains("states"), "{}", said.err);
}

#[test]
fn an_older_result_says_what_is_missing() {
    let dir = tempdir().unwrap();
    let mut old = analyzed_once("pass").result().clone();
    old.as_object_mut().unwrap().remove("comparison");
    std::fs::write(dir.path().join("old.json"), old.to_string()).unwrap();
    let (table, all) = compare(dir.path(), &["old.json"]);
    assert!(all["units"][0]["detail"].is_null());
    assert!(table.contains("Compare the recording itself."), "{table}");
    assert!(number(dir.path(), 1, "ratio_minimum") > 1.0);
    assert_eq!(field(dir.path(), 1, "predicted_deg_h"), "");
}

#[test]
fn what_cannot_be_compared_is_refused_with_code_2() {
    let dir = tempdir().unwrap();
    std::fs::write(dir.path().join("odd.json"), "{\"format\": \"other/1\"}").unwrap();
    std::fs::write(dir.path().join("broken.json"), "{").unwrap();
    std::fs::write(
        dir.path().join("list.json"),
        "{\"format\":\"result/1\",\"measurands\":[{\"id\":\"angle_random_walk\"}]}",
    )
    .unwrap();
    std::fs::write(dir.path().join("empty.json"), "{\"format\":\"result/1\",\"measurands\":[]}").unwrap();
    for name in ["odd.json", "broken.json", "list.json", "empty.json", "none.json", "none.csv"] {
        let said = sagnac(dir.path(), &["compare", name, "--out", "c"]);
        assert_eq!(said.code, 2, "{name}: {said:?}");
        assert!(said.err.starts_with("error: ") && said.err.contains(name), "{name}: {}", said.err);
        assert!(!dir.path().join("c").exists(), "{name} left a folder");
    }
    assert_eq!(sagnac(dir.path(), &["compare"]).code, 2);
    assert_eq!(sagnac(dir.path(), &["compare", "--published", &sample("pass")]).code, 2);
}

#[test]
fn a_refusal_says_what_is_wrong_with_the_file() {
    let dir = tempdir().unwrap();
    analyzed_once("pass").copy_to(&dir.path().join("a"));
    let whole = std::fs::read(dir.path().join("a/result.json")).unwrap();
    std::fs::write(dir.path().join("cut.json"), &whole[..3000]).unwrap();
    std::fs::write(dir.path().join("wrong.json"), "{\"format\": result}").unwrap();
    std::fs::create_dir(dir.path().join("bare")).unwrap();
    for (args, en, ru) in [
        (["cut.json", "--out", "c"], "was it truncated?", "не обрезан ли он?"),
        (["wrong.json", "--out", "c"], "invalid JSON at line 1", "неверный JSON в строке 1"),
        (["bare", "--out", "c"], "a folder without result.json", "папка без `result.json`"),
        (["a", "--out", "a"], "is not a comparison folder", "не является папкой сопоставления"),
    ] {
        for (lang, words) in [("en", en), ("ru", ru)] {
            let said = sagnac(dir.path(), &[&["compare"], &args[..], &["--lang", lang]].concat());
            assert_eq!(said.code, 2, "{args:?}: {said:?}");
            assert!(said.err.contains(words), "{args:?}: {}", said.err);
            assert!(!said.err.contains("EOF") && !said.err.contains("expected"), "{}", said.err);
        }
    }
    assert_eq!(std::fs::read(dir.path().join("a/result.json")).unwrap(), whole);
}

#[test]
fn the_same_recording_twice_is_told() {
    let dir = tempdir().unwrap();
    analyzed_once("pass").copy_to(&dir.path().join("a"));
    let (table, all) = compare(dir.path(), &["a", &sample("fail"), &sample("pass")]);
    let told: Vec<bool> = all["units"]
        .as_array()
        .unwrap()
        .iter()
        .map(|u| u["missing"].to_string().contains("compare.more.repeated"))
        .collect();
    assert_eq!(told, [false, false, true]);
    assert!(table.contains("Same recording as a"), "{table}");
}

#[test]
fn a_result_is_never_replaced_by_a_comparison_nor_the_other_way() {
    let dir = tempdir().unwrap();
    analyzed_once("pass").copy_to(&dir.path().join("a"));
    let said = sagnac(dir.path(), &["compare", "--published", "--out", "a"]);
    assert_eq!(said.code, 2, "{said:?}");
    assert!(dir.path().join("a/result.json").is_file());
    compare(dir.path(), &["--published"]);
    compare(dir.path(), &["--published"]);
    let said = sagnac(dir.path(), &["analyze", &sample("pass"), "--out", "c"]);
    assert_eq!(said.code, 2, "{said:?}");
    assert!(dir.path().join("c/comparison.json").is_file());
}

#[test]
fn the_published_tables_are_checked_in_both_languages() {
    let dir = tempdir().unwrap();
    let (said, all) = compare(dir.path(), &["--published"]);
    let rows = all["published"]["rows"].as_array().unwrap();
    let computed: Vec<f64> = rows.iter().map(|r| r["ratio"].as_f64().unwrap()).collect();
    for (computed, expected) in computed.iter().zip([8.0, 12.8, 12.73, 5.0, 6.25]) {
        assert!((computed - expected).abs() < 0.005, "{computed}");
    }
    assert!(said.contains("printed ratio 12 is inconsistent with the row: 5.00"), "{said}");
    assert!(said.contains("printed ratio 8 is inconsistent with the row: 6.25"), "{said}");
    let (russian, _) = compare(dir.path(), &["--published", "--lang", "ru"]);
    assert!(russian.contains("не следует из строки: 5,00"), "{russian}");
    let html = std::fs::read_to_string(dir.path().join("c/comparison.html")).unwrap();
    assert!(html.contains("<html lang=\"ru\">") && !html.contains("compare."), "a key shows");
}

#[test]
fn a_short_recording_has_no_drift_and_says_so() {
    let dir = tempdir().unwrap();
    let rows: String = (0..150).map(|i| format!("{i},{}\n", (i * 37 % 11) as f64 * 0.1)).collect();
    std::fs::write(dir.path().join("short.csv"), format!("time_s,rate_deg_h\n{rows}")).unwrap();
    let (said, all) = compare(dir.path(), &["short.csv"]);
    assert!(said.contains("fewer than two windows of 100 s"), "{said}");
    assert_eq!(all["units"][0]["name"], "short");
}

#[test]
fn the_guide_names_every_column_of_the_table() {
    let guide = std::fs::read_to_string(shipped("docs/guide/compare.md")).unwrap();
    let text = shared(&["compare", &sample("pass")], "c").text("comparison.csv");
    for column in text.lines().next().unwrap().split(',') {
        assert!(guide.contains(&format!("`{column}`")), "{column} is not in the guide");
    }
    assert!(root().join("docs/methods/comparison.md").is_file());
}

/// Rates of white noise of N = 0.002 deg/√h with something added, as a file.
fn written(folder: &Path, name: &str, interval_s: f64, rows: usize, more: impl Fn(f64) -> f64) {
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(41);
    let white = 60.0 * 0.002 / interval_s.sqrt();
    let mut text = "time_s,rate_deg_h\n".to_owned();
    for i in 0..rows {
        let t = i as f64 * interval_s;
        let noise: f64 = StandardNormal.sample(&mut rng);
        text.push_str(&format!("{t},{}\n", white * noise + more(t)));
    }
    std::fs::write(folder.join(name), text).unwrap();
}

#[test]
fn each_file_of_a_pattern_is_a_unit() {
    let dir = tempdir().unwrap();
    written(dir.path(), "u1.csv", 1.0, 1500, |_| 5.0);
    written(dir.path(), "u2.csv", 1.0, 1500, |_| -3.0);
    let (_, all) = compare(dir.path(), &["u*.csv"]);
    let names: Vec<&str> =
        all["units"].as_array().unwrap().iter().map(|u| u["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["u1", "u2"]);
    // Files of one name in two folders are told apart by their paths.
    std::fs::create_dir(dir.path().join("other")).unwrap();
    std::fs::copy(dir.path().join("u2.csv"), dir.path().join("other/u1.csv")).unwrap();
    let (_, all) = compare(dir.path(), &["u1.csv", "other/u1.csv", "u2.csv"]);
    let names: Vec<&str> =
        all["units"].as_array().unwrap().iter().map(|u| u["name"].as_str().unwrap()).collect();
    assert_eq!(names[1..], ["other/u1.csv", "u2"]);
}

#[test]
fn samples_that_make_no_windows_of_100_or_10_s_have_no_such_figure() {
    let dir = tempdir().unwrap();
    written(dir.path(), "slow.csv", 30.0, 1200, |_| 0.0);
    written(dir.path(), "twenty.csv", 20.0, 1200, |_| 0.0);
    let (said, all) = compare(dir.path(), &["slow.csv", "twenty.csv"]);
    let value = |unit: usize, id: &str| {
        let rows = all["units"][unit]["quantities"].as_array().unwrap();
        rows.iter().find(|q| q["id"] == id).unwrap()["value"].clone()
    };
    assert_eq!(value(0, "russian_arw_10s"), Value::Null);
    assert_eq!(value(0, "russian_drift_100s"), Value::Null);
    assert!(said.contains("slow: The record gives fewer than two means of 100 s"), "{said}");
    // Five samples of 20 s make 100 s.
    let drift = value(1, "russian_drift_100s").as_f64().unwrap();
    assert!((drift / 0.012 - 1.0).abs() < 0.15, "{drift}");
    assert_eq!(value(1, "russian_arw_10s"), Value::Null);
    assert!(said.contains("twenty: The record gives fewer than two means of 10 s"), "{said}");
}

#[test]
fn a_strong_line_is_one_line_and_explains_the_drift() {
    let dir = tempdir().unwrap();
    written(dir.path(), "line.csv", 1.0, 36_000, |t| (std::f64::consts::TAU * 0.0033 * t + 0.4).sin());
    let (_, all) = compare(dir.path(), &["line.csv"]);
    let model = &all["units"][0]["detail"]["model"];
    let lines = model["lines"].as_array().unwrap();
    assert_eq!(lines.len(), 1, "{model}");
    assert!((lines[0][0].as_f64().unwrap() - 1.0).abs() < 0.01, "{model}");
    assert!((lines[0][1].as_f64().unwrap() - 0.0033).abs() < 1e-6, "{model}");
    assert_eq!(field(dir.path(), 1, "agreement"), "consistent");
    assert_eq!(field(dir.path(), 1, "largest_part"), "line");
    let (low, high) = (number(dir.path(), 1, "n_low"), number(dir.path(), 1, "n_high"));
    assert!(low < 0.002 && 0.002 < high, "{low} {high}");
}

#[test]
fn an_output_rounded_far_above_its_noise_bounds_n_truly() {
    let dir = tempdir().unwrap();
    // An angle output of half an arcsecond: the noise moves it by two steps in a minute.
    let noise = tempdir().unwrap();
    written(noise.path(), "fine.csv", 0.1, 108_000, |_| 12.4832);
    let text = std::fs::read_to_string(noise.path().join("fine.csv")).unwrap();
    let (mut angle, mut before) = (0.0f64, 0.0f64);
    let mut rounded = "time_s,rate_deg_h\n".to_owned();
    for row in text.lines().skip(1) {
        let (time, rate) = row.split_once(',').unwrap();
        let rate: f64 = rate.parse().unwrap();
        angle += 0.1 * rate;
        let shown = (angle / 0.5).floor() * 0.5;
        rounded.push_str(&format!("{time},{}\n", (10.0 * (shown - before)).round()));
        before = shown;
    }
    std::fs::write(dir.path().join("coarse.csv"), rounded).unwrap();
    let (_, all) = compare(dir.path(), &["coarse.csv"]);
    let n = all["units"][0]["quantities"].as_array().unwrap().iter();
    let n = n.clone().find(|q| q["id"] == "angle_random_walk").unwrap().clone();
    let limit = n["upper_limit"]["value"].as_f64().or_else(|| n["interval"]["high"].as_f64()).unwrap();
    let low = n["interval"]["low"].as_f64().unwrap_or(0.0);
    assert!(low < 0.002 && 0.002 < limit && limit < 0.01, "{n}");
}

#[test]
fn faults_of_a_recording_and_a_model_that_fails_are_told() {
    let dir = tempdir().unwrap();
    written(dir.path(), "spikes.csv", 1.0, 7200, |t| if t == 2000.0 || t == 5000.0 { 150.0 } else { 0.0 });
    let (said, all) = compare(dir.path(), &["spikes.csv"]);
    assert!(said.contains("Faults of the recording: Outliers: 2."), "{said}");
    assert!(said.contains("consistent, indicative"), "{said}");
    assert_eq!(all["units"][0]["indicative"], true);
}

#[test]
fn a_crafted_comparison_writes_no_formula_for_a_spreadsheet() {
    let dir = tempdir().unwrap();
    let formula = "=HYPERLINK(\"https://example.org\",\"B\")";
    analyzed_once("pass").copy_to(&dir.path().join("a"));
    let mut crafted = json(&dir.path().join("a/result.json"));
    for window in crafted["comparison"][0]["windows"].as_array_mut().unwrap() {
        for share in window["shares"].as_array_mut().unwrap() {
            share["part"] = formula.into();
        }
    }
    std::fs::write(dir.path().join("a/result.json"), crafted.to_string()).unwrap();
    compare(dir.path(), &["a/result.json"]);
    let table = std::fs::read_to_string(dir.path().join("c/comparison.csv")).unwrap();
    assert!(table.contains("\"'=HYPERLINK(\"\"https"), "{table}");
    assert!(!table.contains(&format!(",{formula}")), "{table}");
}

#[test]
fn a_crafted_comparison_is_shown_whatever_count_of_digits_it_asks_for() {
    let dir = tempdir().unwrap();
    compare(dir.path(), &["--published"]);
    let at = dir.path().join("c/comparison.json");
    let crafted = std::fs::read_to_string(&at).unwrap().replace("\"digits\": 3", "\"digits\": 4000000000");
    let crafted = crafted.replace(
        "\"show\": {\n              \"factor\": {\n                \"figures\"",
        "\"show\": {\n              \"factor\": {\n                \"decimals\"",
    );
    assert!(crafted.contains("4000000000") && crafted.contains("\"decimals\""), "{crafted}");
    std::fs::write(&at, crafted).unwrap();
    let said = sagnac(dir.path(), &["report", "c/comparison.json", "--out", "p"]);
    assert_eq!(said.code, 0, "{said:?}");
}

#[test]
fn a_comparison_whose_rows_have_fewer_members_is_still_read() {
    let dir = tempdir().unwrap();
    let (_, mut all) = compare(dir.path(), &[tested_once("pass").path()]);
    for row in all["units"][0]["quantities"].as_array_mut().unwrap() {
        let members = ["id", "channel", "value", "unit", "interval", "upper_limit", "limit", "verdict"];
        row.as_object_mut().unwrap().retain(|name, _| members.contains(&name.as_str()));
        if let Some(limit) = row["limit"].as_object_mut() {
            limit.retain(|name, _| ["min", "max", "unit", "source"].contains(&name.as_str()));
        }
    }
    std::fs::write(dir.path().join("earlier.json"), all.to_string()).unwrap();
    let said = sagnac(dir.path(), &["report", "earlier.json", "--out", "p"]);
    assert_eq!(said.code, 0, "{said:?}");
    let page = |folder: &str| std::fs::read_to_string(dir.path().join(folder).join("comparison.md")).unwrap();
    assert_eq!(page("p"), page("c"));
    assert!(page("p").contains("sample-unit.toml"), "the limits of the rows are shown");
}
