//! Effects of realistic size on a moving table, thousands of times the noise: nothing is to be named beside them.

use super::json;
use crate::support::sagnac;
use crate::support::synthetic::white;
use serde_json::Value;
use std::f64::consts::{PI, TAU};
use std::fmt::Write;
use std::path::Path;
use tempfile::tempdir;

/// N of the recordings, deg/√h.
const N: f64 = 0.003;
const RATE_HZ: f64 = 5.0;
/// A delay of 5.5 standard deviations behind a swing of 10 deg/s in 80 s: the derivative has an rms of 1999 deg/h/s, so that 8000 samples
/// of 0.402 deg/h tell it to 2.25 µs.
const LAG_S: f64 = 12.4e-6;

/// A sweep of the table from slow to fast, deg/s; its phase is cubic in time.
fn sweep(t: f64) -> f64 {
    6.0 * (TAU * (0.01 + 4.0e-5 * t) * t).sin()
}

/// A recording of a table's rate with what a gyro makes of it, deg/h, and its claim: the bias known to 0.05 deg/h.
fn recorded(folder: &Path, samples: usize, table: impl Fn(f64) -> f64, gyro: impl Fn(f64) -> f64) -> Value {
    let mut text = String::from("time_s,rate_deg_h,table_rate_deg_s\n");
    for i in 0..samples {
        let t = i as f64 / RATE_HZ;
        let rate = gyro(t) + 60.0 * N * RATE_HZ.sqrt() * white(77, i as u64);
        let _ = writeln!(text, "{t:.3},{rate:.6},{:.9}", table(t));
    }
    std::fs::write(folder.join("r.csv"), text).unwrap();
    let model = format!(
        "[recording]\ncase = \"t\"\nsample_rate_hz = {RATE_HZ}\n[noise]\nN_deg_rt_h = {N}\n[bias]\nvalue_deg_h = 1.0\n\
         [scale_factor]\nerror_ppm = 0.0\n[uncertainty]\nN_rel = 0.02\nbias_deg_h = 0.05\nscale_factor_ppm = 2.0\n"
    );
    std::fs::write(folder.join("model.toml"), model).unwrap();
    let said = sagnac(folder, &["explain", "r.csv", "--model", "model.toml", "--out", "e"]);
    assert_eq!((said.code, said.err.as_str()), (1, ""), "{said:?}");
    json(&folder.join("e/explain.json"))
}

fn kinds(all: &Value) -> Vec<&str> {
    all["effects"].as_array().unwrap().iter().filter_map(|e| e["kind"].as_str()).collect()
}

/// The one parameter named, within so many of its half intervals.
fn near(all: &Value, effect: usize, name: &str, truth: f64) {
    let of = &all["effects"][effect]["parameters"][name];
    let (value, low, high) =
        (of["value"].as_f64().unwrap(), of["ci95"][0].as_f64().unwrap(), of["ci95"][1].as_f64().unwrap());
    assert!((value - truth).abs() < (high - low).max(1e-9 * truth.abs()), "{name} {truth}: {of}");
}

#[test]
fn a_delay_of_milliseconds_beside_an_error_of_the_scale_factor() {
    let dir = tempdir().unwrap();
    let gyro = |t: f64| 1.02 + 3600.0 * (1.0 - 60e-6) * sweep(t - 0.005);
    let all = recorded(dir.path(), 8000, sweep, gyro);
    assert_eq!(kinds(&all), ["time_offset", "sf_error"], "{all}");
    near(&all, 0, "lag_s", 0.005);
    near(&all, 1, "error_ppm", -60.0);
}

#[test]
fn a_limit_that_a_slow_sine_exceeds() {
    let dir = tempdir().unwrap();
    let table = |t: f64| 12.0 * (TAU * t / 900.0).sin();
    let all = recorded(dir.path(), 8000, table, |t| 1.02 + 3600.0 * table(t).clamp(-11.7, 11.7));
    assert_eq!(kinds(&all), ["saturation"], "{all}");
    near(&all, 0, "limit_deg_s", 11.7);
}

/// Two beams of a ring laser that lock to each other below 3 deg/h: their beat is less than the rate far beyond.
#[test]
fn a_lock_in_has_its_own_half_width() {
    let dir = tempdir().unwrap();
    let table = |t: f64| 20.0 / 3600.0 * (TAU * t / 900.0).sin();
    let beat = |deg_h: f64| (deg_h * deg_h - 9.0).max(0.0).sqrt().copysign(deg_h);
    let all = recorded(dir.path(), 8000, table, |t| 1.02 + beat(3600.0 * table(t)));
    assert_eq!(kinds(&all), ["dead_zone"], "{all}");
    near(&all, 0, "half_width_deg_h", 3.0);
    let stated = std::fs::read_to_string(dir.path().join("e/augmented.toml")).unwrap();
    assert!(stated.contains("lock_in = 1"), "{stated}");
}

/// As in any unit the corner is round: half of the loss at the limit itself, over 0.02 deg/s, a hundred times the noise and more.
#[test]
fn a_limit_with_a_round_corner_has_no_unknown_and_no_bursts_beside_it() {
    let dir = tempdir().unwrap();
    let table = |t: f64| 12.0 * (TAU * t / 900.0).sin();
    let lost = |rate: f64| 0.02 * ((rate.abs() - 11.7) / 0.02).exp().ln_1p();
    let gyro = |t: f64| 1.02 + 3600.0 * (table(t) - lost(table(t)).copysign(table(t)));
    let all = recorded(dir.path(), 8000, table, gyro);
    assert_eq!(kinds(&all), ["saturation"], "{all}");
    near(&all, 0, "limit_deg_s", 11.7);
}

