//! The verb `explain`, as a user runs it.

mod clock;
mod columns;
pub mod in_run;
mod on_table;
pub mod several;
mod simulation;

use crate::support::shared::{SharedRun, shared, shared_input};
use crate::support::synthetic::white;
use crate::support::{root, sagnac, shipped};
use serde_json::Value;
use std::fmt::Write;
use std::path::Path;
use tempfile::tempdir;

/// N of the recordings, deg/√h; at 1 Hz a sample has 60·N.
const N: f64 = 0.01;
/// Where the step is, s.
const AT: usize = 1700;

const MODEL: &str = "[recording]\ncase = \"t\"\nsample_rate_hz = 1\n\
    [noise]\nN_deg_rt_h = 0.01\n[bias]\nvalue_deg_h = 5.0\n[uncertainty]\nN_rel = 0.02\nbias_deg_h = 0.1\n";

/// A recording of white noise with a step, and its model, in a folder.
fn case(folder: &Path, name: &str, seed: u64, step: f64) {
    with(folder, name, seed, |i| if i >= AT { step } else { 0.0 });
}

/// A recording of white noise and a course, and its model, in a folder.
fn with(folder: &Path, name: &str, seed: u64, course: impl Fn(usize) -> f64) {
    std::fs::write(folder.join(name), rows(seed, course)).unwrap();
    std::fs::write(folder.join("model.toml"), MODEL).unwrap();
}

/// The text of such a recording.
fn rows(seed: u64, course: impl Fn(usize) -> f64) -> String {
    let mut text = String::from("time_s,rate_deg_h,temp_degC\n");
    for i in 0..4000usize {
        let rate = 5.0 + 60.0 * N * white(seed, i as u64) + course(i);
        let temperature = 20.0 + (i as f64 / 900.0).sin() + 0.01 * white(seed + 1, i as u64);
        let _ = writeln!(text, "{i},{rate:.6},{temperature:.4}");
    }
    text
}

fn json(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
        .filter(|name| name != "figures")
        .collect();
    names.sort();
    names
}

/// The model of the recordings.
fn model() -> String {
    shared_input("explain-model.toml", || MODEL.to_owned())
}

/// A recording with a step, whose thermometer has a name of its own.
fn recording_with_a_step() -> String {
    shared_input("step.csv", || {
        rows(15, |i| if i >= AT { 0.2 } else { 0.0 }).replacen("temp_degC", "Housing [degC]", 1)
    })
}

/// That recording, explained.
pub fn step() -> &'static SharedRun {
    shared(&["explain", &recording_with_a_step(), "--model", &model()], "e")
}

#[test]
fn a_step_is_found_and_the_loop_closes() {
    let run = step();
    let (said, e) = (&run.said, &run.out);
    assert_eq!((said.code, said.err.as_str()), (1, ""), "{said:?}");
    assert!(said.out.starts_with("MISMATCH EXPLAINED  ") && said.out.contains("bias step"), "{}", said.out);
    let files = [
        "SHA256SUMS",
        "alternatives.toml",
        "augmented.toml",
        "correction.csv",
        "explain.json",
        "report.html",
        "report.md",
    ];
    assert_eq!(names(e), files);
    let all = json(&e.join("explain.json"));
    assert_eq!((all["format"].as_str(), all["verdict"].as_str()), (Some("explain/1"), Some("mismatch")));
    let first = &all["effects"][0];
    assert_eq!(first["kind"], "bias_step");
    let inside = |name: &str, truth: f64, slack: f64| {
        let ci = &first["parameters"][name]["ci95"];
        let (low, high) = (ci[0].as_f64().unwrap() - slack, ci[1].as_f64().unwrap() + slack);
        assert!(low <= truth && truth <= high, "{name}: {ci}");
    };
    // Wider than 95 %, for this is one recording.
    inside("step_deg_h", 0.2, 0.02);
    inside("time_s", AT as f64, 20.0);
    // The correction has a row for each row and jumps by the step.
    let correction = std::fs::read_to_string(e.join("correction.csv")).unwrap();
    let rows: Vec<f64> =
        correction.lines().skip(1).map(|l| l.split_once(',').unwrap().1.parse().unwrap()).collect();
    assert_eq!(rows.len(), 4000);
    assert!((rows[3999] - rows[0] - 0.2).abs() < 0.06);
    let page = std::fs::read_to_string(e.join("report.md")).unwrap();
    for link in page.split("](").skip(1).filter_map(|l| l.split_once(')')) {
        assert!(e.join(link.0).is_file(), "{} is linked and not there", link.0);
    }

    let (dir, augmented) = (tempdir().unwrap(), format!("{}/augmented.toml", run.path()));
    let args = ["explain", &recording_with_a_step(), "--model", &augmented, "--out", "f", "--lang", "ru"];
    let again = sagnac(dir.path(), &args);
    assert_eq!((again.code, again.err.as_str()), (0, ""), "{again:?}");
    assert!(again.out.starts_with("СОГЛАСУЕТСЯ  "), "{}", again.out);
}

