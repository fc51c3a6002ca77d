//! No part of a record that is not there: white noise is not split, no part exceeds the record, a record that moves shows no
//! noise at rest, clipped values are reported.

use crate::support::{result, sagnac};
use sagnac_studies::bench::noise_source::{NoiseSource, add, csv};
use serde_json::Value;
use std::path::Path;

const RATE_HZ: f64 = 100.0;

fn procedure(ids: &[&str]) -> String {
    let mut text = String::from(
        "format = \"procedure/1\"\n[procedure]\nid = \"p\"\ntitle = \"P\"\nrevision = \"A\"\n\
         [recording]\nsample_rate = \"100 Hz\"\n\
         [[channel]]\nid = \"rate\"\ncolumn = \"rate_deg_h\"\nrole = \"rate\"\nunit = \"deg/h\"\n",
    );
    for id in ids {
        text += &format!("[[measurand]]\nid = \"{id}\"\n");
    }
    text
}

fn limits(id: &str, max: &str) -> String {
    format!(
        "format = \"limits/1\"\n[limits]\nid = \"l\"\ntitle = \"L\"\nrevision = \"A\"\nfamily = \"F\"\nsource = \"S\"\n\
         [[limit]]\nmeasurand = \"{id}\"\nmax = \"{max}\"\n"
    )
}

fn tested(folder: &Path, values: &[f64], ids: &[&str], limit: (&str, &str)) -> Value {
    std::fs::write(folder.join("r.csv"), csv("rate_deg_h", &[values])).unwrap();
    std::fs::write(folder.join("p.toml"), procedure(ids)).unwrap();
    std::fs::write(folder.join("l.toml"), limits(limit.0, limit.1)).unwrap();
    let said =
        sagnac(folder, &["run", "p.toml", "r.csv", "--limits", "l.toml", "--serial", "SN-1", "--out", "o"]);
    assert!(said.code != 2, "{said:?}");
    result(&folder.join("o"))
}

fn row<'a>(result: &'a Value, id: &str) -> &'a Value {
    let rows = result["measurands"].as_array().unwrap();
    rows.iter().find(|r| r["id"] == id).unwrap_or_else(|| panic!("no row of {id}"))
}

/// White noise beside a process of correlation time `samples`, each sample the mean over its interval.
fn beside_short_process(seed: u64, n: f64, sigma: f64, samples: f64, len: usize) -> Vec<f64> {
    const FINE: usize = 16;
    let dt_s = 1.0 / RATE_HZ;
    let mut source = NoiseSource::new(seed);
    let fine = source.markov(sigma, samples * dt_s, dt_s / FINE as f64, FINE * len);
    let mut x: Vec<f64> = fine.chunks_exact(FINE).map(|c| c.iter().sum::<f64>() / FINE as f64).collect();
    add(&mut x, &source.white(n, dt_s, len));
    x
}

#[test]
fn a_process_that_is_white_where_the_curve_is_read_belongs_to_angle_random_walk() {
    let folder = tempfile::tempdir().unwrap();
    // 2σ²T/3600 = 2.63² − 1.742²: the curve reads 2.63 from a few samples on, whatever is beneath.
    for (seed, samples) in [(1, 0.28), (2, 1.5)] {
        let sigma = ((2.63f64.powi(2) - 1.742f64.powi(2)) * 3600.0 * RATE_HZ / (2.0 * samples)).sqrt();
        let x = beside_short_process(seed, 1.742, sigma, samples, 100_000);
        let ids = ["angle_random_walk", "angle_random_walk_white"];
        let result = tested(folder.path(), &x, &ids, ("angle_random_walk", "2.0 deg/sqrt(h)"));
        let n = row(&result, "angle_random_walk");
        let (low, high) = (n["interval"]["low"].as_f64().unwrap(), n["interval"]["high"].as_f64().unwrap());
        assert!(low < 2.63 && 2.63 < high && high / low < 1.06, "{samples}: {n}");
        assert_eq!(n["verdict"], "fail", "{samples}");
        let white = row(&result, "angle_random_walk_white");
        assert!(samples < 1.0 || white["interval"]["high"].as_f64().unwrap() < 1.9, "{white}");
        std::fs::remove_dir_all(folder.path().join("o")).unwrap();
    }
}

