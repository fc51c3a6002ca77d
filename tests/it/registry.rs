//! Every measurand of the registry is read from `result.json` by at least one test. Those that no other test reads are held
//! here to values worked out by hand.

use crate::support::pairs::{PAIRS, sample_once};
use crate::support::{altered, result, root, sagnac, shipped};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;
use sagnac::estimate::{Component, InputQuantity, spread_of};
use sagnac::measurand::MEASURANDS;
use serde_json::Value;
use std::path::Path;
use tempfile::tempdir;

/// The budget of a row gives the interval that the row states: exactly where its law has a formula, and within the shape of the
/// likelihood where it is tabulated.
#[test]
fn the_parts_of_every_budget_give_the_stated_interval() {
    let (mut compared, mut of_equipment) = (0, 0);
    for pair in &PAIRS {
        for row in sample_once(pair.sample).result()["measurands"].as_array().unwrap() {
            let place = format!("{}: {} of {}", pair.sample, row["id"], row["channel"]);
            let (Some(value), Some(low), Some(high)) =
                (row["value"].as_f64(), row["interval"]["low"].as_f64(), row["interval"]["high"].as_f64())
            else {
                assert!(row.get("budget").is_none(), "{place}: a budget without an interval");
                continue;
            };
            if low == high {
                continue;
            }
            let budget: Vec<Component> = serde_json::from_value(row["budget"].clone()).unwrap_or_default();
            assert!(!budget.is_empty(), "{place}: an interval without a budget");
            let shares: f64 = budget.iter().map(|c| c.share_of_variance).sum();
            assert!((shares - 1.0).abs() < 1e-9, "{place}: shares add up to {shares}");
            let common: f64 =
                budget.iter().filter(|c| c.common_to.is_some()).map(|c| c.contribution.powi(2)).sum();
            let stated = row["common_standard_uncertainty"].as_f64().unwrap();
            assert!((common.sqrt() - stated).abs() <= 1e-9 * stated, "{place}: {common} against {stated}");
            let width = high - low;
            match spread_of(&budget).interval(value, 0.95) {
                Some(again) => {
                    let off = (again.low - low).abs().max((again.high - high).abs());
                    assert!(off < 1e-6 * width, "{place}: {again:?} against {low} to {high}");
                }
                None => {
                    let standard: f64 = budget.iter().map(|c| c.contribution.powi(2)).sum::<f64>().sqrt();
                    let ratio = width / (2.0 * 1.96 * standard);
                    assert!((0.5..3.0).contains(&ratio), "{place}: {ratio}");
                }
            }
            compared += 1;
            of_equipment += usize::from(budget.iter().any(|c| c.input != InputQuantity::Readings));
        }
    }
    assert!(compared > 200 && of_equipment > 20, "{compared} compared, {of_equipment} with equipment");
}

#[test]
fn every_measurand_is_named_by_a_test() {
    let mut texts = String::new();
    // Fast tests run studies in short; what those read is named there.
    let cases = root().join("studies/cases");
    let mut open = vec![root().join("tests"), root().join("studies/src"), cases.clone()];
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") || path.starts_with(&cases) {
                texts.push_str(&std::fs::read_to_string(path).unwrap());
            }
        }
    }
    let missing: Vec<&str> =
        MEASURANDS.iter().map(|m| m.id).filter(|id| !texts.contains(&format!("\"{id}\""))).collect();
    assert!(missing.is_empty(), "no test reads {missing:?}");
}

/// Standard normal deviates.
struct Normal(Xoshiro256PlusPlus);

impl Normal {
    fn new(seed: u64) -> Normal {
        Normal(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    fn next(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }
}

fn rows<'a>(result: &'a Value, id: &str) -> Vec<&'a Value> {
    result["measurands"].as_array().unwrap().iter().filter(|m| m["id"] == id).collect()
}

/// A value is near the truth.
fn near(row: &Value, truth: f64, within: f64) {
    let value = row["value"].as_f64().unwrap_or_else(|| panic!("no value: {row:#}"));
    assert!((value - truth).abs() <= within * truth.abs(), "{truth}: {row:#}");
}

/// A value is near the truth, and its interval holds it.
fn holds(row: &Value, truth: f64, within: f64) {
    near(row, truth, within);
    let (low, high) = (row["interval"]["low"].as_f64().unwrap(), row["interval"]["high"].as_f64().unwrap());
    assert!(low <= truth && truth <= high, "{truth}: {row:#}");
}

