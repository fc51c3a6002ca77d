//! Switching off and on, and comparisons without and with an influence: the samples, the shipped procedures on them,
//! mistakes by their names, and intervals against simulated truth.
//!
//! `cargo test --release --test influence -- --ignored write_the_samples` writes the samples anew;
//! `cargo test --release --test influence -- --ignored long_study --nocapture` measures coverage (SAGNAC_RUNS=n,
//! SAGNAC_FIRST=seed, SAGNAC_ONLY=the beginning of an id).

mod influence_support;

use influence_support::{Noise, Recorded, Series, Turns, linear, squared};
use rayon::prelude::*;
use sagnac::estimate::Estimate;
use sagnac::influence::comparison::{self, Comparison};
use sagnac::influence::cut::FileSpan;
use sagnac::influence::repeatability::{self, Repeatability};
use sagnac::influence::{ComparisonTest, Influence, RepeatabilityTest, intervals, runs};
use sagnac::rate_table::blocks::{Blocks, Collector};
use sagnac::recording::{Channel, ColumnRef, Role, Sink, Slab};
use sagnac::units::Unit;
use serde_json::Value;
use std::fmt::Write;
use std::path::PathBuf;
use std::process::Command;

fn root(path: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(path)
}

const NOISE: Noise = Noise { n: 0.002, b: 0.001, k: 0.0003 };
const LEVEL: f64 = 12.467 + 0.12;

fn series(between: f64) -> Series {
    Series {
        runs: 8,
        run_s: 360.0,
        pause_s: 1200.0,
        between,
        trend: 0.0,
        per_deg_c: (0.0, 0.3),
        level: LEVEL,
        noise: NOISE,
        dt: 1.0,
    }
}

fn turns(levels: &[f64], per_unit: f64) -> Turns {
    Turns {
        levels: levels.to_vec(),
        interval_s: 120.0,
        bias: linear,
        per_unit,
        drift: 0.05,
        noisier: |_| 1.0,
        warms: 0.0,
        level: LEVEL,
        noise: NOISE,
        dt: 1.0,
    }
}

const FIELD: [f64; 9] = [0.0, 0.5, 0.0, -0.5, 0.0, 0.5, 0.0, -0.5, 0.0];
const SUPPLY: [f64; 9] = [5.0, 4.75, 5.0, 5.25, 5.0, 4.75, 5.0, 5.25, 5.0];
const SHAKER: [f64; 9] = [0.0, 2.0, 0.0, 4.0, 0.0, 2.0, 0.0, 4.0, 0.0];

fn shaken(per_unit: f64, noisier: fn(f64) -> f64) -> Turns {
    Turns { bias: squared, noisier, dt: 0.2, ..turns(&SHAKER, per_unit) }
}

fn text(serial: &str, level: &str, r: &Recorded) -> String {
    let mut out = format!("# serial: {serial}\ntime_s,rate_deg_h,temp_degC{level}\n");
    for i in 0..r.time_s.len() {
        let t = (r.time_s[i] * 10.0).round() / 10.0;
        let _ = write!(out, "{t},{:.4},{:.3}", r.rate[i], r.temperature[i]);
        if !level.is_empty() {
            let _ = write!(out, ",{}", r.level[i]);
        }
        out.push('\n');
    }
    out
}

/// Every sample with its text.
fn files() -> Vec<(&'static str, String)> {
    vec![
        ("bias-repeatability-pass", text("SN-0111", "", &series(0.02).record(111))),
        ("bias-repeatability-fail", text("SN-0112", "", &series(0.3).record(112))),
        ("magnetic-sensitivity-pass", text("SN-0113", ",field_mT", &turns(&FIELD, 0.05).record(113))),
        ("magnetic-sensitivity-fail", text("SN-0114", ",field_mT", &turns(&FIELD, 0.6).record(114))),
        ("supply-sensitivity-pass", text("SN-0115", ",supply_V", &turns(&SUPPLY, 0.02).record(115))),
        ("supply-sensitivity-fail", text("SN-0116", ",supply_V", &turns(&SUPPLY, -0.6).record(116))),
        ("vibration-pass", text("SN-0117", "", &shaken(0.001, |g| 1.0 + 0.05 * g).record(117))),
        ("vibration-fail", text("SN-0118", "", &shaken(0.02, |g| 1.0 + 0.3 * g).record(118))),
    ]
}

#[test]
#[ignore = "writes the samples"]
fn write_the_samples() {
    for (name, text) in files() {
        std::fs::write(root(&format!("samples/{name}.csv")), text).unwrap();
    }
}

