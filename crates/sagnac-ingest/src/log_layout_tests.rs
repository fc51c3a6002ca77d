//! Logs of many layouts: what is read from each is right, or a question names what must be told.

use crate::english::english;
use crate::{ReadOptions, Source, TimeBaseSpec, open_with, prepare};
use sagnac_core::recording::{Channel, ColumnRef, SampleBlock, Sink};
use std::fmt::Write;

/// Rows of a log.
const ROWS: u32 = 400;

/// Rate of the samples, Hz.
const RATE_HZ: f64 = 50.0;

/// What the log of a gyro with a mean of 2 deg/s shows.
enum Expected {
    /// Sample rate and mean are read.
    Right,
    /// Mean is read; no clock is told.
    NoClock,
    /// No unit of a rate is told: the column is taken for one, with its unit open.
    UnitOpen,
    /// No column is a gyro's by name or value.
    NoGyro,
    /// Reading is refused with these words.
    Question(&'static str),
}

/// Rate of a row, deg/s.
fn rate(i: u32) -> f64 {
    let i = f64::from(i);
    2.0 + 0.3 * (1.7 * i).sin() + 0.2 * (0.37 * i * i).cos()
}

fn time(i: u32) -> f64 {
    f64::from(i) / RATE_HZ
}

/// A log: what stands above, and each row.
fn log(above: &str, row: impl Fn(u32) -> String) -> String {
    let mut out = above.to_owned();
    (0..ROWS).for_each(|i| out.push_str(&row(i)));
    out
}

fn gyro_of(source: &Source) -> Option<usize> {
    source.columns().iter().position(|c| c.numeric && c.inferred().role.is_gyro())
}

/// Rate of the samples, Hz, and mean, deg/s, of the first gyro column; the question where the file is refused.
fn read(text: &str, options: &ReadOptions) -> Result<(Option<f64>, Option<f64>, bool), String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.txt");
    std::fs::write(&path, text).unwrap();
    let source = open_with(&path, options).map_err(|e| english(&e.note()))?;
    let Some(gyro) = gyro_of(&source) else { return Ok((None, None, false)) };
    let channel = |index: usize, id: &str| {
        let found = source.columns()[index].inferred();
        let column = ColumnRef::Position(index + 1);
        Channel { id: id.to_owned(), column, role: found.role, unit: found.unit, scale: found.scale }
    };
    let mut channels = vec![channel(gyro, "gyro")];
    channels.extend(source.time_column().map(|t| channel(t, "time")));
    let named = source.columns()[gyro].inferred().unit_is_named;
    let plan = match prepare(&source, &channels, TimeBaseSpec::default()) {
        Ok(plan) => plan,
        Err(e) if source.time_column().is_none() => {
            // Without a clock the values are still what they are.
            let declared = TimeBaseSpec { declared_sample_rate_hz: Some(RATE_HZ), ..TimeBaseSpec::default() };
            assert!(!english(&e.note()).is_empty());
            return Ok((None, Some(mean(&prepare(&source, &channels, declared).unwrap())), named));
        }
        Err(e) => return Err(english(&e.note())),
    };
    Ok((Some(1.0 / plan.clock().interval_s), Some(mean(&plan)), named))
}

/// Mean of the gyro, deg/s.
fn mean(plan: &crate::Plan<'_>) -> f64 {
    let mut sink = Mean::default();
    plan.stream(&mut [&mut sink], &mut |_, _| {}).unwrap();
    sink.sum / sink.count / 3600.0
}

#[derive(Default)]
struct Mean {
    sum: f64,
    count: f64,
}

impl Sink for Mean {
    fn push(&mut self, block: &SampleBlock<'_>) {
        for v in block.values.first().into_iter().flat_map(|c| c.iter()).filter(|v| v.is_finite()) {
            self.sum += v;
            self.count += 1.0;
        }
    }
}

/// A log with how it must be read.
struct Log {
    what: &'static str,
    text: String,
    expected: Expected,
}

/// A log of which rate and mean are read.
fn right(what: &'static str, above: &str, row: impl Fn(u32) -> String) -> Log {
    Log { what, text: log(above, row), expected: Expected::Right }
}

/// A log that is read in another way than rate and mean.
fn other(what: &'static str, expected: Expected, above: &str, row: impl Fn(u32) -> String) -> Log {
    Log { what, text: log(above, row), expected }
}

/// Counts of 131 in 1 deg/s.
fn counts(i: u32) -> i64 {
    (131.0 * rate(i)).round() as i64
}

