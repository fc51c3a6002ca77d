//! `explain --simulation`: a simulation is a draw, and what it does not resolve it does not state.

use crate::support::long;
use crate::support::sagnac;
use crate::support::synthetic::white;
use serde_json::Value;
use std::f64::consts::TAU;
use std::fmt::Write;
use std::path::Path;
use tempfile::tempdir;

/// Rows of a recording at 1 Hz.
const ROWS: usize = 4000;
/// White noise of a sample, deg/h: N = 0.01 deg/√h.
const SIGMA: f64 = 0.6;

/// Writes a rate, and a temperature where there is one.
fn put(path: &Path, rate: &[f64], temperature: Option<&[f64]>, keep: impl Fn(usize) -> bool) {
    let mut text = String::from(if temperature.is_some() {
        "time_s,rate_deg_h,temp_degC\n"
    } else {
        "time_s,rate_deg_h\n"
    });
    for (i, rate) in rate.iter().enumerate().filter(|(i, _)| keep(*i)) {
        let _ = write!(text, "{i},{rate:.7}");
        if let Some(t) = temperature {
            let _ = write!(text, ",{:.5}", t[i]);
        }
        text.push('\n');
    }
    std::fs::write(path, text).unwrap();
}

fn noise(seed: u64) -> Vec<f64> {
    (0..ROWS).map(|i| 5.0 + SIGMA * white(seed, i as u64)).collect()
}

/// A Gauss-Markov process on a rate.
fn wander(rate: &mut [f64], seed: u64, tau: f64, sigma: f64) {
    let keep = (-1.0 / tau).exp();
    let mut level = sigma * white(seed, 0);
    for (i, rate) in rate.iter_mut().enumerate() {
        *rate += level;
        level = keep * level + sigma * (1.0 - keep * keep).sqrt() * white(seed, i as u64 + 1);
    }
}

/// The kinds of process that one seed makes a draw of.
const PROCESSES: [&str; 6] = ["line", "filter", "walk", "wander", "rounded", "gaps"];

fn draw(process: &str, path: &Path, seed: u64) {
    let mut rate = noise(seed);
    match process {
        "line" => {
            let phase = white(seed + 500, 1);
            rate.iter_mut()
                .enumerate()
                .for_each(|(i, r)| *r += 0.2 * (TAU * 0.0731 * i as f64 + phase).cos());
        }
        "filter" => {
            let pass = 1.0 - (-TAU * 0.1f64).exp();
            let mut out = rate[0];
            for r in &mut rate {
                out += pass * (*r - out);
                *r = out;
            }
        }
        "walk" => {
            let mut level = 0.0;
            for (i, r) in rate.iter_mut().enumerate() {
                level += 0.3 / 60.0 * white(seed + 700, i as u64);
                *r += level;
            }
        }
        "wander" => wander(&mut rate, seed + 900, 100.0, 0.08),
        "rounded" => {
            let (lsb, mut angle, mut before) = (1.5, 0.0, 0.0);
            for r in &mut rate {
                angle += *r;
                let rounded = (angle / lsb).round() * lsb;
                *r = rounded - before;
                before = rounded;
            }
        }
        _ => {}
    }
    let lost = |i: usize| process == "gaps" && (i / 7 % 71 == seed as usize % 71);
    put(path, &rate, None, |i| !lost(i));
}

fn compared(folder: &Path, recording: &str, simulation: &str) -> (i32, Value, String) {
    let _ = std::fs::remove_dir_all(folder.join("e"));
    let said = sagnac(folder, &["explain", recording, "--simulation", simulation, "--out", "e"]);
    let text =
        std::fs::read_to_string(folder.join("e/explain.json")).unwrap_or_else(|e| panic!("{e}: {said:?}"));
    (said.code, serde_json::from_str(&text).unwrap(), said.out)
}