#[test]
fn the_samples_are_what_the_generator_gives() {
    for (name, text) in files() {
        let stored = std::fs::read_to_string(root(&format!("samples/{name}.csv"))).unwrap();
        assert!(stored == text, "{name}");
    }
}

/// Runs a procedure on a recording; gives the exit code and the result.
fn run(procedure: &str, recording: &str, serial: &str) -> (i32, Value) {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("report");
    let done = Command::new(env!("CARGO_BIN_EXE_sagnac"))
        .args(["run", procedure, recording, "--serial", serial, "--out"])
        .arg(&out)
        .output()
        .unwrap();
    let text = std::fs::read_to_string(out.join("result.json"))
        .unwrap_or_else(|e| panic!("{e}: {}", String::from_utf8_lossy(&done.stderr)));
    for name in ["report.html", "report.md", "interval_means.csv"] {
        assert!(out.join(name).exists(), "{name}");
    }
    (done.status.code().unwrap(), serde_json::from_str(&text).unwrap())
}

fn path(name: &str) -> String {
    root(name).to_string_lossy().into_owned()
}

fn row<'a>(result: &'a Value, id: &str) -> &'a Value {
    let rows = result["measurands"].as_array().unwrap();
    rows.iter().find(|r| r["id"] == id).unwrap_or_else(|| panic!("{id}"))
}

/// The truth lies within the interval widened by half: of the few intervals here none may miss by more.
fn holds(result: &Value, id: &str, truth: f64) {
    let r = row(result, id);
    let end = |name: &str| r["interval"][name].as_f64().unwrap_or_else(|| panic!("{r}"));
    let (low, high) = (end("low"), end("high"));
    let half = 0.25 * (high - low);
    assert!((low - half..=high + half).contains(&truth), "{id}: {low} … {high}, truth {truth}");
}

#[test]
fn every_shipped_procedure_passes_one_sample_and_does_not_pass_another() {
    let names = ["bias-repeatability", "magnetic-sensitivity", "supply-sensitivity", "vibration"];
    for (i, name) in names.iter().enumerate() {
        let procedure = path(&format!("procedures/{name}.toml"));
        for (j, (end, code)) in [("pass", 0), ("fail", 1)].into_iter().enumerate() {
            let serial = format!("SN-{:04}", 111 + 2 * i + j);
            let (got, result) = run(&procedure, &path(&format!("samples/{name}-{end}.csv")), &serial);
            assert_eq!(got, code, "{name}-{end}: {:#} {:#}", result["summary"], result["measurands"]);
            match (*name, end) {
                ("bias-repeatability", _) if result["integrity"]["missing_samples"] != 0 => {
                    panic!("switching off is no gap: {}", result["integrity"])
                }
                ("bias-repeatability", "pass") => holds(&result, "bias_repeatability", 0.02),
                ("bias-repeatability", _) => holds(&result, "bias_repeatability", 0.3),
                ("magnetic-sensitivity", "pass") => holds(&result, "magnetic_sensitivity", 0.05),
                ("magnetic-sensitivity", _) => holds(&result, "magnetic_sensitivity", 0.6),
                ("supply-sensitivity", "pass") => holds(&result, "supply_sensitivity", 0.02),
                ("supply-sensitivity", _) => holds(&result, "supply_sensitivity", -0.6),
                (_, "pass") => {
                    holds(&result, "vibration_sensitivity", 0.001);
                    // N at 2 g is 1.1 times that at rest.
                    holds(&result, "angle_random_walk_shift", 0.1 * NOISE.n);
                }
                _ => holds(&result, "angle_random_walk_shift", 0.6 * NOISE.n),
            }
        }
    }
}

/// Ids of the sentences of the conditions that are not met.
fn invalid(result: &Value) -> Vec<String> {
    let list = result["conditions"].as_array().unwrap();
    let unmet = list.iter().filter(|c| c["status"] != "ok");
    unmet.map(|c| c["message"]["id"].as_str().unwrap().to_owned()).collect()
}

/// Runs a shipped procedure on a recording that is written for it.
fn on(procedure: &str, level: &str, recorded: &Recorded) -> (i32, Value) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("recording.csv");
    std::fs::write(&file, text("SN-1", level, recorded)).unwrap();
    run(&path(&format!("procedures/{procedure}.toml")), &file.to_string_lossy(), "SN-1")
}