/// Layouts of delimited text.
fn of_text() -> Vec<Log> {
    vec![
        right(
            "title, entries, names, units",
            "Gyro test 7\nOperator: A. B.\n\ntime\tgyro\ns\tdeg/s\n",
            |i| format!("{:.2}\t{:.5}\n", time(i), rate(i)),
        ),
        right(
            "decimal comma, Russian",
            "Время, с;Угловая скорость, град/с\n",
            |i| format!("{:.2};{:.5}\n", time(i), rate(i)).replace('.', ","),
        ),
        right("byte-order mark and quotes", "\u{feff}\"time_s\",\"gyro_dps\"\r\n", |i| {
            format!("\"{:.2}\",\"{:.5}\"\r\n", time(i), rate(i))
        }),
        right("delimiter at the end of rows", "time_s,gyro_dps,\n", |i| {
            format!("{:.2},{:.5},\n", time(i), rate(i))
        }),
        right("columns of blanks", "  time_s    gyro_dps\n", |i| {
            format!("{:9.2} {:11.5}\n", time(i), rate(i))
        }),
        right("bars", "time_s | gyro_dps\n", |i| format!("{:.2} | {:.5}\n", time(i), rate(i))),
        right("comments between rows", "# bench 2\ntime_s,gyro_dps\n", |i| {
            let remark = if i % 100 == 99 { "# operator pressed a key\n" } else { "" };
            format!("{:.2},{:.5}\n{remark}", time(i), rate(i))
        }),
        right("date and time in two columns", "Date,Time,gyro_dps\n", |i| {
            format!("2026-03-01,10:00:{:06.3},{:.5}\n", time(i), rate(i))
        }),
        right("week and seconds of week", "gps_week,gps_sow,gyro_dps\n", |i| {
            format!("2300,{:.2},{:.5}\n", 302_400.0 + time(i), rate(i))
        }),
        right("milliseconds as whole numbers", "time_ms,gyro_dps\n", |i| {
            format!("{},{:.5}\n", 20 * i, rate(i))
        }),
        right("microseconds that wrap at 32 bits", "time_us,gyro_dps\n", |i| {
            format!("{},{:.5}\n", (4_294_000_000u64 + 20_000 * u64::from(i)) % (1 << 32), rate(i))
        }),
        right("accelerations beside", "t,ax,ay,az,gx_dps,gy_dps,gz_dps\n", |i| {
            format!("{:.2},0.01,0.02,9.81,{:.5},{:.5},0.1\n", time(i), rate(i), rate(i + 7))
        }),
        right("quaternions beside", "time_s,qw,qx,qy,qz,gyro_dps\n", |i| {
            format!("{:.2},1,0,0,0,{:.5}\n", time(i), rate(i))
        }),
        right("Fahrenheit beside", "time_s,gyro_dps,Temp (F)\n", |i| {
            format!("{:.2},{:.5},77.1\n", time(i), rate(i))
        }),
        right("empty lines between rows", "time_s,gyro_dps\n", |i| {
            format!("{:.2},{:.5}\n{}", time(i), rate(i), if i % 50 == 0 { "\n" } else { "" })
        }),
        right("names in quotes with commas", "\"Time, s\",\"Gyro, deg/s\"\n", |i| {
            format!("{:.2},{:.5}\n", time(i), rate(i))
        }),
        right("numbers in exponents", "time_s,gyro_dps\n", |i| format!("{:e},{:e}\n", time(i), rate(i))),
        right("erased memory at the end", "time_s,gyro_dps\n", |i| {
            let end = if i + 1 == ROWS { "4294967.295,nan\n".repeat(100) } else { String::new() };
            format!("{:.2},{:.5}\n{end}", time(i), rate(i))
        }),
        right("time of day across midnight", "time,gyro_dps\n", |i| {
            let s = (86_396.0 + time(i)) % 86_400.0;
            let (h, m) = ((s / 3600.0).floor(), (s % 3600.0 / 60.0).floor());
            format!("{h:02}:{m:02}:{:06.3},{:.5}\n", s % 60.0, rate(i))
        }),
        right("remarks left out of rows", "time_s\tgyro_dps\tComment\n", |i| {
            format!("{:.2}\t{:.5}\n", time(i), rate(i))
        }),
    ]
}