#[test]
fn a_step_of_a_gyro_at_rest_is_no_change_of_heading() {
    let dir = tempdir().unwrap();
    case(dir.path(), "r.csv", 15, 0.2);
    let earth =
        MODEL.replace("[uncertainty]", "[earth]\nlatitude_deg = 55.0\nazimuth_deg = 30.0\n[uncertainty]");
    std::fs::write(dir.path().join("model.toml"), earth).unwrap();
    let said = sagnac(dir.path(), &["explain", "r.csv", "--model", "model.toml", "--out", "e"]);
    assert_eq!((said.code, said.err.as_str()), (1, ""), "{said:?}");
    let all = json(&dir.path().join("e/explain.json"));
    let first = &all["effects"][0];
    assert_eq!(first["kind"], "bias_step", "{first}");
    let probability = |kind: &str| first["probabilities"][kind].as_f64().unwrap_or(0.0);
    // The record says nothing between the two, and both are said.
    assert!(probability("bias_step") >= probability("heading_change"), "{first}");
    assert!(probability("heading_change") > 0.15, "{first}");
    assert!(first["equivalents"].as_array().unwrap().iter().any(|e| e == "heading_change"), "{first}");
}

#[test]
fn candidates_stand_by_what_they_are_worth_and_columns_under_their_own_names() {
    let run = step();
    let all = json(&run.out.join("explain.json"));
    let worth: Vec<f64> = all["candidates"]
        .as_array()
        .unwrap()
        .iter()
        .map(|c| c["delta_bic"].as_f64().unwrap_or(f64::NEG_INFINITY))
        .collect();
    assert!(worth.len() > 5 && worth.is_sorted_by(|a, b| a >= b), "{worth:?}");
    let column = &all["columns"][0];
    assert_eq!((&column["name"], &column["recorded_as"]), (&"temp_degC".into(), &"Housing [degC]".into()));
    for page in ["report.html", "report.md"] {
        let page = run.text(page);
        assert!(page.contains("Housing [degC]") && !page.contains("temp_degC"), "{page}");
    }
}

