//! Logs as benches and makers write them: every clock with every unit and layout is read as what it is.

use crate::english::english;
use crate::{ReadOptions, RowMatch, Source, TimeBaseSpec, open, open_with, prepare};
use sagnac_core::recording::{Channel, ColumnRef, Role};
use std::ops::ControlFlow;
use std::path::PathBuf;
use tempfile::TempDir;

/// Rows of a log.
const ROWS: u32 = 600;

/// Interval of the samples, s.
const INTERVAL_S: f64 = 0.02;

/// A log in a file of its own.
fn log(content: &str) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.txt");
    std::fs::write(&path, content).unwrap();
    (folder, path)
}

/// A noise that repeats nothing.
fn noise(i: u32) -> f64 {
    let i = f64::from(i);
    (1.7 * i).sin() + (0.37 * i * i).cos()
}

/// A channel by the name or position of its column, as its column is read.
fn channel(source: &Source, index: usize, role: Role) -> Channel {
    let found = source.columns()[index].inferred();
    assert_eq!(found.role, role, "{}", source.columns()[index].name);
    let column = ColumnRef::Position(index + 1);
    Channel { id: role.id().to_owned(), column, role, unit: found.unit, scale: found.scale }
}

/// The interval by the time column, s.
fn interval_s(source: &Source) -> f64 {
    let time = source.time_column().unwrap_or_else(|| panic!("no time: {:?}", source.columns()));
    let channels = [channel(source, time, Role::Time)];
    let plan = prepare(source, &channels, TimeBaseSpec::default());
    plan.unwrap_or_else(|e| panic!("{}", english(&e.note()))).clock().interval_s
}