#[test]
fn files_of_a_manifest_are_the_runs() {
    let folder = tempfile::tempdir().unwrap();
    let all = series(0.02).record(111);
    let each = all.time_s.len() / 8;
    let mut manifest = String::from("format = \"manifest/1\"\nserial = \"SN-1\"\n");
    for k in 0..8 {
        let part = |v: &[f64]| v[k * each..(k + 1) * each].to_vec();
        // Every file starts its own clock.
        let time_s = (0..each).map(|i| i as f64).collect();
        let r =
            Recorded { time_s, rate: part(&all.rate), temperature: part(&all.temperature), level: vec![] };
        std::fs::write(folder.path().join(format!("run{k}.csv")), text("SN-1", "", &r)).unwrap();
        let _ = write!(manifest, "\n[[file]]\npath = \"run{k}.csv\"\n");
    }
    let path_of = folder.path().join("manifest.toml");
    std::fs::write(&path_of, manifest).unwrap();
    let (code, result) = run(&path("procedures/bias-repeatability.toml"), &path_of.to_string_lossy(), "SN-1");
    assert_eq!(code, 0, "{:#}", result["summary"]);
    let means = result["interval_means"].as_array().unwrap();
    assert_eq!((means.len(), means[3]["name"].as_str()), (8, Some("run3.csv")));
    let (_, one) = run(
        &path("procedures/bias-repeatability.toml"),
        &path("samples/bias-repeatability-pass.csv"),
        "SN-0111",
    );
    for (a, b) in means.iter().zip(one["interval_means"].as_array().unwrap()) {
        let (a, b) = (a["mean_deg_h"].as_f64().unwrap(), b["mean_deg_h"].as_f64().unwrap());
        assert!((a - b).abs() < 0.004, "{a} {b}");
    }
}

#[test]
fn mistakes_name_themselves() {
    let says = |result: &Value, id: &str| {
        assert!(invalid(result).iter().any(|i| i == id), "{id}: {:?}", invalid(result))
    };
    let (code, few) = on("bias-repeatability", "", &Series { runs: 4, ..series(0.02) }.record(1));
    says(&few, "runs.too_few");
    assert_eq!(code, 3);
    let (code, one) =
        on("bias-repeatability", "", &Series { runs: 1, run_s: 3000.0, ..series(0.02) }.record(2));
    says(&one, "runs.one");
    assert_eq!(code, 3);

    let field = |levels: &[f64]| on("magnetic-sensitivity", ",field_mT", &turns(levels, 0.05).record(3)).1;
    says(&field(&[0.0; 9]), "compared.never_on");
    says(&field(&[0.5, -0.5, 0.5, -0.5, 0.5, -0.5, 0.5, -0.5]), "compared.never_off");
    says(&field(&[0.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.5, 0.5]), "compared.no_return");
    says(&field(&[0.0, 0.0, 0.0, 0.5, 0.5, 0.5, 0.0, 0.0, 0.0]), "compared.too_few");
    let warms = Turns { warms: 0.8, ..turns(&FIELD, 0.05) }.record(4);
    says(&on("magnetic-sensitivity", ",field_mT", &warms).1, "compared.with_temperature");

    // A bias that follows the level itself under vibration, and its square in a field.
    let bent = Turns { bias: linear, ..shaken(0.1, |_| 1.0) }.record(5);
    says(&on("vibration", "", &bent).1, "compared.off_square");
    let square = Turns { bias: squared, ..turns(&FIELD, 1.0) }.record(6);
    says(&on("magnetic-sensitivity", ",field_mT", &square).1, "compared.off_line");
}

/// The blocks of a recording, and its level beside.
fn blocks(r: &Recorded, dt: f64) -> Blocks {
    let roles = [Role::Rate, Role::Temperature, Role::MagneticField];
    let list: Vec<Channel> = roles
        .iter()
        .map(|role| Channel {
            id: role.id().into(),
            column: ColumnRef::Name(role.id().into()),
            role: *role,
            unit: Unit::parse(role.internal_unit().unwrap()).unwrap(),
            scale: 1.0,
        })
        .collect();
    let mut collector = Collector::new(&list, dt, None).beside(vec![2]);
    let mut start = 0;
    for i in 1..=r.time_s.len() {
        if i < r.time_s.len() && r.time_s[i] - r.time_s[i - 1] < 1.5 * dt {
            continue;
        }
        let level = if r.level.is_empty() { vec![0.0; i - start] } else { r.level[start..i].to_vec() };
        let values = [r.rate[start..i].to_vec(), r.temperature[start..i].to_vec(), level];
        let first_index = (r.time_s[start] / dt).round() as u64;
        collector.push(&Slab {
            first_index,
            first_row: start as u64 + 1,
            time_s: r.time_s[start],
            continues: false,
            values: &values,
        });
        start = i;
    }
    collector.finish(dt)
}

