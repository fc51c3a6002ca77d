//! Stamps as loggers write them, through the program: lossy, coarse, rolling over, beside a counter, and angles in
//! place of rates.

use crate::support::synthetic::white;
use crate::support::{measurand, result, sagnac};
use serde_json::Value;
use std::path::Path;
use tempfile::tempdir;

fn analysed(dir: &Path, text: &str, args: &[&str]) -> Value {
    std::fs::write(dir.join("r.csv"), text).unwrap();
    let mut all = vec!["analyze", "r.csv", "--out", "a"];
    all.extend(args);
    let said = sagnac(dir, &all);
    assert_eq!(said.code, 0, "{said:?}");
    result(&dir.join("a"))
}

fn rows(header: &str, rows: impl Iterator<Item = String>) -> String {
    std::iter::once(header.to_owned()).chain(rows).map(|r| r + "\n").collect()
}

fn rate(i: u64) -> f64 {
    (white(3, i) * 1e4).round() / 1e4
}

#[test]
fn every_third_sample_lost_is_counted_and_the_figures_are_those_of_the_right_clock() {
    let dir = tempdir().unwrap();
    let kept = || (0..6000u64).filter(|i| i % 3 != 2);
    let lossy = rows("time_s,rate_deg_h", kept().map(|i| format!("{i},{}", rate(i))));
    let r = analysed(dir.path(), &lossy, &[]);
    assert_eq!(r["recording"][0]["sample_interval_s"], 1.0);
    assert_eq!((&r["integrity"]["gaps"], &r["integrity"]["missing_samples"]), (&1999.into(), &1999.into()));
    // The declared rate says that the stamps are rounded.
    let r = analysed(dir.path(), &lossy, &["--sample-rate", "0.6666667"]);
    assert!(
        (r["recording"][0]["sample_interval_s"].as_f64().unwrap() / 1.5 - 1.0).abs() < 1e-4,
        "{:#}",
        r["recording"]
    );
}

#[test]
fn clock_time_that_passes_midnight_changes_no_figure() {
    let dir = tempdir().unwrap();
    let text = |period: u64| {
        rows(
            "time_s,rate_deg_h",
            (0..4000u64).map(|i| format!("{},{}", (86_400 - 1500 + i) % period, rate(i))),
        )
    };
    let plain = analysed(dir.path(), &text(1_000_000), &[]);
    let r = analysed(dir.path(), &text(86_400), &[]);
    assert_eq!(r["measurands"], plain["measurands"]);
    assert_eq!((&r["integrity"]["rollovers"], &r["integrity"]["gaps"]), (&1.into(), &0.into()));
    let fault = &r["integrity"]["faults"][0];
    assert_eq!((&fault["kind"], &fault["row"]), (&"rollover".into(), &1501.into()));
}

#[test]
fn timers_of_32_bits_roll_over() {
    let dir = tempdir().unwrap();
    let width = 1u64 << 32;
    for (unit, step) in [("us", 10_000), ("ms", 10)] {
        let stamps =
            (0..5000u64).map(|i| format!("{},{}", (width - 2000 * step + i * step) % width, rate(i)));
        let r = analysed(dir.path(), &rows(&format!("time [{unit}],rate [deg/h]"), stamps), &[]);
        assert_eq!((&r["integrity"]["rollovers"], &r["integrity"]["gaps"]), (&1.into(), &0.into()), "{unit}");
        assert_eq!(r["recording"][0]["sample_interval_s"], 0.01);
    }
}

#[test]
fn stamps_in_whole_seconds_give_the_mean_rate() {
    let dir = tempdir().unwrap();
    let text = rows("time_s,rate_deg_h", (0..20_000u64).map(|i| format!("{},{}", i / 100, rate(i))));
    let r = analysed(dir.path(), &text, &[]);
    assert_eq!(r["recording"][0]["sample_interval_s"], 0.01);
    assert_eq!((&r["integrity"]["gaps"], &r["integrity"]["duplicate_timestamps"]), (&0.into(), &0.into()));
    let said =
        r["conditions"].as_array().unwrap().iter().any(|c| c["id"] == "time_base" && c["status"] == "remark");
    assert!(said, "{:#}", r["conditions"]);
}

