//! Fibre-optic units: blueSeis with its serrodyne ramp, and recordings that are no rest.

use super::{analyse, assert_digits, curve, value};
use crate::support::real::set;
use crate::support::sagnac;
use std::path::Path;

#[test]
fn blueseis_shows_the_comb_of_its_loop() {
    let Some(folder) = set("fog_blueseis_serrodyne_ramp") else { return };
    let taus = [0.01, 0.05, 0.12, 0.24, 1.0, 10.0, 30.0, 60.0];
    let file = folder.join("vertical_360s.parquet");
    let rates = ["rate_counts", "rate_authors_deramped_counts"];
    let outcome = analyse(&file, Ok("t_s"), &rates, "nrad/s", Some(&taus));
    let nrad = 1e9 * std::f64::consts::PI / 180.0 / 3600.0;
    let published = [
        [(388.1, 4), (239.5, 4), (170.6, 4), (33.35, 4), (19.02, 4), (4.888, 4), (2.886, 4), (1.983, 4)],
        [(207.8, 4), (69.9, 3), (44.2, 3), (31.36, 4), (14.66, 4), (4.289, 4), (2.731, 4), (1.871, 4)],
    ];
    for (name, row) in rates.into_iter().zip(published) {
        let oadev = curve(&outcome, name, "oadev");
        for (tau, (deviation, digits)) in taus.into_iter().zip(row) {
            let m = (tau * 200.0).round() as u64;
            assert_digits(&format!("{name} {tau} s"), oadev[&m] * nrad, deviation, digits);
        }
    }
    assert_eq!((outcome.record.integrity.gaps, outcome.record.recording[0].samples), (0, 72_001));
    assert_digits("mean", value(&outcome, "static_bias", rates[0]) * nrad, 54_067.8, 6);
    // 15.5 nrad/√s read at 10 s, where the deviation has 36 averages: 12 % of standard deviation.
    let n = value(&outcome, "angle_random_walk", rates[0]);
    assert!((n / 5.3e-5 - 1.0).abs() < 0.12, "{n}");
    let lines: Vec<_> = outcome.record.lines.iter().filter(|l| l.channel == rates[0]).collect();
    let nearest = |hz: f64| {
        lines
            .iter()
            .min_by(|a, b| (a.frequency_hz - hz).abs().total_cmp(&(b.frequency_hz - hz).abs()))
            .unwrap()
    };
    for (order, rms) in [173.7, 149.3, 132.1, 118.0, 108.2, 101.1].into_iter().enumerate() {
        let line = nearest(4.1713 * (order + 1) as f64);
        assert!((line.frequency_hz / (order + 1) as f64 - 4.1713).abs() < 0.002, "{}", line.frequency_hz);
        let ours = line.amplitude_deg_h * nrad / 2f64.sqrt();
        assert!((ours / rms - 1.0).abs() < 0.02, "harmonic {}: {ours} against {rms}", order + 1);
    }
    // The author's correction takes the comb away and leaves what has another cause.
    let after = |hz: f64| {
        let near = |l: &&sagnac::record::LineRecord| {
            l.channel == rates[1] && (l.frequency_hz - hz).abs() < 2.0 * l.resolution_hz
        };
        outcome.record.lines.iter().find(near).map(|l| l.amplitude_deg_h)
    };
    let before = nearest(4.1713).amplitude_deg_h;
    assert!(after(4.1713).is_none_or(|a| a < 0.2 * before));
    assert!(after(56.97).is_some());
}

#[test]
fn recordings_that_are_no_rest_are_inspected() {
    let (Some(kvh), Some(table)) = (set("fog_kvh1750_known_angle"), set("fog_fizoptika_rate_table_temp"))
    else {
        return;
    };
    let inspected = |folder: &Path, name: &str| {
        let said = sagnac(folder, &["--lang", "en", "inspect", name]);
        assert_eq!(said.code, 0, "{said:?}");
        said.out
    };
    let text = inspected(&kvh, "direct_imu_rate.csv.gz");
    assert!(text.contains("delta_angle_x_deg") && text.contains("Not at rest"), "{text}");
    let text = inspected(&table, "segments.csv");
    assert!(text.contains("516") && text.contains("rate_table_deg_s"), "{text}");
}