fn repeated(s: &Series, seed: u64) -> Repeatability {
    let blocks = blocks(&s.record(seed), s.dt);
    let test = RepeatabilityTest {
        settling_s: 10.0,
        minimum_run_s: 60.0,
        off_s: 60.0,
        fewest: 6,
        temperature: None,
        runs: vec![],
    };
    let files: [FileSpan; 0] = [];
    repeatability::evaluate(&blocks, &runs::find(&blocks, &test, &files), 0, 0.0).expect("runs")
}

fn compared(t: &Turns, seed: u64) -> Comparison {
    let blocks = blocks(&t.record(seed), t.dt);
    let test = ComparisonTest {
        influence: if t.levels == SHAKER { Influence::Vibration } else { Influence::MagneticField },
        reference: t.levels[0],
        settling_s: 0.0,
        minimum_interval_s: 10.0,
        alternations: 2,
        level_uncertainty: 0.0,
        temperature_difference_deg_c: 0.3,
        temperature: None,
        intervals: vec![],
    };
    let found = intervals::find(&blocks, &test, &["field".to_owned()], &[]);
    comparison::evaluate(&blocks, &found, &test, 0).expect("intervals")
}

/// What a study of one measurand counts.
#[derive(Default)]
struct Count {
    runs: usize,
    held: usize,
    errors: Vec<f64>,
    widths: Vec<f64>,
}

impl Count {
    fn take(&mut self, e: &Estimate, truth: f64) {
        self.runs += 1;
        match (e.value, e.upper_limit) {
            (Some(value), _) => {
                let i = e.interval95().expect("an interval");
                self.held += usize::from(i.low <= truth && truth <= i.high);
                self.errors.push(value - truth);
                self.widths.push(i.high - i.low);
            }
            (None, Some(limit)) => self.held += usize::from(truth <= limit.value),
            _ => {}
        }
    }

    fn coverage(&self) -> f64 {
        self.held as f64 / self.runs as f64
    }

    fn say(&self, name: &str, truth: f64) -> String {
        let n = self.errors.len().max(1) as f64;
        let mean = self.errors.iter().sum::<f64>() / n;
        let rms = (self.errors.iter().map(|e| e * e).sum::<f64>() / n).sqrt();
        let mut widths = self.widths.clone();
        widths.sort_by(f64::total_cmp);
        let width = widths.get(widths.len() / 2).copied().unwrap_or(f64::NAN);
        format!(
            "{name}: truth {truth:.4}, {} runs, {} with a value, coverage {:.3}, mean error {mean:.5}, rms {rms:.5}, median width {width:.5}",
            self.runs,
            self.errors.len(),
            self.coverage()
        )
    }
}

/// Noise that the studies go through: white, with flicker, with flicker and random walk.
const KINDS: [(&str, Noise); 3] = [
    ("white", Noise { n: 0.002, b: 0.0, k: 0.0 }),
    ("flicker", Noise { n: 0.002, b: 0.006, k: 0.0 }),
    ("walk", Noise { n: 0.002, b: 0.003, k: 0.02 }),
];

