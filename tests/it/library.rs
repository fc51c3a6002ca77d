//! The library as a Rust program uses it. The examples are compiled and run here.

use sagnac::estimate::Verdict;
use sagnac::export::{Csv, Html, Json, Markdown, Svg};
use sagnac::mismatch::finding::MismatchVerdict;
use sagnac::{Lang, Model, Procedure, Rate, Recording, RunResult, UnitUnderTest};
use std::fs;
use std::path::Path;

#[path = "../../examples/explain.rs"]
mod explain_example;
#[path = "../../examples/noise.rs"]
mod noise_example;
#[path = "../../examples/own_measurand.rs"]
mod own_measurand_example;
#[path = "../../examples/run.rs"]
mod run_example;
#[path = "../../examples/russian_report.rs"]
mod russian_report_example;

#[test]
fn the_noise_example_runs() {
    noise_example::main().unwrap();
}

#[test]
fn the_run_example_runs_and_writes_its_record() {
    run_example::main().unwrap();
    let json = fs::read_to_string("target/example-run/result.json").unwrap();
    let record: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!((&record["verdict"], &record["session"]["operator"]), (&"fail".into(), &"A. Ivanova".into()));
    assert!(Path::new("target/example-run/sigma_tau.csv").exists());
}

#[test]
fn the_russian_example_writes_a_russian_report_with_its_figures() {
    russian_report_example::main().unwrap();
    let page = fs::read_to_string("target/example-russian/report.md").unwrap();
    assert!(page.contains("ВОГ-1") && page.contains("ГОДЕН"), "{page}");
    assert!(fs::read_dir("target/example-russian/figures").unwrap().count() > 1);
    assert!(fs::read_to_string("target/example-russian/report.html").unwrap().contains("<svg"));
}

#[test]
fn the_explain_example_runs_and_names_the_step() {
    explain_example::main().unwrap();
    let recording = Model::load("samples/model-step.toml").unwrap().simulate(7).unwrap();
    let why = sagnac::explain(&recording, &Model::load("samples/model-static.toml").unwrap()).unwrap();
    assert_eq!(why.verdict(), MismatchVerdict::Mismatch);
    assert_eq!(why.effects()[0].kind, "bias_step");
    assert!(why.augmented().to_toml().contains("bias_step"));
    let folder = tempfile::tempdir().unwrap();
    why.write(folder.path(), &[&Html, &Markdown, &Json, &Csv, &Svg], Lang::Ru).unwrap();
    for name in ["report.html", "report.md", "explain.json", "correction.csv", "figures"] {
        assert!(folder.path().join(name).exists(), "{name}");
    }
}

#[test]
fn the_example_of_an_own_measurand_runs() {
    own_measurand_example::main().unwrap();
}

#[test]
fn noise_of_a_rate_is_what_a_run_reports_of_it() {
    let recording = Recording::open("samples/unit-indeterminate.csv").unwrap();
    let noise = sagnac::noise::identify(&recording.rate("rate_deg_h").unwrap()).unwrap();
    let unit = UnitUnderTest::with_serial("SN-0001");
    let procedure = Procedure::load("procedures/static-bias.toml").unwrap();
    let run = procedure.run(&recording, &unit).unwrap();
    // The procedure leaves a warm-up out, the rate holds all of it: values agree within their intervals.
    let row = run.measurand("angle_random_walk").unwrap();
    let n = noise.term("angle_random_walk").unwrap().interval95().unwrap();
    assert!(n.low < row.value.unwrap() && row.value.unwrap() < n.high, "{n:?} {row:?}");
}

