//! `sagnac plan` as a user has it: from an ambiguous recording to a schedule, and to a recording of it that decides.

use crate::support::schema::validate;
use crate::support::shared::{SharedRun, shared, shared_input};
use crate::support::{Said, sagnac, sagnac_as_typed};
use sagnac_studies::planned::ambiguous::AMBIGUOUS;
use sagnac_studies::planned::carried_out;
use serde_json::Value;
use std::path::Path;
use tempfile::tempdir;

const MODEL: &str = "[recording]\ncase = \"unit\"\nsample_rate_hz = 0.2\n\
    columns = [\"time_s\", \"rate_deg_h\", \"temp_degC\"]\n\
    [noise]\nN_deg_rt_h = 0.002\nK_deg_h_rt_h = 0.0005\n[bias]\nvalue_deg_h = 1.0\n\
    [temperature]\ncoefficient_deg_h_per_degC = 0.01\nreference_degC = 20.0\n\
    [uncertainty]\nN_rel = 0.02\nK_rel = 0.2\nbias_deg_h = 0.1\n";

/// A single slow ramp.
const RAMP: &str =
    "[[driver]]\ncolumn = \"temp_degC\"\ntime_s = [0.0, 14400.0]\nvalue = [20.0, 40.0]\nnoise = 0.005\n";

/// The coefficient is larger than claimed.
const TRUTH: &str =
    "[[effect]]\nkind = \"temp_linear\"\n[effect.parameters]\ncoefficient_deg_h_per_degC = 0.016\n";

/// A recording of a single ramp in which a drift and a temperature coefficient are the same.
fn ramp() -> &'static str {
    let truth = shared_input("ramp-truth.toml", || format!("{MODEL}{TRUTH}{RAMP}"));
    shared(&["simulate", &truth, "--duration", "4h"], "r.csv").path()
}

/// What the recording is held against.
fn model() -> String {
    shared_input("ramp-model.toml", || MODEL.to_owned())
}

/// That recording explained.
fn ramp_explained() -> &'static SharedRun {
    shared(&["explain", ramp(), "--model", &model()], "e")
}

/// The test that tells its causes apart, planned.
pub fn ramp_planned() -> &'static SharedRun {
    shared(&["plan", ramp_explained().path(), "--model", &model(), "--budget", "8h"], "p")
}