#[test]
fn a_counter_tells_lost_and_repeated_samples_and_the_stamps_its_rate() {
    let dir = tempdir().unwrap();
    // 8-bit counter at 96.25 Hz; 7 samples are lost after 999, row 2000 is doubled, the clock is set at 3000.
    let line = |i: u64| {
        let stamp = i as f64 / 96.25 + if i >= 3000 { 5.0 } else { 0.0 };
        format!("{stamp:.6},{},{}", i % 256, rate(i))
    };
    let kept = (0..5000u64)
        .filter(|i| !(1000..1007).contains(i))
        .flat_map(|i| vec![line(i); 1 + usize::from(i == 2000)]);
    let text = rows("time_s,n,rate_deg_h", kept);
    let r = analysed(dir.path(), &text, &["--counter", "n"]);
    let i = &r["integrity"];
    assert_eq!(
        (&i["gaps"], &i["missing_samples"], &i["duplicate_timestamps"]),
        (&1.into(), &7.into(), &1.into())
    );
    assert_eq!((&i["rollovers"], &i["timestamp_disagreements"]), (&19.into(), &1.into()));
    let interval = r["recording"][0]["sample_interval_s"].as_f64().unwrap();
    assert!((interval * 96.25 - 1.0).abs() < 1e-7, "{interval}");
    let told = |kind: &str| {
        i["faults"].as_array().unwrap().iter().find(|f| f["kind"] == kind).unwrap()["row"].clone()
    };
    // Rows are those of the file: 7 are missing and one is doubled before the clock is set.
    assert_eq!((told("gap"), told("timestamp_disagreement")), (1001.into(), 2995.into()));
    // A counter alone with a declared rate.
    let r = analysed(dir.path(), &text, &["--counter", "n", "--time", "none", "--sample-rate", "96.25"]);
    assert_eq!(
        (&r["integrity"]["missing_samples"], &r["integrity"]["timestamp_disagreements"]),
        (&7.into(), &0.into())
    );
}

#[test]
fn the_rate_of_an_accumulated_angle_is_the_rate() {
    let dir = tempdir().unwrap();
    // A rate in deg/h sampled each second turns rate/3600 deg; the sum passes a full turn.
    let turned = |i: u64| 40_000.0 + 50.0 * white(5, i);
    let mut angle = 0.0;
    let lines: Vec<(String, String)> = (0..4000u64)
        .map(|i| {
            angle += turned(i) / 3600.0;
            (format!("{i},{:.12}", angle % 360.0), format!("{i},{:.9}", turned(i)))
        })
        .collect();
    let summed = rows("time_s,angle_deg", lines.iter().map(|l| l.0.clone()));
    // The first angle has none before it.
    let direct = rows("time_s,rate_deg_h", lines.iter().skip(1).map(|l| l.1.clone()));
    let plain = analysed(dir.path(), &direct, &[]);
    let r = analysed(dir.path(), &summed, &["--angle", "angle_deg"]);
    for id in ["static_bias", "angle_random_walk", "russian_sigma_10s", "bias_instability_minimum"] {
        let (a, b) = (measurand(&r, id)["value"].as_f64(), measurand(&plain, id)["value"].as_f64());
        let (a, b) = (a.unwrap(), b.unwrap());
        assert!((a / b - 1.0).abs() < 1e-6, "{id}: {a} {b}");
    }
    assert!(r["integrity"]["rollovers"].as_u64().unwrap() > 100);
    assert_eq!(r["integrity"]["non_finite"], 0);
}

#[test]
fn the_result_tells_how_well_the_stamps_tell_the_rate() {
    let dir = tempdir().unwrap();
    // 1e-4 s of jitter on 100 Hz, and a rate that changes by 20 ppm.
    let stamp = |i: u64| {
        0.01 * (i as f64 + 10e-6 * (i as f64).powi(2) / 50_000.0) + 1e-4 * white(9, i) / 3600.0f64.sqrt()
    };
    let text = rows("time_s,rate_deg_h", (0..50_000u64).map(|i| format!("{:.9},{}", stamp(i), rate(i))));
    let r = analysed(dir.path(), &text, &[]);
    let file = &r["recording"][0];
    let drift = file["clock_drift_ppm"].as_f64().unwrap();
    assert!((drift - 20.0).abs() < 2.0, "{file:#}");
    let u = file["sample_interval_uncertainty_s"].as_f64().unwrap();
    assert!(u > 0.0 && u < 1e-7, "{u}");
    assert!((file["sample_interval_s"].as_f64().unwrap() / 0.01 - 1.0 - 10e-6).abs() < 1e-6);
}
