use super::*;
use crate::noise::simulate::{Setup, Simulator};
use std::collections::BTreeMap;

const N: f64 = 0.002;
const K: f64 = 0.03;

/// A simulated recording of white noise and a random walk on a mean.
fn series(seed: u64, columns: BTreeMap<Column, Vec<f64>>, mean: &[f64]) -> Series {
    let samples = mean.len();
    let model = NoiseModel { n: N, k: K, ..NoiseModel::default() };
    let setup = Setup::for_record(seed, 1.0, samples as u64);
    let rate = Simulator::new(&model, &setup).take(samples);
    Series {
        time_s: (0..samples).map(|i| i as f64).collect(),
        rate_deg_h: rate.iter().zip(mean).map(|(a, b)| a + b).collect(),
        columns,
        index: (0..samples as u64).collect(),
        sample_interval_s: 1.0,
        ..Series::default()
    }
}

#[test]
fn the_claim_is_what_was_simulated() {
    let n = 36_000;
    let temperature: Vec<f64> = (0..n).map(|i| 25.0 + 8.0 * (f64::from(i) / 6000.0).sin()).collect();
    let rate: Vec<f64> = (0..n).map(|i| if i / 600 % 2 == 0 { 10.0 } else { -10.0 }).collect();
    let mean: Vec<f64> = temperature
        .iter()
        .zip(&rate)
        .map(|(t, r)| -3.1 + 0.5 * (t - 20.0) + 3600.0 * (1.0 + 12e-6) * r)
        .collect();
    let columns = BTreeMap::from([(Column::Temperature, temperature), (Column::TableRate, rate)]);
    let claim = identify(&series(7, columns, &mean), &mut |_| {}).unwrap();
    let t = claim.mean.temperature.unwrap();
    let u = claim.uncertainty;
    let off = |value: f64, truth: f64, sd: f64| (value - truth).abs() / sd;
    assert!(u.temperature_coefficient_deg_h_per_degc < 0.02, "{u:?}");
    assert!(off(t.coefficient_deg_h_per_degc, 0.5, u.temperature_coefficient_deg_h_per_degc) < 3.5);
    assert!(off(claim.mean.scale_factor_ppm.unwrap(), 12.0, u.scale_factor_ppm) < 3.5, "{u:?}");
    assert!(off(claim.noise.n, N, u.n_rel * N) < 3.5 && u.n_rel < 0.02, "{:?} {u:?}", claim.noise);
    assert!(off(claim.noise.k, K, u.k_rel * K) < 3.5, "{:?} {u:?}", claim.noise);
    assert_eq!(claim.noise.b, 0.0);
    assert!(claim.mean.earth.is_none());
}

#[test]
fn the_uncertainty_of_the_coefficient_is_that_of_many_simulations() {
    let n = 16_384;
    let temperature: Vec<f64> = (0..n).map(|i| 25.0 + 8.0 * (f64::from(i) / 600.0).sin()).collect();
    let mean: Vec<f64> = temperature.iter().map(|t| 0.5 * t).collect();
    let mut squares = 0.0;
    let runs = 40;
    for seed in 0..runs {
        let columns = BTreeMap::from([(Column::Temperature, temperature.clone())]);
        let claim = identify(&series(100 + seed, columns, &mean), &mut |_| {}).unwrap();
        let found = claim.mean.temperature.unwrap().coefficient_deg_h_per_degc;
        squares += ((found - 0.5) / claim.uncertainty.temperature_coefficient_deg_h_per_degc).powi(2);
    }
    // The mean of 40 squared normal deviates lies within 0.5 and 1.7 in more than 99 of 100 cases.
    let ratio = squares / runs as f64;
    assert!((0.5..1.7).contains(&ratio), "{ratio}");
}

#[test]
fn a_heading_is_found_from_a_turning_table() {
    let n = 20_000;
    let angle: Vec<f64> = (0..n).map(|i| f64::from(i / 500 * 30 % 360)).collect();
    let horizontal = 15.041_067 * 56f64.to_radians().cos();
    let mean: Vec<f64> = angle.iter().map(|a| horizontal * (a + 40.0f64).to_radians().cos()).collect();
    let claim =
        identify(&series(3, BTreeMap::from([(Column::TableAngle, angle)]), &mean), &mut |_| {}).unwrap();
    let earth = claim.mean.earth.unwrap();
    assert!((earth.latitude_deg - 56.0).abs() < 0.05 && (earth.azimuth_deg - 40.0).abs() < 0.05, "{earth:?}");
}

#[test]
fn a_short_recording_is_refused() {
    let short = series(1, BTreeMap::new(), &[0.0; 100]);
    assert_eq!(identify(&short, &mut |_| {}).err().map(|n| n.id), Some("explain.error.short".into()));
}