fn json(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn planned(folder: &Path, explained: &str, more: &[&str]) -> Said {
    sagnac(folder, &[&["plan", explained, "--model", "model.toml", "--out", "p"], more].concat())
}

#[test]
fn a_drift_and_a_coefficient_are_planned_apart_and_the_planned_test_decides() {
    let explained = ramp_explained();
    assert_eq!(explained.said.code, 1, "{:?}", explained.said);
    let effects = json(&explained.out.join("explain.json"))["effects"].clone();
    let kinds = [effects[0]["kind"].clone(), effects[0]["equivalents"].clone()];
    let told = serde_json::to_string(&kinds).unwrap();
    assert!(told.contains("temp_linear") && told.contains("rate_ramp"), "{told}");
    let alternatives = explained.text("alternatives.toml");
    assert!(alternatives.contains("slope_deg_h_per_h"), "{alternatives}");

    let dir = tempdir().unwrap();
    std::fs::write(dir.path().join("model.toml"), MODEL).unwrap();
    std::fs::write(dir.path().join("truth.toml"), format!("{MODEL}{TRUTH}{RAMP}")).unwrap();
    let run = ramp_planned();
    let said = &run.said;
    assert_eq!((said.code, said.err.as_str()), (0, ""), "{said:?}");
    assert!(said.out.contains("DECIDES") && said.out.contains("separate"), "{}", said.out);
    let plan = json(&run.out.join("plan.json"));
    let schema: Value = serde_json::from_str(&sagnac(dir.path(), &["schema", "plan"]).out).unwrap();
    validate(&schema, &schema, &plan, "plan").unwrap();
    let schedule = &plan["schedule"];
    assert!(schedule["probability"].as_f64().unwrap() >= 0.95, "{schedule}");
    assert!(schedule["duration_h"].as_f64().unwrap() <= 8.0, "{schedule}");
    for file in ["report.html", "report.md", "schedule.toml"] {
        assert!(run.out.join(file).is_file(), "{file}");
    }

    // Carried out by the true unit, the test names the truth alone.
    let schedule = format!("{}/schedule.toml", run.path());
    let next = ["simulate", "truth.toml", "--schedule", &schedule, "--out", "n.csv", "--seed", "5"];
    let said = sagnac(dir.path(), &next);
    assert_eq!(said.code, 0, "{said:?}");
    let said = sagnac(dir.path(), &["explain", "n.csv", "--model", "model.toml", "--out", "n"]);
    assert_eq!(said.code, 1, "{said:?}");
    let effects = json(&dir.path().join("n/explain.json"))["effects"].clone();
    assert_eq!(effects.as_array().map(Vec::len), Some(1), "{effects}");
    assert_eq!(effects[0]["kind"], "temp_linear", "{effects}");
    assert_eq!(effects[0]["equivalents"], Value::Array(vec![]), "{effects}");

    // The page is rendered anew in another language, and the recording itself is as good as its explanation.
    let said = sagnac(dir.path(), &["report", run.path(), "--lang", "ru", "--out", "ru"]);
    assert_eq!(said.code, 0, "{said:?}");
    assert!(std::fs::read_to_string(dir.path().join("ru/report.md")).unwrap().contains("Следующий опыт"));
    let said = sagnac(
        dir.path(),
        &["plan", ramp(), "--model", "model.toml", "--budget", "8h", "--out", "direct", "--format", "json"],
    );
    assert_eq!(said.code, 0, "{said:?}");
    let direct: Value = serde_json::from_str(&said.out).unwrap();
    assert_eq!(direct["schedule"], plan["schedule"]);
}

#[test]
fn a_budget_that_is_too_small_and_a_missing_chamber_are_said() {
    let dir = tempdir().unwrap();
    std::fs::write(dir.path().join("model.toml"), MODEL).unwrap();
    let explained = ramp_explained().path();
    let said = planned(dir.path(), explained, &["--budget", "30min"]);
    assert_eq!(said.code, 3, "{said:?}");
    let outcome = json(&dir.path().join("p/plan.json"))["outcome"].clone();
    assert!(outcome == "too_short" || outcome == "undecidable", "{outcome}");
    let russian = [
        "plan",
        explained,
        "--model",
        "model.toml",
        "--out",
        "q",
        "--budget",
        "4h",
        "--no-chamber",
        "--lang",
        "ru",
    ];
    let said = sagnac(dir.path(), &russian);
    assert_eq!(said.code, 3, "{said:?}");
    assert!(said.out.contains("НЕ РАЗЛИЧИТЬ") || said.out.contains("МАЛО ВРЕМЕНИ"), "{}", said.out);
}

#[test]
fn nothing_to_tell_apart_is_said() {
    let dir = tempdir().unwrap();
    std::fs::write(dir.path().join("model.toml"), MODEL).unwrap();
    std::fs::write(dir.path().join("truth.toml"), format!("{MODEL}{RAMP}")).unwrap();
    sagnac(dir.path(), &["simulate", "truth.toml", "--duration", "3h", "--out", "r.csv"]);
    let said = sagnac(dir.path(), &["explain", "r.csv", "--model", "model.toml", "--out", "e"]);
    assert_eq!(said.code, 0, "{said:?}");
    assert!(!dir.path().join("e/alternatives.toml").exists());
    let said = planned(dir.path(), "e/explain.json", &["--budget", "2 d"]);
    assert_eq!((said.code, said.err.as_str()), (0, ""), "{said:?}");
    assert!(said.out.contains("nothing to tell apart"), "{}", said.out);
    assert!(!dir.path().join("p/schedule.toml").exists());
}

#[test]
fn what_cannot_be_planned_is_diagnosed() {
    let dir = tempdir().unwrap();
    std::fs::write(dir.path().join("model.toml"), MODEL).unwrap();
    ramp_explained().copy_to(&dir.path().join("e"));
    let refused = |args: &[&str], says: &str| {
        let all = [&["plan"], args, &["--model", "model.toml", "--out", "q"]].concat();
        let said = sagnac_as_typed(dir.path(), &all, &[]);
        assert_eq!(said.code, 2, "{args:?}: {said:?}");
        assert!(said.err.contains(says), "{args:?}: {}", said.err);
        assert!(!dir.path().join("q").exists(), "{args:?}");
    };
    refused(&["e", "--budget", "long"], "--budget");
    refused(&["e", "--budget", "8h", "--temperature-range", "60:10"], "LOW:HIGH");
    refused(&["e", "--budget", "8h", "--ramp-range", "0:60"], "--ramp-range");
    refused(&["e", "--budget", "8h", "--table-rates", "3;4"], "--table-rates");
    refused(&["missing.csv", "--budget", "8h"], "missing.csv");
    std::fs::write(
        dir.path().join("e/alternatives.toml"),
        "format = \"alternatives/1\"\n[[alternative]]\ncause = 0\n",
    )
    .unwrap();
    refused(&["e", "--budget", "8h"], "alternatives.toml:3");
    std::fs::remove_file(dir.path().join("e/alternatives.toml")).unwrap();
    refused(&["e", "--budget", "8h"], "alternatives.toml");
    let schedule = dir.path().join("s.toml");
    std::fs::write(&schedule, "format = \"schedule/1\"\n[[step]]\ndo = \"ramp\"\nto_degC = 5.0\n").unwrap();
    let simulate = |more: &[&str]| {
        let args = [&["simulate", "model.toml", "--schedule", "s.toml", "--out", "x.csv"], more].concat();
        sagnac_as_typed(dir.path(), &args, &[])
    };
    let said = simulate(&[]);
    assert!(
        said.code == 2 && said.err.contains("s.toml:3:6") && said.err.contains("rate_degC_per_h"),
        "{said:?}"
    );
    let said = simulate(&["--duration", "1h"]);
    assert!(said.code == 2 && said.err.contains("--schedule"), "{said:?}");
}

/// A short version of the study: two cases, few records, a fixed seed.
#[test]
fn planned_tests_name_the_truth_alone() {
    for name in ["bias_step or heading_change", "sf_error or sf_nonlinearity"] {
        let case = AMBIGUOUS.iter().find(|a| a.name == name).unwrap();
        let carried = carried_out(case, 6, 1).unwrap();
        assert!(carried.hours <= case.budget_h, "{name}: {} h", carried.hours);
        for truth in carried.truths {
            assert!(truth.decided >= 5, "{name}, {}: {} of 6", truth.kind, truth.decided);
        }
    }
}
