//! Public recordings of real instruments against the numbers that were published or computed elsewhere for them.
//!
//! The recordings are not part of this repository (`docs/real-data.md` says where they are). The tests read the folder
//! named by `SAGNAC_REAL_DATA`; without it they say on stderr that they were skipped:
//!
//! `SAGNAC_REAL_DATA=... cargo test --release --test real_data -- --nocapture`

use sagnac::ingest::{Source, open};
use sagnac::noise::allan::{AllanAccumulator, AllanPlan};
use sagnac::noise::family::Estimator;
use sagnac::noise::tau_grid::TauGrid;
use sagnac::procedure::EffectiveLimits;
use sagnac::record::UnitUnderTest;
use sagnac::recording::{Channel, ColumnRef, Role};
use sagnac::run::{Outcome, Request, analysis, execute};
use sagnac::units::Unit;
use std::collections::BTreeMap;
use std::io::Write as _;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// The folder of a data set, or `None` with a visible line.
fn set(name: &str) -> Option<PathBuf> {
    match std::env::var_os("SAGNAC_REAL_DATA") {
        Some(folder) => {
            let path = Path::new(&folder).join(name);
            assert!(path.is_dir(), "SAGNAC_REAL_DATA is set, but {} is not there", path.display());
            Some(path)
        }
        None => {
            let _ = writeln!(std::io::stderr(), "SKIPPED: {name}: SAGNAC_REAL_DATA is not set");
            None
        }
    }
}

fn channel(column: &str, role: Role, unit: &str) -> Channel {
    let column_ref = ColumnRef::Name(column.into());
    Channel { id: column.into(), column: column_ref, role, unit: Unit::parse(unit).unwrap(), scale: 1.0 }
}

/// A whole analysis: `time` names the column of stamps, else the sample rate holds.
fn analyse(
    file: &Path,
    time: Result<&str, f64>,
    rates: &[&str],
    unit: &str,
    taus: Option<&[f64]>,
) -> Outcome {
    let source = open(file).unwrap();
    let mut channels: Vec<Channel> = time.iter().map(|t| channel(t, Role::Time, "s")).collect();
    channels.extend(rates.iter().map(|r| channel(r, Role::Rate, unit)));
    let procedure = analysis::procedure(channels, time.err(), 0.0);
    let request = Request {
        kind: "analyze",
        procedure: &procedure,
        procedure_record: None,
        limits: &EffectiveLimits::default(),
        source: &source,
        use_stamps: time.is_ok(),
        unit: UnitUnderTest::default(),
        operator: None,
        station: None,
        now: chrono::DateTime::UNIX_EPOCH,
        taus: taus.map(|t| TauGrid::List(t.to_vec())),
        exact: false,
    };
    execute(&request, &mut |_, _| {}).unwrap()
}

/// σ(τ) of one estimator by averaging factor, from the table that is written for a channel.
fn curve(outcome: &Outcome, channel: &str, estimator: &str) -> BTreeMap<u64, f64> {
    let named = format!("sigma_tau_{channel}.csv");
    let (_, table) =
        outcome.tables.iter().find(|(name, _)| *name == named || name == "sigma_tau.csv").expect("a table");
    let rows = table.lines().skip(1).map(|line| line.split(',').collect::<Vec<_>>());
    rows.filter(|f| f[0] == estimator).map(|f| (f[2].parse().unwrap(), f[5].parse().unwrap())).collect()
}

fn value(outcome: &Outcome, id: &str, channel: &str) -> f64 {
    let row = outcome.record.measurands.iter().find(|m| m.id == id && m.channel == channel).expect(id);
    row.value.unwrap_or_else(|| panic!("{id} of {channel} has no value"))
}

/// Asserts agreement within half a unit of the `digits`-th significant digit of the published number.
fn assert_digits(what: &str, ours: f64, published: f64, digits: i32) {
    let unit = 10f64.powi(published.abs().log10().floor() as i32 + 1 - digits);
    assert!((ours - published).abs() <= 0.5001 * unit, "{what}: {ours} against {published}");
}

/// Two columns of a file.
fn columns(file: &Path, names: &[&str]) -> Vec<Vec<f64>> {
    let source: Source = open(file).unwrap();
    let wanted: Vec<usize> =
        names.iter().map(|n| source.resolve(&ColumnRef::Name((*n).into())).unwrap()).collect();
    let mut out = vec![vec![]; names.len()];
    source
        .read(&wanted, &mut |block| {
            for (all, part) in out.iter_mut().zip(&block.columns) {
                all.extend_from_slice(part);
            }
            ControlFlow::Continue(())
        })
        .unwrap();
    out
}