/// Runs a procedure on rows of a file.
fn run(folder: &Path, procedure: &str, csv: &str) -> Value {
    std::fs::write(folder.join("r.csv"), csv).unwrap();
    let _ = std::fs::remove_dir_all(folder.join("r"));
    let said = sagnac(folder, &["run", procedure, "r.csv", "--serial", "S", "--out", "r"]);
    assert_ne!(said.code, 2, "{said:?}");
    result(&folder.join("r"))
}

/// A record at rest and what one measurand says of it.
fn at_rest(id: &str, dt_s: f64, rate_deg_h: &[f64]) -> Value {
    let dir = tempdir().unwrap();
    let procedure = format!(
        "format = \"procedure/1\"\n[procedure]\nid = \"p\"\ntitle = \"P\"\nrevision = \"A\"\n[[channel]]\nid = \"time\"\n\
         column = \"time_s\"\nrole = \"time\"\nunit = \"s\"\n[[channel]]\nid = \"rate\"\ncolumn = \"rate_deg_h\"\n\
         role = \"rate\"\nunit = \"deg/h\"\n[[measurand]]\nid = \"{id}\"\n"
    );
    std::fs::write(dir.path().join("p.toml"), procedure).unwrap();
    let mut csv = String::from("time_s,rate_deg_h\n");
    for (i, rate) in rate_deg_h.iter().enumerate() {
        csv.push_str(&format!("{},{rate:.7}\n", i as f64 * dt_s));
    }
    let r = run(dir.path(), "p.toml", &csv);
    rows(&r, id)[0].clone()
}

#[test]
fn lines_through_the_allan_deviation_read_what_was_put_in() {
    let mut z = Normal::new(1);
    // White noise of N has the standard deviation 60 N/√τ, deg/h and s.
    let white: Vec<f64> = (0..20_000).map(|_| 60.0 * 0.2 * z.next()).collect();
    holds(&at_rest("angle_random_walk_readout", 1.0, &white), 0.2, 0.05);
    // A walk of K grows by K√h in an hour h.
    let mut level = 0.0;
    let walk: Vec<f64> = (0..40_000)
        .map(|_| {
            level += 5.0 * (10.0f64 / 3600.0).sqrt() * z.next();
            level
        })
        .collect();
    holds(&at_rest("rate_random_walk_readout", 10.0, &walk), 5.0, 0.15);
    // A ramp of 10 °/h in an hour, and next to no noise.
    let ramp: Vec<f64> = (0..20_000).map(|i| 10.0 * f64::from(i) / 3600.0 + 1e-5 * z.next()).collect();
    holds(&at_rest("rate_ramp_readout", 1.0, &ramp), 10.0, 0.01);
    // Angles with a white error of 0.5 arcsec; an arcsecond in a second is a degree in an hour.
    let mut before = z.next();
    let angles: Vec<f64> = (0..20_000)
        .map(|_| {
            let now = z.next();
            let rate = 0.5 * (now - before);
            before = now;
            rate
        })
        .collect();
    near(&at_rest("quantization_readout", 1.0, &angles), 0.5, 0.03);
}

#[test]
fn ramps_and_what_the_temperature_model_leaves_are_those_of_the_chamber() {
    let dir = tempdir().unwrap();
    let procedure = altered(
        dir.path(),
        "p.toml",
        &shipped("procedures/temperature-ramp.toml"),
        &[
            ("low = \"-40 degC\"", "low = \"0 degC\""),
            ("high = \"60 degC\"", "high = \"40 degC\""),
            ("fastest = \"60 degC/h\"", "fastest = \"90 degC/h\""),
            ("dwell = \"45 min\"", "dwell = \"15 min\""),
            ("minimum_duration = \"10 h\"", "minimum_duration = \"3 h\""),
            ("warm_up = \"30 min\"", "warm_up = \"0 s\""),
        ],
    );
    // Temperature, °C, at the corners of the schedule, h.
    let corners = [
        (0.0, 0.0),
        (0.4, 0.0),
        (1.0667, 40.0),
        (1.4667, 40.0),
        (2.1333, 0.0),
        (2.5333, 0.0),
        (3.5333, 40.0),
        (3.9333, 40.0),
        (4.9333, 0.0),
        (5.3333, 0.0),
    ];
    let at = |h: f64| {
        let i = corners.iter().rposition(|c| c.0 <= h).unwrap().min(corners.len() - 2);
        let (a, b) = (corners[i], corners[i + 1]);
        a.1 + (b.1 - a.1) * (h - a.0) / (b.0 - a.0)
    };
    let mut z = Normal::new(2);
    let mut csv = String::from("time_s,rate_deg_h,temp_degC\n");
    for i in 0..19_200 {
        let t = at(f64::from(i) / 3600.0);
        let rate = 12.467 + 0.01 * (t - 20.0) + 60.0 * 0.01 * z.next();
        csv.push_str(&format!("{i},{rate:.5},{:.4}\n", t + 0.002 * z.next()));
    }
    let r = run(dir.path(), &procedure, &csv);
    let ramps: Vec<f64> = rows(&r, "ramp_rate").iter().map(|m| m["value"].as_f64().unwrap()).collect();
    assert_eq!(ramps.len(), 4, "{ramps:?}");
    for (found, stated) in ramps.iter().zip([60.0, -60.0, 40.0, -40.0]) {
        assert!((found / stated - 1.0f64).abs() < 0.01, "{ramps:?}");
    }
    // Means over 100 s of noise of 0.01 °/√h scatter by 60 · 0.01/√100; the model takes some of them away.
    near(rows(&r, "bias_residual_rms")[0], 0.06, 0.2);
}

