use super::*;
use crate::effect::Column;
use std::fmt::Write as _;

fn read(text: &str, options: &SeriesOptions) -> Result<Series, SeriesError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("recording.csv");
    std::fs::write(&path, text).unwrap();
    load_series(&[path], options, &mut |_, _| {})
}

/// Rows at 10 Hz with every column of the contract; `edit` changes a line or drops it.
fn contract(rows: usize, edit: impl Fn(usize, String) -> Option<String>) -> String {
    let mut out = String::from(
        "time_s,rate_deg_h,temp_degC,table_rate_deg_s,table_angle_deg,outer_rate_deg_s,supply_v\n",
    );
    for i in 0..rows {
        let line = format!(
            "{:.1},{},{},{},{},{},{}",
            i as f64 / 10.0,
            (i * 37 % 101) as f64 * 0.013 - 3.1,
            20.0 + i as f64 * 0.01,
            0.1 * i as f64,
            (i * 7) % 360,
            -0.2,
            5.0
        );
        if let Some(line) = edit(i, line) {
            let _ = writeln!(out, "{line}");
        }
    }
    out
}

#[test]
fn the_columns_of_the_contract_arrive_in_their_units_to_the_bit() {
    let s = read(&contract(500, |_, l| Some(l)), &SeriesOptions::default()).unwrap();
    assert_eq!(s.time_s.len(), 500);
    assert_eq!(s.time_s[7], 0.7);
    assert_eq!(s.rate_deg_h[1], 37.0 * 0.013 - 3.1);
    assert_eq!(s.columns.len(), 5);
    assert_eq!(s.columns[&Column::Temperature][499], 20.0 + 499.0 * 0.01);
    assert_eq!(s.columns[&Column::TableRate][3], 0.1 * 3.0);
    assert_eq!(s.columns[&Column::TableAngle][100], 340.0);
    assert_eq!(s.columns[&Column::OuterRate][0], -0.2);
    assert_eq!(s.columns[&Column::Supply][0], 5.0);
    assert_eq!((s.faults.rows, s.faults.without_rate, s.faults.without_time), (500, 0, 0));
    assert!((s.sample_interval_s - 0.1).abs() < 1e-9);
    assert_eq!(s.index, (0..500).collect::<Vec<u64>>());
}

#[test]
fn a_column_of_words_is_no_driver() {
    let mut text = String::from("Time [s];Omega_Z [deg/h];Status;Pressure [hPa]\n");
    for i in 0..300 {
        let _ = writeln!(text, "{i};{},5;OK;{},25", 3 + i % 7, 1000 + i % 11);
    }
    let s = read(&text, &SeriesOptions::default()).unwrap();
    let names: Vec<&str> = s.columns.keys().map(|c| c.name()).collect();
    assert_eq!(names, ["Pressure [hPa]"]);
    assert_eq!(s.rate_deg_h[1], 4.5);
}

#[test]
fn rows_that_are_left_out_are_counted_and_gaps_keep_their_places() {
    let text = contract(500, |i, l| match i {
        40 => Some(format!("{},nan,20,0,0,0,5", 4.0)),
        41 => Some(format!("{},,20,0,0,0,5", 4.1)),
        100..=104 => None,
        _ => Some(l),
    });
    let s = read(&text, &SeriesOptions::default()).unwrap();
    assert_eq!((s.faults.rows, s.faults.without_rate, s.faults.missing), (495, 2, 5));
    assert_eq!(s.time_s.len(), 493);
    let at = s.time_s.iter().position(|t| *t == 10.5).unwrap();
    assert_eq!((s.index[at - 1], s.index[at]), (99, 105));
}

#[test]
fn values_beside_that_are_no_numbers_are_interpolated_and_counted() {
    let text = contract(300, |i, l| match i {
        // Angles 343, 350, 357, 4: over the turn.
        49..=51 => Some(format!("{:.1},1,,0.1,,0,5", i as f64 / 10.0)),
        _ => Some(l),
    });
    let s = read(&text, &SeriesOptions::default()).unwrap();
    assert_eq!(s.time_s.len(), 300);
    assert_eq!(s.faults.interpolated[&Column::Temperature], 3);
    let t = &s.columns[&Column::Temperature];
    assert!((t[50] - 20.5).abs() < 1e-12, "{}", t[50]);
    let a = &s.columns[&Column::TableAngle];
    assert!((a[50] - 350.0).abs() < 1e-9 && (a[51] - 357.0).abs() < 1e-9, "{} {}", a[50], a[51]);
}

