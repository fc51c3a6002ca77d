//! A micromechanical unit at rest: ADIS16405.

use super::{analyse, assert_digits, curve, table, value};
use crate::support::real::set;
use crate::support::{result, sagnac};
use sagnac::acceptance::Outcome;
use std::path::Path;

const ADIS_AXES: [&str; 3] = ["rate_x_deg_s", "rate_y_deg_s", "rate_z_deg_s"];

fn adis(folder: &Path, recording: usize) -> Outcome {
    analyse(&folder.join(format!("unit{recording}.parquet")), Ok("time_s"), &ADIS_AXES, "deg/s", None)
}

/// Overlapping Allan deviation in deg/h at octaves from 0.01 s: recordings 1 and 2, axes x, y, z.
const ADIS_CURVES: [[f64; 6]; 19] = [
    [1149.0, 1213.0, 1386.0, 1145.0, 1209.0, 1373.0],
    [926.9, 978.5, 1382.0, 923.5, 975.4, 1381.0],
    [694.0, 731.3, 684.7, 690.2, 728.1, 694.0],
    [502.3, 528.2, 531.5, 500.6, 529.0, 537.9],
    [360.2, 378.2, 347.3, 357.9, 377.8, 343.6],
    [256.2, 270.4, 246.1, 254.8, 268.7, 244.7],
    [183.8, 192.2, 172.1, 181.4, 191.9, 172.2],
    [130.0, 137.1, 124.4, 129.3, 137.1, 121.8],
    [93.20, 97.34, 87.95, 91.50, 98.19, 86.02],
    [65.89, 71.38, 62.50, 65.86, 71.49, 61.09],
    [47.54, 53.89, 46.01, 48.33, 55.16, 46.78],
    [36.07, 41.56, 35.70, 37.22, 43.02, 37.68],
    [29.79, 33.09, 30.45, 31.65, 37.26, 33.63],
    [25.43, 30.28, 29.13, 31.86, 33.74, 32.93],
    [27.51, 30.34, 31.37, 35.01, 37.03, 36.24],
    [27.96, 32.97, 33.31, 34.28, 40.34, 40.87],
    [22.08, 42.97, 47.86, 32.60, 45.59, 43.12],
    [18.77, 49.04, 66.49, 36.20, 49.30, 52.45],
    [20.60, 73.82, 74.93, 42.12, 53.98, 58.82],
];

/// N in deg/√h read off the −1/2 slope of the curve, minimum of the curve over 0.664 in deg/h, and the τ it stands at, s.
const ADIS_SUMMARY: [[(f64, f64, f64); 3]; 4] = [
    [(2.451, 28.3, 1311.0), (2.563, 45.6, 82.0), (2.345, 43.9, 82.0)],
    [(2.419, 47.7, 41.0), (2.546, 50.8, 82.0), (2.300, 49.6, 82.0)],
    [(2.503, 23.3, 2621.0), (2.605, 30.9, 2621.0), (2.378, 40.3, 328.0)],
    [(2.514, 37.7, 655.0), (2.620, 50.7, 82.0), (2.416, 36.4, 2621.0)],
];

/// Mean and standard deviation of 100-s means, deg/s, of axes x, y, z.
const ADIS_MEANS: [[(f64, f64); 3]; 4] = [
    [(0.401686, 0.012632), (-0.415849, 0.024893), (-0.293542, 0.025086)],
    [(0.378900, 0.022666), (-0.436374, 0.026314), (-0.271596, 0.023701)],
    [(0.351262, 0.011094), (-0.427151, 0.013494), (-0.285648, 0.019394)],
    [(0.390830, 0.016763), (-0.453661, 0.020607), (-0.271185, 0.016844)],
];