/// A clock: its name over the column, and the stamp of a row.
type Clock = (&'static str, fn(u32) -> String);

const CLOCKS: [Clock; 19] = [
    ("time_s", |i| format!("{:.3}", INTERVAL_S * f64::from(i))),
    ("t", |i| format!("{:.3}", 5.0 + INTERVAL_S * f64::from(i))),
    ("Time (ms)", |i| (20 * i).to_string()),
    ("millis", |i| (4711 + 20 * i).to_string()),
    ("timestamp", |i| (12_345_875u64 + 20_000 * u64::from(i)).to_string()),
    ("timestamp", |i| format!("{:.3}", 1_700_000_000.5 + INTERVAL_S * f64::from(i))),
    ("utcTimeMillis", |i| (1_700_000_000_123u64 + 20 * u64::from(i)).to_string()),
    ("timestamp", |i| (1_700_000_000_123u64 + 20 * u64::from(i)).to_string()),
    ("time", |i| (1_700_000_000_123_456u64 + 20_000 * u64::from(i)).to_string()),
    ("%time", |i| (1_700_000_000_123_456_768u64 + 20_000_000 * u64::from(i)).to_string()),
    ("time_usec", |i| (20_000 * i).to_string()),
    ("gps_time_ns", |i| (1_380_000_000_000_000_000u64 + 20_000_000 * u64::from(i)).to_string()),
    ("datenum", |i| format!("{:.10}", 738_000.25 + INTERVAL_S / 86_400.0 * f64::from(i))),
    ("Time", |i| format!("{:.10}", 45_120.5 + INTERVAL_S / 86_400.0 * f64::from(i))),
    ("Time", |i| format!("{:02}:{:05.2}", 57 + i / 3000, INTERVAL_S * f64::from(i % 3000))),
    ("Time", |i| format!("11:43:{:06.3} PM", INTERVAL_S * f64::from(i))),
    ("Date", |i| format!("7/13/2023 11:43:{:06.3} AM", INTERVAL_S * f64::from(i))),
    ("Date", |i| format!("13-Jul-2023 11:43:{:06.3}", INTERVAL_S * f64::from(i))),
    ("Time", |i| format!("11:43:{:02}:{:03}", i / 50, 20 * (i % 50))),
];

/// Units of rates as they stand in names, with the size of 1 deg/s in them.
const RATES: [(&str, f64); 12] = [
    ("Gyro X [rad/s]", std::f64::consts::PI / 180.0),
    ("w_RS_S_x [rad s^-1]", std::f64::consts::PI / 180.0),
    ("wx (rad.s-1)", std::f64::consts::PI / 180.0),
    ("gyro_x_radps", std::f64::consts::PI / 180.0),
    ("UncalGyroXRadPerSec", std::f64::consts::PI / 180.0),
    ("gyro [deg s-1]", 1.0),
    ("Gyro (Degrees/s)", 1.0),
    ("gx_dps", 1.0),
    ("gx (mdps)", 1000.0),
    ("rate [deg/h]", 3600.0),
    ("ang_vel_x [°/s]", 1.0),
    ("rate_mdeg_s", 1000.0),
];

#[test]
fn every_clock_and_every_unit_is_read() {
    for (c, (clock, stamp)) in CLOCKS.iter().enumerate() {
        for (u, (rate, size)) in RATES.iter().enumerate() {
            // Each clock with three units, so that every unit is met with several clocks and separators.
            if (u + c) % 4 != 0 {
                continue;
            }
            let separator = [",", ";", "\t"][(c + u) % 3];
            let rows: String =
                (0..ROWS).map(|i| format!("{}{separator}{:.6}\n", stamp(i), size * noise(i))).collect();
            let (_folder, path) = log(&format!("{clock}{separator}{rate}\n{rows}"));
            let source = open(&path).unwrap();
            let found = interval_s(&source);
            assert!((found / INTERVAL_S - 1.0).abs() < 1e-3, "{clock} {}: {found} s", stamp(1));
            let gyro = channel(&source, 1, Role::Rate);
            let in_deg_s =
                gyro.unit.convert(*size, &sagnac_core::units::Unit::parse("deg/s").unwrap()).unwrap();
            assert!((in_deg_s - 1.0).abs() < 1e-9, "{rate}: {in_deg_s}");
        }
    }
}

#[test]
fn a_unit_of_the_time_that_is_given_counts() {
    let rows: String = (0..ROWS).map(|i| format!("{},{:.4}\n", 20 * i, noise(i))).collect();
    let (_folder, path) = log(&format!("time,rate_dps\n{rows}"));
    for (unit, interval) in [("ms", 0.02), ("us", 2e-5), ("s", 20.0)] {
        let options = ReadOptions { time_unit: Some(unit.to_owned()), ..ReadOptions::default() };
        let found = interval_s(&open_with(&path, &options).unwrap());
        assert!((found / interval - 1.0).abs() < 1e-9, "{unit}: {found}");
    }
    let wrong = ReadOptions { time_unit: Some("furlong".to_owned()), ..ReadOptions::default() };
    assert!(open_with(&path, &wrong).is_err());
}

#[test]
fn clocks_that_no_gyro_has_are_refused() {
    let rows: String = (0..ROWS)
        .map(|i| format!("{},{:.4}\n", 1_700_000_000_000u64 + 20 * u64::from(i), noise(i)))
        .collect();
    let (_folder, path) = log(&format!("time,rate_dps\n{rows}"));
    let options = ReadOptions { time_unit: Some("d".to_owned()), ..ReadOptions::default() };
    let source = open_with(&path, &options).unwrap();
    let channels = [channel(&source, 0, Role::Time)];
    let error = prepare(&source, &channels, TimeBaseSpec::default()).err().unwrap();
    assert!(english(&error.note()).contains("--time-unit"), "{}", english(&error.note()));
}

#[test]
fn seconds_and_nanoseconds_are_one_clock() {
    let rows: String = (0..ROWS)
        .map(|i| format!("{},{},{:.4}\n", 1_700_000_000 + i / 50, 20_000_000 * (i % 50), noise(i)))
        .collect();
    let (_folder, path) = log(&format!("header.stamp.secs,header.stamp.nsecs,rate_dps\n{rows}"));
    let found = interval_s(&open(&path).unwrap());
    assert!((found / INTERVAL_S - 1.0).abs() < 1e-6, "{found}");
}

#[test]
fn one_sensor_of_several_is_read() {
    let of = |i: u32| if i.is_multiple_of(2) { "left" } else { "right" };
    let rows: String =
        (0..ROWS).map(|i| format!("{:.2},{},{}\n", INTERVAL_S * f64::from(i / 2), of(i), i % 2)).collect();
    let (_folder, path) = log(&format!("time_s,sensor,rate_dps\n{rows}"));
    let source = open(&path).unwrap();
    let sensors = source.sensors().unwrap();
    assert_eq!(
        (sensors.column.as_str(), sensors.values.as_slice()),
        ("sensor", ["left", "right"].map(str::to_owned).as_slice())
    );
    let channels = [channel(&source, 0, Role::Time)];
    assert!(prepare(&source, &channels, TimeBaseSpec::default()).is_err());
    for (word, value) in [("left", 0.0), ("right", 1.0)] {
        let only = RowMatch::parse(&format!("sensor={word}"));
        let source = open_with(&path, &ReadOptions { only, ..ReadOptions::default() }).unwrap();
        assert!((interval_s(&source) / INTERVAL_S - 1.0).abs() < 1e-9);
        let mut values = Vec::new();
        let facts = source.read(&[2], &mut |block| {
            values.extend_from_slice(&block.columns[0]);
            ControlFlow::Continue(())
        });
        assert_eq!(facts.unwrap().unwrap().rows, u64::from(ROWS / 2));
        assert!(values.len() == 300 && values.iter().all(|v| *v == value));
    }
    let only = RowMatch::parse("sensor=middle");
    assert!(open_with(&path, &ReadOptions { only, ..ReadOptions::default() }).is_err());
}

#[test]
fn other_formats_of_text_are_read() {
    let json: String = (0..ROWS)
        .map(|i| {
            format!("{{\"t\": {:.2}, \"gyro\": {{\"x_dps\": {:.4}}}}}\n", INTERVAL_S * f64::from(i), noise(i))
        })
        .collect();
    let (_folder, path) = log(&json);
    let source = open(&path).unwrap();
    assert_eq!(source.format(), "json");
    assert!((interval_s(&source) / INTERVAL_S - 1.0).abs() < 1e-9);
    // JSON objects have no order.
    channel(&source, 0, Role::Rate);

    let values: Vec<String> = (0..60).map(|i| format!("{:.5}", 1e-6 * noise(i))).collect();
    let lines: String = values.chunks(6).map(|l| l.join(" ") + "\n").collect();
    let header =
        "TIMESERIES BW_ROMY__BJZ_D, 60 samples, 20 sps, 2026-01-01T00:00:00.000000, SLIST, FLOAT, RAD/S\n";
    let (_folder, path) = log(&format!("{header}{lines}"));
    let source = open(&path).unwrap();
    assert_eq!((source.format(), source.stated_sample_rate_hz()), ("slist", Some(20.0)));
    assert_eq!(source.rows_estimate(), Some(60));
    assert_eq!(source.columns()[0].inferred().unit.text(), "rad/s");

    let raw: String = (0..60)
        .map(|i| {
            let seconds = 425_384.18 + 0.01 * f64::from(i);
            format!("%RAWIMUSA,1105,{seconds:.3};1105,{seconds:.9},111607,43088060,430312,-3033352,-132863,186983,823*5aa97065\n")
        })
        .collect();
    let (_folder, path) = log(&raw);
    let source = open(&path).unwrap();
    assert_eq!((source.format(), source.columns().len()), ("rawimu", 7));
    assert!((interval_s(&source) / 0.01 - 1.0).abs() < 1e-6);
}

#[test]
fn the_header_gives_sizes_of_counts() {
    let rows: String = (0..ROWS).map(|i| format!("{},{}\n", i, (50.0 * noise(i)).round())).collect();
    let (_folder, path) =
        log(&format!("# gyro scale: 131 LSB/(deg/s)\n# sample rate: 50 Hz\nseq,gyro_x\n{rows}"));
    let source = open(&path).unwrap();
    let gyro = source.columns()[1].inferred();
    assert!(gyro.role == Role::Rate && (gyro.scale * 131.0 - 1.0).abs() < 1e-12, "{gyro:?}");
    assert_eq!(
        (source.stated_sample_rate_hz(), source.columns()[0].inferred().role),
        (Some(50.0), Role::Counter)
    );
}