#[test]
fn other_units_and_other_names_are_converted() {
    let mut text = String::from("t_ms;gyro_deg_s;Temperature (K);note\n");
    for i in 0..200 {
        let _ = writeln!(text, "{};{};{};x", i * 20, 0.001 * (i % 7) as f64, 293.15);
    }
    let s = read(&text, &SeriesOptions::default()).unwrap();
    assert!((s.time_s[10] - 0.2).abs() < 1e-12);
    assert!((s.rate_deg_h[3] - 10.8).abs() < 1e-9);
    assert!((s.columns[&Column::Temperature][0] - 20.0).abs() < 1e-9);
    assert_eq!(s.read_from[1].column, "gyro_deg_s");
    assert_eq!(s.read_from[1].unit, "deg/s");
}

#[test]
fn what_is_not_told_is_asked_for() {
    let mut text = String::from("x_deg_s,y_deg_s\n");
    for i in 0..200 {
        let _ = writeln!(text, "{},{}", (i % 7) as f64, (i % 5) as f64);
    }
    let rates = |name: &str| SeriesOptions {
        rate: Some(name.to_owned()),
        sample_rate_hz: Some(50.0),
        ..SeriesOptions::default()
    };
    let s = read(&text, &rates("y_deg_s")).unwrap();
    assert_eq!((s.rate_deg_h[4], s.time_s[5]), (14400.0, 0.1));
    let refused = read(&text.replace("x_deg_s,y_deg_s", "gx_deg_s,gy_deg_s"), &SeriesOptions::default());
    assert!(refused.unwrap_err().to_string().contains("gx_deg_s, gy_deg_s"));
    let refused = read(&text.replace("x_deg_s,y_deg_s", "a,b"), &SeriesOptions::default()).unwrap_err();
    assert!(refused.to_string().contains("no column looks like"), "{refused}");
    let refused = read(&text.replace("x_deg_s,y_deg_s", "a,rate"), &SeriesOptions::default()).unwrap_err();
    assert!(refused.to_string().contains("--unit"), "{refused}");
}

#[test]
fn smoothing_takes_the_noise_and_leaves_the_course() {
    use crate::noise::model::NoiseModel;
    use crate::noise::simulate::{Setup, Simulator};
    let n = 20_000;
    // 60 N √(1 Hz) is the standard deviation: 0.02.
    let white = NoiseModel { n: 0.02 / 60.0, ..NoiseModel::default() };
    let noise = Simulator::new(&white, &Setup::for_record(3, 1.0, n as u64)).take(n);
    let course = |i: usize| {
        let t = i as f64;
        20.0 + 15.0 * (1.0 - (-t / 3000.0).exp()) + 0.4 * (2.0 * std::f64::consts::PI * t / 1800.0).sin()
    };
    let noisy: Vec<f64> = (0..n).map(|i| course(i) + noise[i]).collect();
    let smoothed = smooth(&noisy);
    let inner = n / 20..n - n / 20;
    let rms = |f: &dyn Fn(usize) -> f64| {
        (inner.clone().map(|i| f(i).powi(2)).sum::<f64>() / inner.len() as f64).sqrt()
    };
    let left = rms(&|i| smoothed[i] - course(i));
    assert!(left < 0.003, "{left}");
    let slope = rms(&|i| (smoothed[i + 1] - smoothed[i]) - (course(i + 1) - course(i)));
    let raw = rms(&|i| (noisy[i + 1] - noisy[i]) - (course(i + 1) - course(i)));
    assert!(slope < 0.01 * raw, "{slope} of {raw}");
    // A course without noise stays what it is.
    let clean: Vec<f64> = (0..n).map(course).collect();
    let kept = smooth(&clean);
    assert!(rms(&|i| kept[i] - clean[i]) < 1e-3);
}