/// Rows of a small text table without quotes, by header.
fn table(file: &Path) -> Vec<BTreeMap<String, String>> {
    let text = std::fs::read_to_string(file).unwrap();
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    lines
        .map(|line| header.iter().zip(line.split(',')).map(|(h, f)| ((*h).into(), f.into())).collect())
        .collect()
}

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
            let b = value(&outcome, "bias_instability", name);
            let freed = (n_at.powi(2) - (0.664 * b).powi(2) * 1.28 / 3600.0).sqrt();
            assert!((n / freed - 1.0).abs() < 0.025, "{recording} {name}: {n} against {freed}");
            assert!(n < n_read && n > 0.97 * n_read, "{recording} {name}: {n} against {n_read}");
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

/// Overlapping Allan deviation in deg/h at octaves of the sample interval: down x, y, z, up x, y, z.
const LN100_CURVES: [[f64; 6]; 13] = [
    [210.0, 173.3, 266.7, 208.7, 177.6, 269.0],
    [67.49, 122.3, 66.33, 65.89, 122.9, 62.67],
    [35.16, 91.06, 34.17, 36.20, 92.63, 33.47],
    [19.80, 16.70, 21.67, 19.26, 16.51, 21.25],
    [13.13, 18.51, 17.14, 13.24, 18.09, 17.35],
    [4.877, 10.61, 4.892, 4.885, 11.29, 4.672],
    [1.597, 2.904, 1.342, 1.580, 2.091, 1.263],
    [1.127, 2.735, 1.124, 1.242, 2.515, 1.270],
    [0.6880, 0.8147, 0.8563, 0.8443, 1.108, 1.098],
    [0.3620, 0.5500, 0.4395, 0.2764, 0.7141, 0.2695],
    [0.1792, 0.2490, 0.2348, 0.1240, 0.1282, 0.1382],
    [0.07533, 0.1381, 0.08782, 0.09949, 0.1538, 0.1313],
    [0.0454, 0.07557, 0.0613, 0.04018, 0.07751, 0.04989],
];

#[test]
fn ln100_shows_the_earth_in_two_positions() {
    let Some(folder) = set("rlg_ln100_two_position") else { return };
    let axes = ["rate_x_deg_h", "rate_y_deg_h", "rate_z_deg_h"];
    let run = |name: &str| analyse(&folder.join(name), Ok("time_s"), &axes, "deg/h", None);
    let (down, up) = (run("x_down.parquet"), run("x_up.parquet"));
    let means = [[-11.9862, 9.125, -0.726], [11.4786, 9.187, 1.250]];
    for (half, (outcome, samples)) in [(&down, 19_216), (&up, 19_217)].into_iter().enumerate() {
        assert_eq!((outcome.record.recording[0].samples, outcome.record.integrity.gaps), (samples, 0));
        for (axis, name) in axes.into_iter().enumerate() {
            let bias = value(outcome, "static_bias", name);
            assert!((bias - means[half][axis]).abs() < 6e-4, "{name}: {bias}");
            let oadev = curve(outcome, name, "oadev");
            for (octave, row) in LN100_CURVES.iter().enumerate() {
                assert_digits(&format!("{name} {octave}"), oadev[&(1 << octave)], row[3 * half + axis], 3);
            }
        }
        // 33 µs rms of the steps are √2 times the jitter of a stamp.
        let jitter = outcome.record.integrity.timestamp_jitter_s.unwrap();
        assert!((jitter * 2f64.sqrt() / 33e-6 - 1.0).abs() < 0.05, "{jitter}");
        // Published to a bin of 0.06 Hz.
        for hz in [9.195, if half == 0 { 29.93 } else { 29.90 }] {
            assert!(outcome.record.lines.iter().any(|l| (l.frequency_hz - hz).abs() < 0.06), "{hz} Hz");
        }
    }
    let x = |outcome| value(outcome, "static_bias", axes[0]);
    assert!((0.5 * (x(&up) - x(&down)) - 11.7324).abs() < 1e-4);
    assert!((0.5 * (x(&up) + x(&down)) + 0.254).abs() < 5e-4);
}

#[test]
fn astro_pi_with_and_without_its_gaps() {
    let Some(folder) = set("mems_astropi_68h_temperature") else { return };
    let axes = ["gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s"];
    let taus = [10.0, 100.0, 1000.0];
    let micro = 1e6 * std::f64::consts::PI / 180.0 / 3600.0;
    let published = [
        ("part_b_warming_day", [(151.7, 110.8, 48.9), (989.0, 341.5, 113.4), (129.7, 92.9, 42.1)]),
        ("part_d_cool_days", [(147.9, 110.3, 60.5), (1460.0, 463.1, 146.4), (130.8, 94.7, 50.3)]),
    ];
    for (part, rows) in published {
        let file = folder.join(format!("{part}.csv.gz"));
        // The published deviations take the readings as evenly spaced.
        let plain = analyse(&file, Err(0.1), &axes, "rad/s", Some(&taus));
        for (name, (at10, at100, at1000)) in axes.into_iter().zip(rows) {
            let oadev = curve(&plain, name, "oadev");
            for (m, deviation) in [(1, at10), (10, at100), (100, at1000)] {
                let ours = oadev[&m] * micro;
                assert!(
                    (ours - deviation).abs() <= 0.051 * (deviation / 100.0).max(1.0),
                    "{part} {name} {m}: {ours}"
                );
            }
        }
        // With the stamps, every step of 20 s is a gap of one reading.
        let stamps = columns(&file, &["t_s"]).remove(0);
        let steps = stamps.windows(2).filter(|w| w[1] - w[0] > 15.0).count() as u64;
        let stamped = analyse(&file, Ok("t_s"), &axes, "rad/s", None);
        let integrity = &stamped.record.integrity;
        assert!(steps > 0);
        assert_eq!((integrity.gaps, integrity.missing_samples), (steps, steps));
        assert_eq!((integrity.duplicate_timestamps, integrity.backward_timestamps), (0, 0));
    }
}