#[test]
fn a_level_that_leaves_and_returns_was_not_recorded() {
    let dir = tempdir().unwrap();
    with(dir.path(), "r.csv", 16, |i| if (1000..2200).contains(&i) { 0.4 } else { 0.0 });
    let said = sagnac(dir.path(), &["explain", "r.csv", "--model", "model.toml", "--out", "e"]);
    assert_eq!((said.code, said.err.as_str()), (1, ""), "{said:?}");
    let all = json(&dir.path().join("e/explain.json"));
    let effects = all["effects"].as_array().unwrap();
    assert_eq!((effects.len(), effects[0]["kind"].as_str()), (1, Some("unobserved_driver")), "{effects:?}");
    let place = &effects[0]["where"][0];
    let at = |end: &str, truth: f64| (place[end].as_f64().unwrap() - truth).abs() < 60.0;
    assert!(at("from", 1000.0) && at("to", 2200.0), "{place}");
    // 0.4 over 1200 of 4000 samples.
    let rms = &effects[0]["parameters"]["rms_deg_h"];
    let inside = |x: f64| rms["ci95"][0].as_f64().unwrap() < x && x < rms["ci95"][1].as_f64().unwrap();
    assert!(inside(0.4 * (0.3f64 * 0.7).sqrt()), "{rms}");
    let again = sagnac(dir.path(), &["explain", "r.csv", "--model", "e/augmented.toml", "--out", "again"]);
    assert_eq!(again.code, 0, "{again:?}");
    // Without that entry of the catalogue it is one cause still, and has no name.
    let less =
        ["explain", "r.csv", "--model", "model.toml", "--out", "less", "--without", "unobserved_driver"];
    assert_eq!(sagnac(dir.path(), &less).code, 3);
    let all = json(&dir.path().join("less/explain.json"));
    assert_eq!(all["effects"].as_array().map(|e| e.len()), Some(1), "{}", all["effects"]);
    assert_eq!(all["effects"][0]["kind"], "unknown");
}

#[test]
fn a_level_of_the_noise_that_was_explained_is_consistent() {
    let dir = tempdir().unwrap();
    let louder = |i: usize| if i < 2500 { 0.0 } else { 60.0 * N * 0.8 * white(99, i as u64) };
    with(dir.path(), "r.csv", 17, louder);
    let said = sagnac(dir.path(), &["explain", "r.csv", "--model", "model.toml", "--out", "e"]);
    assert_eq!(said.code, 1, "{said:?}");
    let all = json(&dir.path().join("e/explain.json"));
    assert_eq!(all["effects"][0]["kind"], "noise_variance_time");
    for (recording, consistent) in [("r.csv", true), ("quiet.csv", false)] {
        with(dir.path(), "quiet.csv", 18, |_| 0.0);
        let again =
            sagnac(dir.path(), &["explain", recording, "--model", "e/augmented.toml", "--out", "again"]);
        assert_eq!(again.code == 0, consistent, "{recording}: {again:?}");
    }
}

/// A filter of each form and seed is named, nothing beside it, and the loop closes.
fn filters_are_named_alone(forms: &[(u8, u8)]) {
    let dir = tempdir().unwrap();
    let claim = "[recording]\ncase = \"t\"\nsample_rate_hz = 20\n[noise]\nN_deg_rt_h = 0.0048\nB_deg_h = 0.0257\n\
        K_deg_h_rt_h = 0.144\n[bias]\nvalue_deg_h = 3.0\n[uncertainty]\nN_rel = 0.025\nB_rel = 0.13\nK_rel = 0.19\n\
        bias_deg_h = 0.11\n";
    std::fs::write(dir.path().join("model.toml"), claim).unwrap();
    for (form, seed) in forms {
        let filter = format!(
            "{claim}[[effect]]\nkind = \"bandwidth_filter\"\n[effect.parameters]\ncutoff_hz = 1.69\nform = {form}\n"
        );
        let seed = seed.to_string();
        std::fs::write(dir.path().join("filtered.toml"), filter).unwrap();
        let simulate = ["simulate", "filtered.toml", "--out", "r.csv", "--seed", &seed, "--duration", "500s"];
        assert_eq!(sagnac(dir.path(), &simulate).code, 0);
        let said = sagnac(dir.path(), &["explain", "r.csv", "--model", "model.toml", "--out", "e"]);
        let all = json(&dir.path().join("e/explain.json"));
        let kinds: Vec<_> = all["effects"].as_array().unwrap().iter().map(|e| &e["kind"]).collect();
        assert_eq!((said.code, kinds.len()), (1, 1), "form {form}: {kinds:?}");
        assert_eq!(kinds[0], "bandwidth_filter", "form {form}");
        let cutoff = all["effects"][0]["parameters"]["cutoff_hz"]["value"].as_f64().unwrap();
        assert!((cutoff / 1.69 - 1.0).abs() < 0.1, "form {form}: {cutoff}");
        let again =
            sagnac(dir.path(), &["explain", "r.csv", "--model", "e/augmented.toml", "--out", "again"]);
        assert_eq!(again.code, 0, "form {form}: {again:?}");
    }
}

