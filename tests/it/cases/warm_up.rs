//! A bias that leaves its band again after the warm-up, and a warm-up that cannot be told.

use super::{input, run};
use crate::support::measurand;
use crate::support::synthetic::white;
use std::fmt::Write;

const CASE: &str = "warm-up-leaves-the-band";

#[test]
fn a_bias_that_leaves_the_band_again_has_not_warmed_up_before() {
    let limits = input(CASE, "limits.toml");
    let (said, found) = run("warm-up", &input(CASE, "unit.csv"), &["--serial", "J-1", "--limits", &limits]);
    assert_ne!(said.code, 0, "{}", said.out);
    let row = measurand(&found, "warm_up_time");
    assert!(row["value"].as_f64().is_none_or(|v| (v - 6600.0).abs() < 300.0), "{row}");
    assert!(said.out.contains("band again"), "{}", said.out);
}

/// Three hours from switching on, every 5 s: a decay of some amplitude over 8 min and noise, averaged over so many samples.
fn record(seed: u64, amplitude: f64, averaged: usize) -> String {
    let rate = |i: usize| {
        let t = 5.0 * i as f64;
        12.8 + amplitude * (-t / 160.0).exp() + 0.05 * white(seed, i as u64)
    };
    let mut out = String::from("time_s,rate_deg_h\n");
    for i in 0..2160usize {
        let from = (i + 1).saturating_sub(averaged);
        let mean = (from..=i).map(rate).sum::<f64>() / (i + 1 - from) as f64;
        let _ = writeln!(out, "{},{mean:.5}", 5 * i);
    }
    out
}

fn code(record: &str) -> (i32, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("unit.csv");
    std::fs::write(&path, record).unwrap();
    let limits = input(CASE, "limits.toml");
    let (said, _) = run("warm-up", &path.to_string_lossy(), &["--serial", "J-1", "--limits", &limits]);
    (said.code, said.out)
}

#[test]
fn a_unit_that_was_warm_before_or_was_smoothed_does_not_pass() {
    let (good, said) = code(&record(1, 0.5, 1));
    assert_eq!(good, 0, "{said}");
    let (warm, said) = code(&record(2, 0.0, 1));
    assert!(warm == 3 && said.contains("no transient"), "{said}");
    let (smoothed, said) = code(&record(3, 0.5, 24));
    assert!(smoothed == 3 && said.contains("smoothed"), "{said}");
}
