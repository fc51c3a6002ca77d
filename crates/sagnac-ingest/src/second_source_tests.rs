use super::*;
use crate::english::english;
use crate::open;
use std::ops::ControlFlow;
use std::path::PathBuf;
use tempfile::TempDir;

/// A log of a gyro at 10 Hz and one of a chamber every 5 s, in a folder.
fn bench(
    gyro_stamp: impl Fn(f64) -> String,
    chamber_stamp: impl Fn(f64) -> String,
) -> (TempDir, PathBuf, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let (gyro, chamber) = (folder.path().join("gyro.csv"), folder.path().join("chamber.csv"));
    let at = |i: u32, step_s: f64| f64::from(i) * step_s;
    let noise = |i: u32| (1.7 * f64::from(i)).sin() + (0.37 * f64::from(i * i)).cos();
    let rows: String = (0..1000).map(|i| format!("{},{:.4}\n", gyro_stamp(at(i, 0.1)), noise(i))).collect();
    std::fs::write(&gyro, format!("time_s,rate_dps\n{rows}")).unwrap();
    let rows: String =
        (0..19).map(|i| format!("{},{:.3}\n", chamber_stamp(at(i, 5.0)), 20.0 + at(i, 5.0))).collect();
    std::fs::write(&chamber, format!("time_s,temp_degC\n{rows}")).unwrap();
    (folder, gyro, chamber)
}

fn column(source: &Source, name: &str) -> Vec<f64> {
    let place = source.columns().iter().position(|c| c.name == name).unwrap();
    let mut values = Vec::new();
    source
        .read(&[1, place, place], &mut |block| {
            assert_eq!(block.columns.len(), 3);
            values.extend_from_slice(&block.columns[1]);
            ControlFlow::Continue(())
        })
        .unwrap();
    values
}

fn seconds(t: f64) -> String {
    format!("{t:.3}")
}

#[test]
fn a_slower_file_is_interpolated_at_the_stamps_of_the_recording() {
    let (_folder, gyro, path) = bench(seconds, |t| seconds(t + 1000.0));
    let file = SecondSource { path, offset_s: Some(-1000.0), ..SecondSource::default() };
    let source = beside(open(&gyro).unwrap(), &[file]).unwrap();
    assert_eq!(source.columns().last().unwrap().inferred().role, Role::Temperature);
    let found = column(&source, "temp_degC");
    assert_eq!(found.len(), 1000);
    // The temperature follows the time; the last row of the chamber is of 90 s and holds for a step.
    assert!(found[..900].iter().enumerate().all(|(i, v)| (v - 20.0 - 0.1 * i as f64).abs() < 1e-9));
    assert!(found[940] == 110.0 && found[960].is_nan(), "{:?}", &found[930..970]);
    assert!(english(source.notes().last().unwrap()).contains("-1000"));
}

#[test]
fn a_clock_that_runs_fast_is_followed() {
    // A second of the chamber is 1.01 of the gyro's.
    let (_folder, gyro, path) = bench(seconds, |t| seconds(t / 1.01));
    let file = SecondSource { path, offset_s: Some(0.0), rate: 0.01, ..SecondSource::default() };
    let found = column(&beside(open(&gyro).unwrap(), &[file]).unwrap(), "temp_degC");
    assert!(found[..900].iter().enumerate().all(|(i, v)| (v - 20.0 - 0.1 * i as f64).abs() < 2e-3));
}

#[test]
fn dates_tie_clocks_and_clocks_without_a_tie_are_refused_by_name() {
    let day = |t: f64| format!("2026-03-01T10:{:02}:{:06.3}Z", (t / 60.0).floor(), t % 60.0);
    let (_folder, gyro, path) = bench(day, day);
    let file = SecondSource { path: path.clone(), ..SecondSource::default() };
    let found = column(&beside(open(&gyro).unwrap(), &[file]).unwrap(), "temp_degC");
    assert!((found[500] - 70.0).abs() < 1e-6, "{}", found[500]);

    let (_other, alone, _) = bench(seconds, seconds);
    let refused =
        beside(open(&alone).unwrap(), &[SecondSource { path, ..SecondSource::default() }]).err().unwrap();
    let text = english(&refused.note());
    assert!(
        text.contains("chamber.csv") && text.contains("gyro.csv") && text.contains("--source-offset"),
        "{text}"
    );
}

#[test]
fn files_that_do_not_overlap_are_refused() {
    let (_folder, gyro, path) = bench(|t| seconds(t + 500.0), seconds);
    let file = SecondSource { path, offset_s: Some(0.0), ..SecondSource::default() };
    let refused = beside(open(&gyro).unwrap(), &[file]).err().unwrap();
    assert!(english(&refused.note()).contains("500"), "{}", english(&refused.note()));
}

#[test]
fn a_gap_of_the_slower_file_is_not_bridged() {
    let skip = |t: f64| seconds(if t > 40.0 { t + 60.0 } else { t });
    let (_folder, gyro, path) = bench(seconds, skip);
    let file = SecondSource { path, offset_s: Some(0.0), ..SecondSource::default() };
    let found = column(&beside(open(&gyro).unwrap(), &[file]).unwrap(), "temp_degC");
    assert!(found[390].is_finite() && found[500].is_nan());
}

#[test]
fn a_clock_is_estimated_from_the_angle_of_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let (gyro, path) = (folder.path().join("gyro.csv"), folder.path().join("table.csv"));
    // Rate of the table, deg/s, and its exact angle: turns to and fro that never repeat themselves.
    let rate = |t: f64| 20.0 * (0.3 * t).sin() + 15.0 * (0.11 * t * t.sqrt() / 10.0).cos();
    let noise = |i: u32| (1.7 * f64::from(i)).sin() + (0.37 * f64::from(i) * f64::from(i)).cos();
    let (mut angle, mut angles) = (0.0, vec![0.0]);
    for i in 0..40_000 {
        let at = |j: f64| rate(0.01 * (f64::from(i) + j));
        angle += 0.01 / 6.0 * (at(0.0) + 4.0 * at(0.5) + at(1.0));
        angles.push(angle);
    }
    let rows: String = (0..20_000)
        .map(|i| format!("{:.2},{:.5}\n", 0.02 * f64::from(i), rate(0.02 * f64::from(i)) + 0.01 * noise(i)))
        .collect();
    std::fs::write(&gyro, format!("time_s,rate_dps\n{rows}")).unwrap();
    let rows: String = (0..1950usize)
        .map(|k| {
            format!(
                "{:.2},{:.4}\n",
                5000.0 + 0.2 * k as f64,
                (angles[20 * k + 370] + 0.001 * noise(k as u32)).rem_euclid(360.0)
            )
        })
        .collect();
    std::fs::write(&path, format!("time_s,table_angle_deg,temp_degC\n{}", rows.replace('\n', ",25\n")))
        .unwrap();
    let file = SecondSource { path, estimate: true, ..SecondSource::default() };
    let source = beside(open(&gyro).unwrap(), &[file]).unwrap();
    // The table began 3.7 s after the gyro: -4996.3 s are added to its stamps.
    let said = source.notes().iter().find(|n| n.id == "ingest.beside.read").unwrap();
    let text = english(said);
    let offset: f64 = text.split(": ").find_map(|p| p.split(" s are added").next()?.parse().ok()).unwrap();
    assert!((offset + 4996.3).abs() < 0.002, "{text}");
}