#[test]
fn every_form_of_output_filter_is_named_alone() {
    let forms = [(2, 7), (5, 7), (1, 7), (3, 7), (6, 7)];
    filters_are_named_alone(&crate::support::long::cases(
        "every_form_of_output_filter_is_named_alone",
        &forms,
        2,
    ));
}

/// A moving average (4) and the second-order recursion (7) leave modes of which a record holds little but its ends.
#[test]
fn filters_that_hide_the_noise_before_them_are_named_alone() {
    let forms = [(4, 7), (7, 7), (4, 8), (7, 9)];
    let name = "filters_that_hide_the_noise_before_them_are_named_alone";
    filters_are_named_alone(&crate::support::long::cases(name, &forms, 1));
}

#[test]
fn slow_jumps_beside_flicker_are_told_from_a_slow_process() {
    let dir = tempdir().unwrap();
    let claim = "[recording]\ncase = \"jumps\"\nsample_rate_hz = 0.5\n[noise]\nN_deg_rt_h = 0.00061\nB_deg_h = 0.004\n\
        K_deg_h_rt_h = 0.0002\n[bias]\nvalue_deg_h = -11.3\n[uncertainty]\nN_rel = 0.01\nB_rel = 0.13\nK_rel = 0.2\n\
        bias_deg_h = 0.005\n";
    let jumps = format!(
        "{claim}[[effect]]\nkind = \"random_telegraph\"\n[effect.parameters]\namplitude_deg_h = 0.02\nmean_dwell_s = 5600\n"
    );
    std::fs::write(dir.path().join("model.toml"), claim).unwrap();
    std::fs::write(dir.path().join("jumps.toml"), jumps).unwrap();
    for seed in
        crate::support::long::cases("slow_jumps_beside_flicker_are_told_from_a_slow_process", &["1", "6"], 1)
    {
        let simulate = ["simulate", "jumps.toml", "--out", "r.csv", "--seed", seed, "--duration", "80000s"];
        assert_eq!(sagnac(dir.path(), &simulate).code, 0);
        let said = sagnac(dir.path(), &["explain", "r.csv", "--model", "model.toml", "--out", "e"]);
        assert_eq!(said.code, 1, "{said:?}");
        let effects = &json(&dir.path().join("e/explain.json"))["effects"];
        assert_eq!(effects.as_array().map(Vec::len), Some(1), "{effects}");
        assert_eq!(effects[0]["kind"], "random_telegraph", "seed {seed}");
        let found = |name: &str| effects[0]["parameters"][name]["value"].as_f64().unwrap();
        assert!((found("amplitude_deg_h") / 0.02 - 1.0).abs() < 0.15, "seed {seed}: {effects}");
        assert!((found("mean_dwell_s") / 5600.0).ln().abs() < 0.6, "seed {seed}: {effects}");
        let again =
            sagnac(dir.path(), &["explain", "r.csv", "--model", "e/augmented.toml", "--out", "again"]);
        assert_eq!(again.code, 0, "seed {seed}: {again:?}");
    }
}