#[test]
fn clipped_outliers_do_not_pass() {
    let folder = tempfile::tempdir().unwrap();
    let mut source = NoiseSource::new(3);
    let mut x = source.white(2.0, 1.0 / RATE_HZ, 60_000);
    let sigma = 60.0 * 2.0 * RATE_HZ.sqrt();
    let whole = tested(folder.path(), &x, &["angle_random_walk"], ("angle_random_walk", "2.1 deg/sqrt(h)"));
    assert_eq!(whole["verdict"], "pass");
    // What lies beyond 1.5σ is replaced by the mean of the twenty samples before.
    for i in 20..x.len() {
        if x[i].abs() > 1.5 * sigma {
            x[i] = x[i - 20..i].iter().sum::<f64>() / 20.0;
        }
    }
    std::fs::remove_dir_all(folder.path().join("o")).unwrap();
    let clipped = tested(folder.path(), &x, &["angle_random_walk"], ("angle_random_walk", "2.1 deg/sqrt(h)"));
    assert_eq!(clipped["verdict"], "indeterminate");
    let conditions = clipped["conditions"].as_array().unwrap();
    let tails = conditions.iter().find(|c| c["id"] == "tails").unwrap();
    assert_eq!(tails["status"], "invalid");
    assert!(tails["note"].as_str().unwrap().contains("excess kurtosis"), "{tails}");
}

#[test]
fn a_record_that_moves_states_no_noise_at_rest() {
    let folder = tempfile::tempdir().unwrap();
    let mut source = NoiseSource::new(4);
    let mut x = source.white(0.1, 1.0 / RATE_HZ, 30_000);
    for (i, v) in x.iter_mut().enumerate() {
        let t = i as f64 / RATE_HZ;
        *v += 36_000.0 * (0.7 * t).sin() * (0.11 * t).cos();
    }
    std::fs::write(folder.path().join("r.csv"), csv("rate_deg_h", &[&x])).unwrap();
    let said = sagnac(folder.path(), &["analyze", "r.csv", "--sample-rate", "100", "--out", "o"]);
    assert_eq!(said.code, 0, "{said:?}");
    let result = result(&folder.path().join("o"));
    for id in ["angle_random_walk", "angle_random_walk_readout", "bias_instability", "rate_random_walk"] {
        let row = row(&result, id);
        assert!(row["value"].is_null() && row["upper_limit"].is_null(), "{row}");
        assert!(row["notes"].to_string().contains("moved"), "{row}");
    }
    let told = sagnac(folder.path(), &["inspect", "r.csv", "--sample-rate", "100"]);
    let text = told.out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(text.contains("Angle random walk is not determined"), "{text}");
}

#[test]
fn a_hand_motion_near_mains_does_not_overrule_a_clean_mains_line() {
    let folder = tempfile::tempdir().unwrap();
    let (rate_hz, len) = (1000.0, 60_000usize);
    let mut source = NoiseSource::new(5);
    let mut x = source.white(0.1, 1.0 / rate_hz, len);
    for (i, v) in x.iter_mut().enumerate() {
        let t = i as f64 / rate_hz;
        *v += 40.0 * (std::f64::consts::TAU * 120.0 * t).sin();
        *v += 12.0 * (std::f64::consts::TAU * 57.0 * t).sin();
    }
    std::fs::write(folder.path().join("r.csv"), csv("rate_deg_h", &[&x])).unwrap();
    let told = sagnac(folder.path(), &["inspect", "r.csv", "--sample-rate", "1000"]);
    let text = told.out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(text.contains("57 Hz") && !text.contains("sample clock is off"), "{text}");
}