/// A random walk that goes on while the unit is off differs from switching on by nothing that runs of minutes show: the
/// repeatability is studied without it.
fn study(records: u64, seed: u64, scatters: &[f64], only: &str) -> Vec<(String, Count, f64)> {
    let mut out = Vec::new();
    for (kind, noise) in KINDS {
        let repeated_too = noise.k == 0.0 && "bias_repeatability".starts_with(only);
        for between in scatters.iter().copied().filter(|_| repeated_too) {
            let s = Series { noise, trend: 0.0, dt: 2.0, ..series(between) };
            let (mut deviation, mut trend) = (Count::default(), Count::default());
            let series: Vec<_> = (0..records).into_par_iter().map(|r| repeated(&s, seed + r)).collect();
            for found in series {
                deviation.take(&found.estimate("bias_repeatability", "deg/h").unwrap(), between);
                trend.take(&found.estimate("bias_repeatability_trend", "deg/h").unwrap(), 0.0);
            }
            out.push((format!("bias_repeatability {kind}"), deviation, between));
            out.push((format!("bias_repeatability_trend {kind} {between}"), trend, 0.0));
        }
        let louder: fn(f64) -> f64 = |g| 1.0 + 0.3 * g.abs();
        let cases = [
            ("magnetic_sensitivity", Turns { noise, dt: 2.0, ..turns(&FIELD, 0.1) }, 0.1),
            ("vibration_sensitivity", Turns { noise, dt: 2.0, ..shaken(0.004, louder) }, 0.004),
        ];
        for (id, turns, truth) in cases.into_iter().filter(|c| c.0.starts_with(only)) {
            let (mut unit, mut shift) = (Count::default(), Count::default());
            let tests: Vec<_> =
                (0..records).into_par_iter().map(|r| compared(&turns, seed + 10_000 + r)).collect();
            for found in tests {
                unit.take(&found.estimates(id, "deg/h")[0], truth);
                let (at, s) = (&found.estimates("bias_shift", "deg/h")[0], &found.shifts[0]);
                shift.take(at, (turns.bias)(turns.per_unit, s.level));
            }
            out.push((format!("{id} {kind}"), unit, truth));
            out.push((format!("bias_shift {id} {kind}"), shift, f64::NAN));
        }
    }
    out
}

#[test]
fn intervals_hold_the_truth() {
    // Of 16 runs at 95 %, fewer than 12 come about less than once in 1000.
    for (name, count, truth) in study(16, 500_000, &[0.03], "") {
        assert!(count.coverage() >= 12.0 / 16.0, "{}", count.say(&name, truth));
    }
}

/// Tests of which the levels are said to be off the line that they lie on, by kind of noise and influence.
fn said_to_be_off(records: u64, seed: u64) -> Vec<(&'static str, &'static str, u64)> {
    let louder: fn(f64) -> f64 = |g| 1.0 + 0.3 * g.abs();
    let mut out = Vec::new();
    for (kind, noise) in KINDS {
        let cases = [
            ("field", Turns { noise, dt: 2.0, ..turns(&FIELD, 0.1) }),
            ("vibration", Turns { noise, dt: 2.0, ..shaken(0.004, louder) }),
        ];
        for (id, turns) in cases {
            let off = |r: &u64| compared(&turns, seed + r).line.expect("two levels") < 0.01;
            out.push((kind, id, (0..records).into_par_iter().filter(off).count() as u64));
        }
    }
    out
}

#[test]
fn levels_on_a_line_are_not_said_to_be_off_it() {
    // Of 40 at one in a hundred, four come about once in 1000.
    for (kind, id, off) in said_to_be_off(40, 530_000) {
        assert!(off < 4, "{kind} {id}: {off}");
    }
}

#[test]
#[ignore = "SAGNAC_RUNS=n cargo test --release --test influence -- --ignored --nocapture long_study_of_lines"]
fn long_study_of_lines() {
    let runs = std::env::var("SAGNAC_RUNS").ok().and_then(|n| n.parse().ok()).unwrap_or(1000);
    for (kind, id, off) in said_to_be_off(runs, 910_000) {
        println!("{id}, {kind}: {off} of {runs} said to be off the line");
    }
}

#[test]
#[ignore = "a long study"]
fn long_study() {
    let asked =
        |name: &str, otherwise| std::env::var(name).ok().and_then(|n| n.parse().ok()).unwrap_or(otherwise);
    let (records, first) = (asked("SAGNAC_RUNS", 1000), asked("SAGNAC_FIRST", 900_000));
    let only = std::env::var("SAGNAC_ONLY").unwrap_or_default();
    for (name, count, truth) in study(records, first, &[0.005, 0.02, 0.1], &only) {
        println!("{}", count.say(&name, truth));
    }
}

#[test]
fn the_temperature_of_runs_and_a_trend_are_found() {
    let s = Series { per_deg_c: (0.2, 0.3), trend: 0.0, ..series(0.005) };
    let found = repeated(&s, 77);
    let t = found.temperature.as_ref().expect("temperatures");
    assert!((t.slope.value - 0.2).abs() < 4.0 * t.slope.standard && t.share > 0.8, "{t:?}");
    let s = Series { trend: 0.3, per_deg_c: (0.0, 0.3), ..series(0.01) };
    let trend = repeated(&s, 78).trend.expect("a line");
    assert!(
        (trend.value - 0.3).abs() < 4.0 * trend.standard && trend.value > 5.0 * trend.standard,
        "{trend:?}"
    );
}