#[test]
fn a_correct_claim_is_consistent_and_changes_nothing() {
    let dir = tempdir().unwrap();
    case(dir.path(), "r.csv", 21, 0.0);
    let args = ["explain", "r.csv", "--model", "model.toml", "--hide", "temp_degC", "--out", "e"];
    let said = sagnac(dir.path(), &args);
    assert_eq!((said.code, said.err.as_str()), (0, ""), "{said:?}");
    let e = dir.path().join("e");
    assert!(!e.join("correction.csv").exists(), "nothing was left out");
    let all = json(&e.join("explain.json"));
    assert_eq!(all["fit"]["baseline"], all["fit"]["augmented"]);
    assert_eq!(all["recording"]["hidden"][0], "temp_degC");
    assert_eq!(all["recording"]["columns"].as_array().unwrap().len(), 0);
}

#[test]
fn a_simulated_recording_stands_for_its_claim() {
    let dir = tempdir().unwrap();
    case(dir.path(), "sim.csv", 31, 0.0);
    case(dir.path(), "same.csv", 41, 0.0);
    case(dir.path(), "step.csv", 51, 0.2);
    for (name, code) in [("same.csv", 0), ("step.csv", 1)] {
        let said = sagnac(dir.path(), &["explain", name, "--simulation", "sim.csv", "--out", "e"]);
        assert_eq!((said.code, said.err.as_str()), (code, ""), "{name}: {said:?}");
    }
    let page = std::fs::read_to_string(dir.path().join("e/report.md")).unwrap();
    assert!(page.contains("identified from: sim.csv"), "{page}");
}

#[test]
fn a_part_of_a_recording_is_explained_alone() {
    let dir = tempdir().unwrap();
    case(dir.path(), "r.csv", 71, 0.2);
    let begin = ["explain", "r.csv", "--model", "model.toml", "--out", "e"];
    let explained = |part: &[&str]| sagnac(dir.path(), &[&begin, part].concat());
    assert_eq!(explained(&[]).code, 1);
    // The part before the step shows none. A result of another part is replaced only where that is asked for.
    let before = format!("{AT}s");
    let part = ["--from", "100s", "--to", before.as_str()];
    let refused = crate::support::sagnac_as_typed(dir.path(), &[begin.as_slice(), &part].concat(), &[]);
    assert_eq!(refused.code, 2, "{refused:?}");
    let said = explained(&[part.as_slice(), &["--force"]].concat());
    assert_eq!(said.code, 0, "{said:?}");
    let page = std::fs::read_to_string(dir.path().join("e/report.md")).unwrap();
    assert!(page.contains(&format!("Only the part from 100 s to {AT} s was used.")), "{page}");
    let said = explained(&["--from", "2h", "--force"]);
    assert!(said.code == 2 && said.err.contains("empty"), "{said:?}");
}

#[test]
fn what_cannot_be_run_says_why() {
    let dir = tempdir().unwrap();
    case(dir.path(), "r.csv", 61, 0.0);
    let mine = dir.path().join("mine");
    std::fs::create_dir(&mine).unwrap();
    std::fs::write(mine.join("thesis.txt"), "do not touch").unwrap();
    let refused = |args: &[&str], why: &str| {
        let said = sagnac(dir.path(), &[&["explain"], args].concat());
        assert_eq!(said.code, 2, "{args:?}");
        assert!(said.err.contains(why), "{args:?}: {}", said.err);
    };
    refused(&["r.csv"], "--model");
    refused(&["r.csv", "--model", "model.toml", "--simulation", "r.csv"], "--simulation");
    refused(&["none.csv", "--model", "model.toml", "--out", "e"], "none.csv");
    refused(&["r.csv", "--model", "none.toml", "--out", "e"], "none.toml");
    refused(&["r.csv", "--model", "model.toml", "--alpha", "0", "--out", "e"], "--alpha");
    refused(&["r.csv", "--model", "model.toml", "--max-effects", "0", "--out", "e"], "--max-effects");
    refused(
        &["r.csv", "--model", "model.toml", "--hide", "temp", "--out", "e"],
        "temp_degC, table_rate_deg_s",
    );
    refused(&["r.csv", "--model", "model.toml", "--out", "mine"], "not an explanation folder");
    let other = MODEL.replace("sample_rate_hz = 1", "sample_rate_hz = 10");
    std::fs::write(dir.path().join("other.toml"), other).unwrap();
    refused(&["r.csv", "--model", "other.toml", "--out", "e"], "10");
    assert!(!dir.path().join("e").exists(), "a run that failed leaves nothing");
    assert!(mine.join("thesis.txt").is_file());
}