#[test]
fn adis16405_gives_the_numbers_of_other_tools() {
    let Some(folder) = set("mems_adis16405_static") else { return };
    for recording in 1..=4 {
        let outcome = adis(&folder, recording);
        let integrity = &outcome.record.integrity;
        assert_eq!((integrity.gaps, integrity.non_finite, integrity.stuck), (0, 0, 0));
        // The step of the converter, 0.05 deg/s.
        assert!((integrity.quantization_step_deg_h.unwrap() - 180.0).abs() < 1e-6);
        for (axis, name) in ADIS_AXES.into_iter().enumerate() {
            let oadev = curve(&outcome, name, "oadev");
            if recording <= 2 {
                for (octave, row) in ADIS_CURVES.iter().enumerate() {
                    let published = row[3 * (recording - 1) + axis];
                    assert_digits(
                        &format!("{recording} {name} {octave}"),
                        oadev[&(1 << octave)],
                        published,
                        4,
                    );
                }
            }
            let (mean, drift) = ADIS_MEANS[recording - 1][axis];
            assert!((value(&outcome, "static_bias", name) / 3600.0 - mean).abs() < 1e-6);
            assert!((value(&outcome, "russian_drift_100s", name) / 3600.0 - drift).abs() < 1e-6);
            let (n_read, floor, at_s) = ADIS_SUMMARY[recording - 1][axis];
            let n_at = oadev[&128] * 1.28f64.sqrt() / 60.0;
            // A reading of the curve holds the flicker as well. Without it, the one at 1.28 s is N to 2.5 %.
            let n = value(&outcome, "angle_random_walk", name);
            // Where a Markov process stands in place of flicker, it is in the model.
            let model = outcome.record.noise_models.iter().find(|m| m.channel == name).expect("a model");
            let slow = |d: &[f64; 2]| {
                sagnac::noise::composite::Damped { rms_deg_h: d[0], frequency_hz: 0.0, decay_time_s: d[1] }
                    .allan_variance(1.28)
            };
            let flicker = (0.664 * model.bias_instability).powi(2);
            let freed = n_at.powi(2) - (flicker + model.markov.iter().map(slow).sum::<f64>()) * 1.28 / 3600.0;
            let freed = freed.sqrt();
            assert!((n / freed - 1.0).abs() < 0.025, "{recording} {name}: {n} against {freed}");
            // The reading itself scatters by 0.8 % (7800 clusters of 1.28 s), the flicker in it raises it by 1 to 2 %.
            let near = n < 1.008 * n_read && n > 0.97 * n_read;
            assert!(near, "{recording} {name}: {n} against {n_read}");
            // Beyond a fifth of the record the minimum is not looked for.
            if at_s < 2000.0 {
                let scaled = value(&outcome, "bias_instability_minimum_scaled", name);
                // Published with 0.664 in place of √(2 ln 2/π).
                assert!((scaled / floor - 1.0).abs() < 2e-3, "{recording} {name}: {scaled} against {floor}");
            }
        }
        // No line above six times the floor in any of them.
        assert!(outcome.record.lines.iter().all(|l| l.excess < 6.0));
        if recording < 4 {
            assert_eq!(integrity.outliers, 0);
        } else {
            // Fourteen spikes beyond eight standard deviations, twelve of them on x; more above our threshold.
            let on = |axis: &str| {
                let of_axis = |f: &&sagnac::record::FaultRecord| {
                    f.kind == "outlier" && f.channel.as_deref() == Some(axis)
                };
                integrity.faults.iter().filter(of_axis).map(|f| f.count).sum::<u64>()
            };
            assert!(on(ADIS_AXES[0]) >= 12 && on(ADIS_AXES[1]) >= 2 && on(ADIS_AXES[2]) == 0);
            assert!((14..=30).contains(&integrity.outliers), "{}", integrity.outliers);
        }
    }
}

#[test]
fn adis16405_agrees_with_the_curve_published_in_the_avar_package() {
    let (Some(folder), Some(curves)) = (set("mems_adis16405_static"), set("ref_allan_curves_ln200_kvh1750"))
    else {
        return;
    };
    let outcome = adis(&folder, 1);
    let mut compared = 0;
    for row in table(&curves.join("adev_curves.csv")) {
        if row["device"] != "ADIS16405" || !row["sensor"].starts_with("gyro") {
            continue;
        }
        let m = (row["tau_s"].parse::<f64>().unwrap() * 100.0).round() as u64;
        let name = format!("rate_{}_deg_s", row["axis"].to_lowercase());
        let published: f64 = row["adev"].parse().unwrap();
        let ours = curve(&outcome, &name, "oadev")[&m] / 3600.0;
        assert!((ours / published - 1.0).abs() < 4e-6, "{name} m {m}: {ours} against {published}");
        compared += 1;
    }
    assert_eq!(compared, 54);
}

#[test]
fn the_command_line_gives_the_same() {
    let Some(folder) = set("mems_adis16405_static") else { return };
    let place = tempfile::tempdir().unwrap();
    let out = place.path().join("out");
    let recording = folder.join("unit1.parquet");
    let said = sagnac(place.path(), &["analyze", &recording.to_string_lossy(), "--out", "out"]);
    assert_eq!(said.code, 0, "{said:?}");
    let result = result(&out);
    assert_eq!(result["verdict"], "none");
    assert_eq!(result["recording"][0]["samples"], 1_000_000);
    let rows = table(&out.join("sigma_tau_rate_x_deg_s.csv"));
    let at = |m: &str| -> f64 {
        let row = rows.iter().find(|r| r["estimator"] == "oadev" && r["m"] == m).unwrap();
        row["deviation_deg_h"].parse().unwrap()
    };
    for (octave, row) in ADIS_CURVES.iter().enumerate() {
        assert_digits("x", at(&(1u64 << octave).to_string()), row[0], 4);
    }
    for file in ["report.html", "report.md"] {
        assert!(out.join(file).is_file());
    }
}