#[test]
fn columns_in_memory_give_what_their_file_gives() {
    let file = Recording::open("samples/unit-indeterminate.csv").unwrap();
    let text = fs::read_to_string("samples/unit-indeterminate.csv").unwrap();
    let rows = || text.lines().filter(|l| !l.starts_with('#')).skip(1);
    let column = |i: usize| rows().map(|l| l.split(',').nth(i).unwrap().parse().unwrap()).collect();
    let memory =
        Recording::from_columns([("time_s", column(0)), ("rate_deg_h", column(1)), ("temp_degC", column(2))])
            .unwrap();
    assert_eq!(file.rate("rate_deg_h").unwrap(), memory.rate("2").map(|r| r.named("rate_deg_h")).unwrap());
    let run = |recording: &Recording| {
        let procedure = Procedure::load("procedures/static-bias.toml").unwrap();
        let run = procedure.run(recording, &UnitUnderTest::with_serial("SN-0001")).unwrap();
        run.record().measurands.clone()
    };
    // Sums run over blocks of another length: the last digits differ.
    let (file, memory) = (run(&file), run(&memory));
    assert!(file.len() > 10 && file.len() == memory.len());
    for (a, b) in file.iter().zip(&memory) {
        assert_eq!((&a.id, a.value.is_some(), a.verdict), (&b.id, b.value.is_some(), b.verdict));
        let (x, y) = (a.value.unwrap_or_default(), b.value.unwrap_or_default());
        assert!((x - y).abs() <= 1e-9 * x.abs(), "{}: {x} {y}", a.id);
    }
}

#[test]
fn errors_say_what_they_are_about() {
    let none = Recording::open("no-such-file.csv").err().unwrap();
    assert!(none.is_recording() && !none.is_argument(), "{none}");
    assert!(none.to_string().contains("no-such-file.csv"), "{none}");
    assert_ne!(none.localized(Lang::Ru), none.to_string());
    let pattern = Recording::open("samples/unit-*.csv").err().unwrap();
    assert!(pattern.is_argument() && pattern.to_string().contains("open_with"), "{pattern}");
    let recording = Recording::from_columns([("x", vec![1.0; 100])]).unwrap();
    assert!(recording.rate("x").unwrap_err().is_argument());
    assert!(recording.rate("y").unwrap_err().is_recording());
    let unit = recording.with_sample_rate(10.0).rate_in("x", "deg/parsec").unwrap_err();
    assert!(unit.is_argument(), "{unit}");
    assert!(Recording::from_columns([("x", vec![1.0]), ("y", vec![])]).err().unwrap().is_recording());
    assert!(Rate::from_samples(vec![], 0.0).unwrap_err().is_argument());
    assert!(
        sagnac::noise::identify(&Rate::from_samples(vec![f64::NAN; 9], 1.0).unwrap())
            .err()
            .unwrap()
            .is_argument()
    );
    let limits = Procedure::load("procedures/limits/sample-unit.toml").err().unwrap();
    assert!(limits.is_configuration(), "{limits}");
    // Shorter than the warm-up that the procedure excludes.
    let time_s: Vec<f64> = (0..100).map(f64::from).collect();
    let rate: Vec<f64> = time_s.iter().map(|t| 12.5 + 0.01 * (t * t).sin()).collect();
    let temp = vec![20.0; 100];
    let short =
        Recording::from_columns([("time_s", time_s), ("rate_deg_h", rate), ("temp_degC", temp)]).unwrap();
    let run = Procedure::load("procedures/static-bias.toml").unwrap().run(&short, &UnitUnderTest::default());
    let run = run.err().unwrap();
    assert!(run.is_not_evaluable(), "{run}");
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("taken"), "").unwrap();
    let result = Procedure::load("procedures/scale-factor.toml")
        .unwrap()
        .run(&Recording::open("samples/scale-factor-pass.csv").unwrap(), &UnitUnderTest::with_serial("SN-1"))
        .unwrap();
    assert_eq!(result.verdict(), Verdict::Pass);
    let refused = result.write(folder.path().join("taken"), &[&Json], Lang::En).unwrap_err();
    assert!(refused.is_output() && std::error::Error::source(&refused).is_some(), "{refused}");
}

/// The files of a folder with their contents.
fn files(folder: &Path) -> std::collections::BTreeMap<String, Vec<u8>> {
    let mut found = std::collections::BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()) {
        let name = entry.file_name().unwrap().to_string_lossy().into_owned();
        if entry.is_dir() {
            found.extend(files(&entry).into_iter().map(|(below, bytes)| (format!("{name}/{below}"), bytes)));
        } else {
            found.insert(name, fs::read(&entry).unwrap());
        }
    }
    found
}