/// Largest relative difference from Stable32 for a statistic of one of its files.
fn against_stable32(folder: &Path, file: &str, rate: &[f64], statistic: &str, estimator: Estimator) -> f64 {
    let wanted: Vec<(u64, f64)> = table(&folder.join("stable32_reference.csv"))
        .iter()
        .filter(|r| r["file"] == file && r["statistic"] == statistic)
        .map(|r| (r["averaging_factor"].parse().unwrap(), r["sigma"].parse().unwrap()))
        .collect();
    assert!(wanted.len() >= 8, "{file} {statistic}");
    let mut allan = AllanAccumulator::new(AllanPlan {
        tau0_s: 1.0,
        grid: TauGrid::List(wanted.iter().map(|w| w.0 as f64).collect()),
        exact: true,
        estimators: vec![estimator],
    });
    allan.push(rate, 0, false);
    let set = allan.finish();
    let points = &set.curve(estimator).unwrap().points;
    let mut worst: f64 = 0.0;
    for (m, sigma) in wanted {
        let ours = points.iter().find(|p| p.m == m).unwrap_or_else(|| panic!("{file} {statistic} m {m}"));
        worst = worst.max((ours.deviation / sigma - 1.0).abs());
    }
    println!("{file} {statistic}: {worst:.1e}");
    worst
}

#[test]
fn clock_data_gives_the_numbers_of_stable32() {
    let Some(folder) = set("ref_stable32_frequency_data") else { return };
    let steps = |file: &str| {
        let phase = columns(&folder.join(file), &["phase_s"]).remove(0);
        phase.windows(2).map(|w| w[1] - w[0]).collect::<Vec<f64>>()
    };
    let ocxo: Vec<f64> = columns(&folder.join("ocxo_frequency.csv.gz"), &["freq_hz"])
        .remove(0)
        .into_iter()
        .map(|f| (f - 1e7) / 1e7)
        .collect();
    let files = [
        ("cs5071a_phase", steps("cs5071a_phase.csv.gz"), 1e-4),
        ("phase_dat", steps("phase_dat.csv"), 1e-4),
        ("tic53230a_phase", steps("tic53230a_phase.csv.gz"), 1e-4),
        // Stable32 was fed differently rounded data there.
        ("ocxo_frequency", ocxo, 2e-3),
    ];
    for (file, rate, tolerance) in files {
        for (statistic, estimator) in
            [("oadev", Estimator::Allan), ("mdev", Estimator::Modified), ("ohdev", Estimator::Hadamard)]
        {
            let worst = against_stable32(&folder, file, &rate, statistic, estimator);
            assert!(worst < tolerance, "{file} {statistic}: {worst:e}");
        }
    }
}

fn sagnac(arguments: &[&std::ffi::OsStr]) -> String {
    let output = assert_cmd::Command::cargo_bin("sagnac").unwrap().args(arguments).output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{text}{}", String::from_utf8_lossy(&output.stderr));
    text
}

#[test]
fn the_command_line_gives_the_same() {
    let Some(folder) = set("mems_adis16405_static") else { return };
    let place = tempfile::tempdir().unwrap();
    let out = place.path().join("out");
    sagnac(&["analyze".as_ref(), folder.join("unit1.parquet").as_ref(), "--out".as_ref(), out.as_ref()]);
    let result: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(out.join("result.json")).unwrap()).unwrap();
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

#[test]
fn recordings_that_are_no_rest_are_inspected() {
    let (Some(kvh), Some(table)) = (set("fog_kvh1750_known_angle"), set("fog_fizoptika_rate_table_temp"))
    else {
        return;
    };
    let text = sagnac(&["inspect".as_ref(), kvh.join("direct_imu_rate.csv.gz").as_ref()]);
    assert!(text.contains("delta_angle_x_deg") && text.contains("Not at rest"), "{text}");
    let text = sagnac(&["inspect".as_ref(), table.join("segments.csv").as_ref()]);
    assert!(text.contains("516") && text.contains("rate_table_deg_s"), "{text}");
}
