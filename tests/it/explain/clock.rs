//! A clock that is wrong, seen by a line that the claim states.

use super::json;
use crate::support::sagnac;
use crate::support::synthetic::white;
use std::fmt::Write;
use std::path::Path;
use tempfile::tempdir;

const MODEL: &str = "[recording]\nsample_rate_hz = 100\n[noise]\nN_deg_rt_h = 0.01\n\
    [uncertainty]\nN_rel = 0.05\nbias_deg_h = 10\n\
    [[effect]]\nkind = \"line\"\n[effect.parameters]\nfrequency_hz = 12.0\namplitude_deg_h = 7.0\n";

/// Five minutes at 100 Hz with a line of so many hertz and deg/h.
fn recorded(folder: &Path, frequency_hz: f64, amplitude: f64) {
    let mut text = String::from("time_s,rate_deg_h\n");
    for i in 0..30_000u64 {
        let t = i as f64 / 100.0;
        let line = amplitude * (std::f64::consts::TAU * frequency_hz * t + 1.1).cos();
        let _ = writeln!(text, "{t},{:.5}", 6.0 * white(91, i) + line);
    }
    std::fs::write(folder.join("r.csv"), text).unwrap();
    std::fs::write(folder.join("model.toml"), MODEL).unwrap();
}

#[test]
fn a_line_of_the_claim_at_another_frequency_is_a_wrong_clock_and_the_loop_closes() {
    let dir = tempdir().unwrap();
    // Stamps of 100 Hz on samples of 96: the line of 12 Hz is shown at 12.5 Hz, and the gyro is ahead.
    recorded(dir.path(), 12.5, 7.3);
    let said = sagnac(dir.path(), &["explain", "r.csv", "--model", "model.toml", "--out", "e"]);
    assert_eq!((said.code, said.err.as_str()), (1, ""), "{said:?}");
    let all = json(&dir.path().join("e/explain.json"));
    let effects = all["effects"].as_array().unwrap();
    assert_eq!(effects.iter().map(|e| e["kind"].as_str().unwrap()).collect::<Vec<_>>(), ["clock_drift"]);
    let drift = &effects[0]["parameters"]["drift_ppm"];
    let truth = -1e6 / 24.0;
    let ci = [&drift["ci95"][0], &drift["ci95"][1]].map(|c| c.as_f64().unwrap());
    // Wider than 95 %, for this is one recording.
    let slack = ci[1] - ci[0];
    assert!(ci[0] - slack < truth && truth < ci[1] + slack && slack < 100.0, "{drift}");
    let again = sagnac(dir.path(), &["explain", "r.csv", "--model", "e/augmented.toml", "--out", "f"]);
    assert_eq!(again.code, 0, "{again:?}");
}

#[test]
fn a_line_of_another_size_is_no_wrong_clock() {
    let dir = tempdir().unwrap();
    recorded(dir.path(), 12.5, 1.5);
    sagnac(dir.path(), &["explain", "r.csv", "--model", "model.toml", "--out", "e"]);
    let all = json(&dir.path().join("e/explain.json"));
    let kinds: Vec<&str> =
        all["effects"].as_array().unwrap().iter().map(|e| e["kind"].as_str().unwrap()).collect();
    assert!(!kinds.is_empty() && !kinds.contains(&"clock_drift"), "{kinds:?}");
}