#[test]
fn a_scale_factor_that_bends_has_no_comb_of_the_table_beside_it() {
    let dir = tempdir().unwrap();
    let table = |t: f64| 10.0 * (TAU * t / 80.0).sin();
    let gyro = |t: f64| {
        let rate = table(t);
        1.02 + 3600.0 * (rate + 2e-4 * (rate + 0.05 * rate.powi(3) / 100.0))
    };
    let all = recorded(dir.path(), 8000, table, gyro);
    // The bend is a nonlinearity of the scale factor, and may be named so.
    assert_eq!(kinds(&all)[0], "sf_error", "{all}");
    assert!(kinds(&all).iter().all(|k| ["sf_error", "sf_nonlinearity"].contains(k)), "{all}");
}

#[test]
fn a_delay_of_a_few_nats_is_named_without_the_price_of_a_search() {
    let dir = tempdir().unwrap();
    let table = |t: f64| 10.0 * (TAU * t / 80.0).sin();
    // 5.5 deviations: 15 nats of one parameter.
    let all = recorded(dir.path(), 8000, table, |t| 1.02 + 3600.0 * table(t - LAG_S));
    assert_eq!(kinds(&all), ["time_offset"], "{all}");
    near(&all, 0, "lag_s", LAG_S);
}

#[test]
fn a_limit_that_is_passed_within_single_samples_has_no_bursts_beside_it() {
    // Steps of the table's rate, and what a sample of either signal is: its mean over the interval.
    let steps = |t: f64| (8.0 * ((t / 37.0).sin() * 3.0)).clamp(-10.0, 10.0);
    let mean = |f: &dyn Fn(f64) -> f64, t: f64| {
        (0..400).map(|k| f(t + ((f64::from(k) + 0.5) / 400.0 - 0.5) / RATE_HZ)).sum::<f64>() / 400.0
    };
    let dir = tempdir().unwrap();
    let limited = |t: f64| steps(t).clamp(-9.95, 9.95);
    let gyro = |t: f64| 1.02 + 3600.0 * mean(&limited, t);
    let all = recorded(dir.path(), 8000, |t| mean(&steps, t), gyro);
    assert_eq!(kinds(&all), ["saturation"], "{all}");
    near(&all, 0, "limit_deg_s", 9.95);
}

#[test]
fn a_ripple_follows_the_bias_that_the_gyro_has() {
    let dir = tempdir().unwrap();
    let (period, bias) = (4.2, 1.0 + 0.09);
    // Slow rates: a sample covers a fraction of a period.
    let table = |t: f64| 6e-4 * (PI * t / 800.0).sin();
    let angle = |t: f64| 3600.0 * 6e-4 * 800.0 / PI * (1.0 - (PI * t / 800.0).cos()) + bias * t;
    let gyro = |t: f64| bias + 3600.0 * table(t) + 0.08 * (TAU * angle(t) / period).cos();
    let all = recorded(dir.path(), 8000, table, gyro);
    assert_eq!(kinds(&all), ["reset_ripple"], "{all}");
    near(&all, 0, "period_arcsec", period);
}

/// Rates in steps from zero up and from zero down, over rows of which a fourth is missing: what the gyro makes of them is 7 % off at
/// the largest, thousands of times the noise. The rows that are not there must not speak for a gyro without it.
#[test]
fn large_courses_over_missing_rows() {
    let table = |i: usize| [3.5, -3.5][i / 43 % 2] * (i % 43) as f64;
    let degrees = |i: usize| 48.0 + 6.0 * (i as f64 / 110.0).sin();
    let gyro = |i: usize| {
        let (rate, size) = (table(i), table(i) / 147.0);
        3600.0 * rate * (1.0 - 0.07 * size * size - 430e-6 * (degrees(i) - 20.0))
    };
    let dir = tempdir().unwrap();
    let mut text = String::from("time_s,rate_deg_h,table_rate_deg_s,temp_degC\n");
    for i in (0..688).filter(|i| !(172..258).contains(i) && !(430..516).contains(i)) {
        let rate = gyro(i) + 85.0 * white(78, i as u64);
        let _ = writeln!(text, "{}.0,{rate:.3},{:.6},{:.4}", 16 * i, table(i), degrees(i));
    }
    std::fs::write(dir.path().join("r.csv"), text).unwrap();
    let model = "[recording]\ncase = \"t\"\nsample_rate_hz = 0.0625\n[noise]\nN_deg_rt_h = 5.7\n[bias]\nvalue_deg_h = 0.0\n\
        [scale_factor]\nerror_ppm = 0.0\n[uncertainty]\nN_rel = 0.3\nbias_deg_h = 1000\nscale_factor_ppm = 50000\n";
    std::fs::write(dir.path().join("model.toml"), model).unwrap();
    let said = sagnac(dir.path(), &["explain", "r.csv", "--model", "model.toml", "--out", "e"]);
    assert_eq!((said.code, said.err.as_str()), (1, ""), "{said:?}");
    let all = json(&dir.path().join("e/explain.json"));
    assert_eq!(kinds(&all), ["sf_nonlinearity", "sf_temperature", "dropped_samples"], "{all}");
    near(&all, 0, "cubic_ppm_at_max", -70_000.0);
    near(&all, 1, "coefficient_ppm_per_degC", -430.0);
}