#[test]
fn the_guide_names_every_option() {
    let guide = std::fs::read_to_string(shipped("docs/guide/explain.md")).unwrap();
    let help = sagnac(root(), &["explain", "--help", "--lang", "en"]).out;
    let own = help.split("How the recording is read").next().unwrap();
    let options: Vec<&str> = own
        .split_whitespace()
        .filter(|w| w.starts_with("--") && w.len() > 4)
        .map(|w| w.trim_end_matches([',', ')']))
        .filter(|w| !["--lang", "--help"].contains(w))
        .collect();
    assert!(options.len() >= 9, "{options:?}");
    for option in options {
        assert!(guide.contains(option), "{option} is not in the guide");
    }
}

#[test]
fn rounding_that_every_value_shows_is_named_where_the_spectrum_hardly_does() {
    let dir = tempdir().unwrap();
    let lsb = 0.217_3;
    let mut text = String::from("time_s,rate_deg_h\n");
    let (mut angle, mut before) = (0.0, 0.0);
    for i in 0..4000usize {
        angle += 5.0 + 60.0 * N * white(31, i as u64);
        let rounded = (angle / lsb).round() * lsb;
        let _ = writeln!(text, "{i},{:.7}", rounded - before);
        before = rounded;
    }
    std::fs::write(dir.path().join("r.csv"), text).unwrap();
    std::fs::write(dir.path().join("model.toml"), MODEL).unwrap();
    let said = sagnac(dir.path(), &["explain", "r.csv", "--model", "model.toml", "--out", "e"]);
    assert_eq!((said.code, said.err.as_str()), (1, ""), "{said:?}");
    let all = json(&dir.path().join("e/explain.json"));
    assert_eq!(all["effects"][0]["kind"], "quantization", "{all}");
    let ci = &all["effects"][0]["parameters"]["lsb_arcsec"]["ci95"];
    assert!(ci[0].as_f64().unwrap() <= lsb && lsb <= ci[1].as_f64().unwrap(), "{ci}");
    let again = sagnac(dir.path(), &["explain", "r.csv", "--model", "e/augmented.toml", "--out", "f"]);
    assert_eq!(again.code, 0, "{again:?}");
}

#[test]
fn samples_that_repeat_the_one_before_them_are_unknown_by_name_and_the_loop_closes() {
    let dir = tempdir().unwrap();
    case(dir.path(), "good.csv", 31, 0.0);
    let good = std::fs::read_to_string(dir.path().join("good.csv")).unwrap();
    let mut rows: Vec<Vec<&str>> = good.lines().map(|l| l.split(',').collect()).collect();
    for i in (2..rows.len()).filter(|i| (1000..3000).contains(i) && white(77, *i as u64) > 1.9) {
        rows[i][1] = rows[i - 1][1];
    }
    let text: String = rows.iter().map(|r| r.join(",") + "\n").collect();
    std::fs::write(dir.path().join("r.csv"), text).unwrap();
    let explain = |model: &str, out: &str| {
        let said = sagnac(dir.path(), &["explain", "r.csv", "--model", model, "--out", out]);
        (said.code, json(&dir.path().join(out).join("explain.json")), said.out)
    };
    let (code, all, out) = explain("model.toml", "e");
    assert_eq!(code, 3, "{out}");
    let [first] = all["effects"].as_array().unwrap().as_slice() else { panic!("{out}") };
    assert_eq!(
        (first["kind"].as_str(), first["effect"].as_str()),
        (Some("unknown"), Some("repeated_samples"))
    );
    let place = &first["where"][0];
    let (from, to) = (place["from"].as_f64().unwrap(), place["to"].as_f64().unwrap());
    assert!(place["domain"] == "time" && from > 995.0 && to < 3001.0 && to - from > 1500.0, "{place}");
    assert!(all["family_p_value"].as_f64().unwrap() < 1e-6, "{all}");
    let report = std::fs::read_to_string(dir.path().join("e/report.md")).unwrap();
    assert!(report.contains("Values equal to the previous one"), "{report}");
    assert_eq!(explain("e/augmented.toml", "again").0, 0);
}