#[test]
fn a_result_that_is_read_back_is_written_as_the_run_writes_it_in_any_language() {
    let all: &[&dyn sagnac::export::Exporter] = sagnac::export::EXPORTERS;
    for (procedure, sample) in [
        ("static-bias", "unit-faults"),
        ("temperature-ramp", "temperature-pass"),
        ("scale-factor", "scale-factor-pass"),
        ("vibration", "vibration-fail"),
    ] {
        let run = Procedure::load(format!("procedures/{procedure}.toml"))
            .unwrap()
            .run(
                &Recording::open(format!("samples/{sample}.csv")).unwrap(),
                &UnitUnderTest::with_serial("SN-1"),
            )
            .unwrap();
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        run.write(at("en"), all, Lang::En).unwrap();
        run.write(at("ru"), all, Lang::Ru).unwrap();
        let read = RunResult::open(at("en")).unwrap();
        for (lang, name) in [(Lang::En, "en"), (Lang::Ru, "ru")] {
            read.write(at("again"), all, lang).unwrap();
            let (first, again) = (files(&at(name)), files(&at("again")));
            assert_eq!(first.keys().collect::<Vec<_>>(), again.keys().collect::<Vec<_>>(), "{sample} {name}");
            let differ: Vec<&String> = first.keys().filter(|k| first[*k] != again[*k]).collect();
            assert!(differ.is_empty(), "{sample} {name}: {differ:?}");
            // A misalignment has no figure.
            assert_eq!(
                first.contains_key("figures/data.json"),
                procedure != "misalignment",
                "{:?}",
                first.keys()
            );
            assert!(first.len() >= 4, "{:?}", first.keys());
        }
    }
}

#[test]
fn an_analysis_in_the_library_is_that_of_the_program() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    assert_cmd::Command::cargo_bin("sagnac")
        .unwrap()
        .args(["analyze", "samples/unit-indeterminate.csv", "--out"])
        .arg(&out)
        .assert()
        .code(0);
    let program: serde_json::Value =
        serde_json::from_slice(&fs::read(out.join("result.json")).unwrap()).unwrap();
    let result =
        sagnac::Analysis::default().run(&Recording::open("samples/unit-indeterminate.csv").unwrap()).unwrap();
    let library = serde_json::to_value(result.record()).unwrap();
    for part in ["measurands", "recording", "integrity", "window", "conditions"] {
        assert_eq!(program[part], library[part], "{part}");
    }
    assert!(library["measurands"].as_array().is_some_and(|m| m.len() > 5));
}

#[test]
fn deviations_in_memory_are_those_of_the_analysis() {
    let recording = Recording::open("samples/unit-indeterminate.csv").unwrap();
    let rate = recording.rate("rate_deg_h").unwrap();
    let plan = sagnac::noise::AllanPlan::default();
    let mut seen = 0;
    let curves =
        sagnac::noise::allan(&rate.deg_h().to_vec(), rate.sample_interval_s(), &plan, &mut |n, _| seen = n);
    let curves = curves.unwrap();
    let noise = sagnac::noise::identify(&rate).unwrap();
    let (allan, identified) = (&curves[0].points, noise.allan());
    assert_eq!(seen, rate.deg_h().len() as u64);
    assert_eq!(
        allan.iter().map(|p| (p.point.m, p.point.deviation.to_bits())).collect::<Vec<_>>(),
        identified.iter().map(|p| (p.point.m, p.point.deviation.to_bits())).collect::<Vec<_>>()
    );
    assert!(
        allan
            .iter()
            .all(|p| p.interval95.is_some_and(|i| i.low < p.point.deviation && p.point.deviation < i.high))
    );
}

#[test]
fn a_value_that_is_no_number_splits_the_record_of_the_deviations() {
    let mut samples: Vec<f64> = (0..2000).map(|i| f64::from(i % 7)).collect();
    samples[1000] = f64::NAN;
    let plan = sagnac::noise::AllanPlan::default();
    let curves = sagnac::noise::allan(&samples, 1.0, &plan, &mut |_, _| {}).unwrap();
    let terms: Vec<(u64, u64)> =
        curves[0].points.iter().take(2).map(|p| (p.point.m, p.point.terms)).collect();
    // Stretches of 1000 and 999 samples: 999 + 998 terms of neighbours, 997 + 996 of pairs.
    assert_eq!(terms, [(1, 1997), (2, 1993)]);
    assert!(
        sagnac::noise::allan(&vec![f64::NAN; 9], 1.0, &plan, &mut |_, _| {}).err().unwrap().is_argument()
    );
    assert!(sagnac::noise::allan(&samples, 0.0, &plan, &mut |_, _| {}).err().unwrap().is_argument());
}