#[test]
fn a_recording_is_consistent_with_itself() {
    let dir = tempdir().unwrap();
    for process in long::cases("a_recording_is_consistent_with_itself", &PROCESSES, 3) {
        draw(process, &dir.path().join("x.csv"), 11);
        let (code, all, out) = compared(dir.path(), "x.csv", "x.csv");
        assert_eq!((code, all["verdict"].as_str()), (0, Some("consistent")), "{process}: {out}");
        assert_eq!(all["fit"]["baseline"], all["fit"]["augmented"]);
        assert!(all["family_p_value"].as_f64().unwrap() > 0.01, "{process}: {}", all["family_p_value"]);
        let page = std::fs::read_to_string(dir.path().join("e/report.md")).unwrap();
        assert!(page.contains("have identical samples"), "{page}");
    }
}

/// Two draws of one process, at 1 % each: two of twelve false alarms come about once in 140 times.
#[test]
fn two_draws_of_one_process_are_consistent() {
    let dir = tempdir().unwrap();
    let mut false_alarms = vec![];
    let name = "two_draws_of_one_process_are_consistent";
    for process in long::cases(name, &PROCESSES, 3) {
        for seed in long::cases(name, &[21, 31], 1) {
            draw(process, &dir.path().join("s.csv"), seed);
            draw(process, &dir.path().join("x.csv"), seed + 100);
            let (code, all, _) = compared(dir.path(), "x.csv", "s.csv");
            if code != 0 {
                false_alarms.push(format!("{process} {seed}: {}", all["effects"]));
            }
        }
    }
    assert!(false_alarms.len() < 2, "{false_alarms:#?}");
}

#[test]
fn what_the_recording_has_beyond_its_simulation_is_named() {
    let dir = tempdir().unwrap();
    let temperature: Vec<f64> = (0..ROWS).map(|i| 20.0 + 8.0 * (i as f64 / 600.0).sin()).collect();
    let kinds =
        [("bias_step", 41), ("markov_long", 44), ("temp_linear", 45), ("line", 42), ("excess_arw", 43)];
    for (kind, seed) in long::cases("what_the_recording_has_beyond_its_simulation_is_named", &kinds, 3) {
        let with = (kind == "temp_linear").then_some(temperature.as_slice());
        put(&dir.path().join("s.csv"), &noise(seed), with, |_| true);
        let mut rate = noise(seed + 100);
        let each = |rate: &mut Vec<f64>, f: &dyn Fn(usize) -> f64| {
            rate.iter_mut().enumerate().for_each(|(i, r)| *r += f(i));
        };
        match kind {
            "bias_step" => each(&mut rate, &|i| if i > 1700 { 0.3 } else { 0.0 }),
            "line" => each(&mut rate, &|i| 0.15 * (TAU * 0.11 * i as f64).sin()),
            "excess_arw" => rate.iter_mut().for_each(|r| *r = 5.0 + 1.25 * (*r - 5.0)),
            "temp_linear" => each(&mut rate, &|i| 0.06 * (temperature[i] - 20.0)),
            _ => wander(&mut rate, 77, 100.0, 0.4),
        }
        put(&dir.path().join("x.csv"), &rate, with, |_| true);
        let (code, all, out) = compared(dir.path(), "x.csv", "s.csv");
        assert_eq!((code, all["effects"][0]["kind"].as_str()), (1, Some(kind)), "{out}");
    }
}

#[test]
fn a_simulation_without_noise_states_nothing_and_says_so() {
    let dir = tempdir().unwrap();
    put(&dir.path().join("x.csv"), &noise(51), None, |_| true);
    for (name, value) in [("zero.csv", 0.0), ("quiet.csv", 0.1)] {
        put(&dir.path().join(name), &[value; ROWS], None, |_| true);
        let said = sagnac(dir.path(), &["explain", "x.csv", "--simulation", name, "--out", "e"]);
        assert_eq!(said.code, 2, "{name}: {said:?}");
        assert!(said.err.contains("has no noise"), "{}", said.err);
    }
}