/// Steps of a table about the rate at which the unit sees none, and its output, deg/h.
fn steps(levels: &[f64], output: impl Fn(f64) -> f64) -> String {
    let up = levels.iter().copied();
    let sweep: Vec<f64> = up.clone().chain(up.rev()).collect();
    let mut z = Normal::new(3);
    let (mut csv, mut angle) = (String::from("time_s,rate_deg_h,table_rate_deg_h,table_angle_deg\n"), 0.0);
    for i in 0..17_280 {
        let input = sweep[(i / 240) % sweep.len()];
        let table = input - 12.467_24;
        let rate = output(input) + 60.0 * 0.0003 / 0.5f64.sqrt() * z.next();
        csv.push_str(&format!("{},{rate:.6},{table:.6},{angle:.8}\n", 0.5 * i as f64));
        angle += table * 0.5 / 3600.0;
    }
    csv
}

#[test]
fn the_smallest_change_that_is_shown_is_that_of_the_schedule() {
    let dir = tempdir().unwrap();
    let procedure = shipped("procedures/threshold.toml");
    let found = |csv: &str| {
        let r = run(dir.path(), &procedure, csv);
        rows(&r, "resolution")[0]["upper_limit"]["value"].as_f64().unwrap()
    };
    // Every change that the test has is followed: the widest distance of neighbours, and as much again between them.
    let even = [-1.0, -0.8, -0.6, -0.4, -0.2, 0.0, 0.2, 0.4, 0.6, 0.8, 1.0];
    let plain = found(&steps(&even, |x| x));
    assert!((plain - 0.4).abs() < 1e-3, "{plain}");
    let wide = found(&steps(&[-1.0, -0.6, -0.4, -0.2, 0.0, 0.2, 0.4, 0.6, 0.8, 1.0], |x| x));
    assert!((wide - 0.8).abs() < 1e-3, "{wide}");
}

#[test]
fn the_range_of_switchings_on_and_their_change_with_temperature_are_those_put_in() {
    let dir = tempdir().unwrap();
    let procedure = shipped("procedures/bias-repeatability.toml");
    let runs = |of: &dyn Fn(usize) -> (f64, f64)| {
        let mut z = Normal::new(4);
        let mut csv = String::from("time_s,rate_deg_h,temp_degC\n");
        for run in 0..6 {
            let (bias, temperature) = of(run);
            for i in 0..300 {
                let rate = 12.467 + bias + 60.0 * 0.0005 * z.next();
                csv.push_str(&format!("{},{rate:.5},{temperature:.3}\n", run * 1200 + i));
            }
        }
        run(dir.path(), &procedure, &csv)
    };
    let biases = [0.1, -0.05, 0.2, 0.0, 0.15, -0.1];
    let r = runs(&|i| (biases[i], 20.0));
    holds(rows(&r, "bias_repeatability_peak_to_peak")[0], 0.3, 0.05);
    let temperatures = [20.0, 22.0, 24.0, 21.0, 23.0, 25.0];
    let r = runs(&|i| (0.05 * (temperatures[i] - 20.0), temperatures[i]));
    holds(rows(&r, "bias_repeatability_temperature")[0], 0.05, 0.1);
}