#[test]
fn held_out_rms_can_be_computed_again_from_the_recording() {
    let dir = tempdir().unwrap();
    let ramp = |i: usize| 1.5e-4 * i as f64;
    with(dir.path(), "r.csv", 23, ramp);
    let said = sagnac(dir.path(), &["explain", "r.csv", "--model", "model.toml", "--out", "e"]);
    assert_eq!(said.code, 1, "{said:?}");
    let fit = json(&dir.path().join("e/explain.json"))["fit"].clone();
    let each = fit["heldout_tau_s"].as_f64().unwrap() as usize;
    let rate = |i: usize| 60.0 * N * white(23, i as u64) + ramp(i);
    let bins: Vec<f64> = (1..10)
        .step_by(2)
        .flat_map(|block| (0..400 / each).map(move |bin| 400 * block + each * bin))
        .map(|first| (first..first + each).map(rate).sum::<f64>() / each as f64)
        .collect();
    let mean = bins.iter().sum::<f64>() / bins.len() as f64;
    let rms = (bins.iter().map(|b| (b - mean).powi(2)).sum::<f64>() / bins.len() as f64).sqrt();
    let told = |side: &str| fit[side]["heldout_rms_deg_h"].as_f64().unwrap();
    assert!((told("baseline") / rms - 1.0).abs() < 1e-4, "{} {rms}", told("baseline"));
    assert!(told("augmented") < 0.97 * told("baseline"), "{fit}");
}

/// Tens of thousands of nats: noise that is fitted too large in its place looks filtered, and the ends of the record were drawn for
/// that filter without the effect, so that a step 14 rows before the end stood beside it.
#[test]
fn an_effect_many_times_the_noise_has_no_step_beside_it() {
    let dir = tempdir().unwrap();
    let name = "an_effect_many_times_the_noise_has_no_step_beside_it";
    for seed in crate::support::long::cases(name, &[41, 42, 43], 1) {
        let degrees = |i: usize| {
            let turn = std::f64::consts::TAU * i as f64;
            20.0 + 2.0 * (turn / 700.0).sin() + 0.5 * (turn / 180.0).sin()
        };
        let mut text = String::from("time_s,rate_deg_h,temp_degC\n");
        for i in 0..2000 {
            let rate = 5.0 + 60.0 * N * white(seed, i as u64) + 2.0 * (degrees(i) - 20.0);
            let _ = writeln!(text, "{i},{rate:.6},{:.5}", degrees(i));
        }
        std::fs::write(dir.path().join("r.csv"), text).unwrap();
        std::fs::write(dir.path().join("model.toml"), MODEL).unwrap();
        let out = format!("e{seed}");
        let said = sagnac(dir.path(), &["explain", "r.csv", "--model", "model.toml", "--out", &out]);
        assert_eq!((said.code, said.err.as_str()), (1, ""), "{said:?}");
        let all = json(&dir.path().join(out).join("explain.json"));
        let kinds: Vec<&str> =
            all["effects"].as_array().unwrap().iter().filter_map(|e| e["kind"].as_str()).collect();
        assert_eq!(kinds, ["temp_linear"], "{seed}: {all}");
    }
}
