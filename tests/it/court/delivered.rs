//! What was done to a recording before it was delivered: a run saved again, slow changes taken out, outliers removed.

use super::{analyzed, objections};
use crate::support::{measurand, procedure, result, sagnac, shipped};
use sagnac_studies::bench::noise_source::NoiseSource;
use std::fmt::Write as _;
use std::path::Path;

/// Runs of five minutes at 1 Hz with ten minutes between them.
fn series(folder: &Path, runs: &[Vec<f64>]) {
    let mut text = String::from("time_s,rate_deg_h\n");
    for (at, run) in runs.iter().enumerate() {
        for (i, value) in run.iter().enumerate() {
            let _ = writeln!(text, "{},{:.5}", 900 * at + i, 12.47 + value);
        }
    }
    std::fs::write(folder.join("runs.csv"), text).unwrap();
}

#[test]
fn a_run_that_is_another_one_saved_again_decides_no_repeatability() {
    let folder = tempfile::tempdir().unwrap();
    let mut source = NoiseSource::new(11);
    let mut noise = |sigma: f64| -> Vec<f64> { (0..300).map(|_| sigma * source.normal()).collect() };
    let own: Vec<Vec<f64>> = (0..6).map(|_| noise(0.2)).collect();
    let jitter = noise(0.02);
    let copy =
        |sign: f64| own[0].iter().zip(&jitter).map(move |(v, j)| sign * v + j + 0.01).collect::<Vec<f64>>();
    let backwards: Vec<f64> = own[0].iter().rev().copied().collect();
    let repeatability = |runs: &[Vec<f64>]| {
        series(folder.path(), runs);
        let procedure = shipped("procedures/bias-repeatability.toml");
        let said = sagnac(
            folder.path(),
            &["run", &procedure, "runs.csv", "--serial", "J-1", "--out", "o", "--force"],
        );
        assert!(said.code != 2, "{said:?}");
        let found = result(&folder.path().join("o"));
        objections(measurand(&found, "bias_repeatability"))
            .iter()
            .map(|c| (*c).to_owned())
            .collect::<Vec<_>>()
    };
    assert!(repeatability(&own).is_empty(), "independent runs");
    for (name, copied) in [("jitter", copy(1.0)), ("upside down", copy(-1.0)), ("backwards", backwards)] {
        let mut runs = own.clone();
        runs[3] = copied;
        assert_eq!(repeatability(&runs), ["copied_run"], "{name}");
    }
}

#[test]
fn slow_changes_that_were_taken_out_leave_random_walk_open() {
    let folder = tempfile::tempdir().unwrap();
    let mut source = NoiseSource::new(12);
    let (n, interval_s) = (3600, 10.0);
    let mut values = source.white(0.002, interval_s, n);
    source.walk(0.02, interval_s, n).iter().zip(&mut values).for_each(|(w, v)| *v += w);
    let few = source.walk(0.012, interval_s, n);
    let slow_walk: Vec<f64> =
        source.white(0.002, interval_s, n).iter().zip(&few).map(|(v, w)| v + w).collect();
    let contradicted = |values: &[f64]| {
        let rates: Vec<f64> = values.iter().map(|v| 12.0 + v).collect();
        let found = analyzed(folder.path(), interval_s, &rates);
        !objections(measurand(&found, "rate_random_walk")).is_empty()
    };
    assert!(!contradicted(&values), "as it was recorded");
    // A third-order polynomial fitted and subtracted: Legendre polynomials on the grid, made square to one another.
    let mut known: Vec<Vec<f64>> = vec![];
    let mut flat = values.clone();
    for degree in 0..=3 {
        let mut power: Vec<f64> =
            (0..n).map(|i| ((2 * i + 1) as f64 / n as f64 - 1.0).powi(degree)).collect();
        for other in &known {
            let along: f64 = other.iter().zip(&power).map(|(a, b)| a * b).sum();
            power.iter_mut().zip(other).for_each(|(p, o)| *p -= along * o);
        }
        let length = power.iter().map(|p| p * p).sum::<f64>().sqrt();
        power.iter_mut().for_each(|p| *p /= length);
        let along: f64 = power.iter().zip(&flat).map(|(p, v)| p * v).sum();
        flat.iter_mut().zip(&power).for_each(|(v, p)| *v -= along * p);
        known.push(power);
    }
    assert!(contradicted(&flat), "a polynomial was taken out");
    // A high pass of first order with its corner at 1/(2π·150 s), of a walk that is below the white noise there: a larger one
    // leaves exactly a Markov process.
    assert!(!contradicted(&slow_walk), "as it was recorded");
    let keep = (-interval_s / 150.0f64).exp();
    let mut slow = slow_walk[0];
    let passed: Vec<f64> = slow_walk
        .iter()
        .map(|v| {
            slow = keep * slow + (1.0 - keep) * v;
            v - slow
        })
        .collect();
    assert!(contradicted(&passed), "a filter took it out");
}

#[test]
fn outliers_that_were_removed_by_hand_leave_a_missing_tail() {
    let folder = tempfile::tempdir().unwrap();
    let mut source = NoiseSource::new(13);
    let noise = source.white(0.002, 1.0, 40_000);
    let sigma = 60.0 * 0.002;
    let tails = |values: &[f64]| {
        let mut text = String::from("time_s,rate_deg_h,temp_degC\n");
        for (i, value) in values.iter().enumerate() {
            let _ = writeln!(text, "{i},{:.7},20.0", 12.47 + value);
        }
        std::fs::write(folder.path().join("r.csv"), text).unwrap();
        let arguments = ["run", &procedure(), "r.csv", "--serial", "J-1", "--out", "o", "--force"];
        let said = sagnac(folder.path(), &arguments);
        assert!(said.code != 2, "{said:?}");
        let found = result(&folder.path().join("o"));
        let conditions = found["conditions"].as_array().unwrap().clone();
        conditions.iter().any(|c| c["id"] == "tails" && c["status"] == "invalid")
    };
    assert!(!tails(&noise), "noise as it is");
    // Every value beyond three standard deviations gets the value before it.
    let mut cut = noise.clone();
    for i in 1..cut.len() {
        if cut[i].abs() > 3.0 * sigma {
            cut[i] = cut[i - 1];
        }
    }
    assert!(tails(&cut), "values beyond three standard deviations were removed");
}