/// Logs whose header says what the columns do not.
fn of_headers() -> Vec<Log> {
    vec![
        right("rate in the header", "# Sample rate: 50 Hz\ngyro_dps,temp_degC\n", |i| {
            format!("{:.5},25\n", rate(i))
        }),
        right("interval in the header", "# dt = 0.02 s\ngyro_dps,temp_degC\n", |i| {
            format!("{:.5},25\n", rate(i))
        }),
        right("no time values, rate in the header", "# Update Rate: 50.0Hz\ntime,gyro_dps\n", |i| {
            format!("NaN,{:.5}\n", rate(i))
        }),
        right("size of a count in the header", "# gyro scale: 131 LSB/(deg/s)\ntime_s,gyro_x\n", |i| {
            format!("{:.2},{}\n", time(i), counts(i))
        }),
        right(
            "sensitivity in the header",
            "# Gyro sensitivity: 7.633587786 mdps/LSB\ntime_s,gyro_x\n",
            |i| format!("{:.2},{}\n", time(i), counts(i)),
        ),
        right("unit in the header", "# gyro unit: deg/s\ntime_s,gyro_x\n", |i| {
            format!("{:.2},{:.5}\n", time(i), rate(i))
        }),
        right("increments and a rate", "# Sample rate: 50 Hz\nseq,dtheta_x [arcsec]\n", |i| {
            format!("{i},{:.4}\n", 3600.0 * rate(i) / RATE_HZ)
        }),
        other("no clock at all", Expected::NoClock, "gyro_dps,temp_degC\n", |i| {
            format!("{:.5},25\n", rate(i))
        }),
        other("no unit at all", Expected::UnitOpen, "time_s,gyro_x\n", |i| {
            format!("{:.2},{:.5}\n", time(i), rate(i))
        }),
        other("no names at all", Expected::NoGyro, "", |i| format!("{:.2},{:.5}\n", time(i), rate(i))),
        other("counts without a size", Expected::NoGyro, "time_s,gyro_x_raw\n", |i| {
            format!("{:.2},{}\n", time(i), counts(i))
        }),
        other("three units in turns", Expected::Question("--where imu=0"), "time_s,imu,gyro_dps\n", |i| {
            format!("{:.2},{},{:.5}\n", time(i / 3), i % 3, rate(i))
        }),
        other("words in turns", Expected::Question("--where sensor=left"), "time_s,sensor,gyro_dps\n", |i| {
            format!("{:.2},{},{:.5}\n", time(i / 2), if i % 2 == 0 { "left" } else { "right" }, rate(i))
        }),
    ]
}

/// Logs that are no table of text.
fn of_other_formats() -> Vec<Log> {
    let object = |i: u32| {
        format!("{{\"ts_ms\": {}, \"gyro_dps\": {:.5}}}", 1_700_000_000_000u64 + 20 * u64::from(i), rate(i))
    };
    let all: Vec<String> = (0..ROWS).map(object).collect();
    let samples: Vec<String> = (0..ROWS).map(|i| format!("{:.5}", rate(i))).collect();
    let lines: String = samples.chunks(8).map(|l| l.join(" ") + "\n").collect();
    let slist = format!(
        "TIMESERIES XX_GYRO__BJZ_D, {ROWS} samples, 50 sps, 2026-01-01T00:00:00.000000, SLIST, FLOAT, DEG/S\n"
    );
    let whole = |what, text| Log { what, text, expected: Expected::Right };
    vec![
        right("an object a line", "", |i| object(i) + "\n"),
        whole("a list of objects", format!("[{}]", all.join(",\n"))),
        whole("a sample list", slist + &lines),
    ]
}

#[test]
fn every_layout_is_read_or_asked_about() {
    let mut wrong = String::new();
    let logs: Vec<Log> = of_text().into_iter().chain(of_headers()).chain(of_other_formats()).collect();
    assert!(logs.len() >= 36, "{}", logs.len());
    for Log { what, text, expected } in logs {
        let found = read(&text, &ReadOptions::default());
        let near = |v: Option<f64>, right: f64| v.is_some_and(|v| (v / right - 1.0).abs() < 2e-3);
        let is_right = match (&expected, &found) {
            (Expected::Right, Ok((hz, mean, true))) => near(*hz, RATE_HZ) && near(*mean, right_mean()),
            (Expected::NoClock, Ok((None, mean, true))) => near(*mean, right_mean()),
            (Expected::UnitOpen, Ok((hz, Some(_), false))) => near(*hz, RATE_HZ),
            (Expected::NoGyro, Ok((None, None, _))) => true,
            (Expected::Question(words), Err(said)) => said.contains(words),
            _ => false,
        };
        if !is_right {
            writeln!(wrong, "{what}: {found:?}").unwrap();
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

fn right_mean() -> f64 {
    (0..ROWS).map(rate).sum::<f64>() / f64::from(ROWS)
}
