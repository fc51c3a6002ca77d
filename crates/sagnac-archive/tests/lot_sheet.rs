//! A million results: how long the sheet of a lot takes.

mod support;

use datafusion::arrow::array::{ArrayRef, RecordBatch, StringArray};
use datafusion::arrow::datatypes::{DataType, Field, Schema};
use sagnac::estimate::{Interval, Verdict};
use sagnac::record::MeasurandRecord;
use sagnac_archive::functions::Function;
use sagnac_archive::outcome::{self, Outcome};
use sagnac_archive::results::{Counts, Writer};
use sagnac_archive::stores;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};
use support::*;

/// Quantities of a result, as `sagnac analyze` gives them for one channel.
const QUANTITIES: [&str; 8] = [
    "static_bias",
    "angle_random_walk",
    "bias_instability",
    "rate_random_walk",
    "rate_ramp",
    "quantization",
    "white_noise",
    "drift",
];
const SHEET: &str = "SELECT lot, count(*) AS units, avg(b['value']) AS mean, \
    sagnac_tolerance_lower(b['value'], 0.9, 0.95) AS low, sagnac_tolerance_upper(b['value'], 0.9, 0.95) AS high \
    FROM (SELECT lot, sagnac_measurand(measurands, 'static_bias') AS b FROM results) GROUP BY lot ORDER BY lot";

fn result(number: usize) -> Outcome {
    let noise =
        ((number as u64).wrapping_mul(6_364_136_223_846_793_005) >> 40) as f64 / f64::from(1_u32 << 24);
    let measurand = |(i, id): (usize, &&str)| MeasurandRecord {
        id: (*id).to_owned(),
        channel: "rate".to_owned(),
        value: Some(10.0 + noise + i as f64),
        interval: Some(Interval { low: 9.9 + noise, high: 10.1 + noise, coverage: 0.95 }),
        unit: "deg/h".to_owned(),
        verdict: Verdict::Pass,
        ..MeasurandRecord::default()
    };
    Outcome {
        serial: Some(format!("SN-{number}")),
        lot: Some(format!("L{:04}", number % 1000)),
        verdict: Some("pass".to_owned()),
        measurands: QUANTITIES.iter().enumerate().map(measurand).collect(),
        ..Outcome::default()
    }
}

fn portion(numbers: std::ops::Range<usize>) -> RecordBatch {
    let outcomes: Vec<Outcome> = numbers.clone().map(result).collect();
    let text = |of: &dyn Fn(usize) -> Option<String>| -> ArrayRef {
        Arc::new(numbers.clone().map(of).collect::<StringArray>())
    };
    let columns = vec![
        text(&|n| Some(format!("{n:064x}"))),
        text(&|n| Some(format!("/archive/{n}.parquet"))),
        text(&|_| Some("/procedures/static-bias.toml".to_owned())),
        text(&|_| None),
        text(&|_| None),
        Arc::new(outcome::array(&outcomes)) as ArrayRef,
    ];
    let texts = ["key", "uri", "procedure", "limits", "model"].map(|n| Field::new(n, DataType::Utf8, true));
    let outcome = Field::new("outcome", outcome::data_type(), true);
    let schema = Schema::new(texts.into_iter().chain([outcome]).collect::<Vec<_>>());
    RecordBatch::try_new(Arc::new(schema), columns).unwrap()
}

fn write(folder: &str, rows: usize) {
    let (store, folder) = stores::open(&stores::folder(folder).unwrap()).unwrap();
    let writer = Writer { store, folder, run: "synthetic".to_owned(), function: Function::Run };
    let runtime = tokio::runtime::Runtime::new().unwrap();
    let size = 10_000.min(rows);
    for number in 0..rows / size {
        let batch = portion(number * size..(number + 1) * size);
        let (counts, _) = runtime.block_on(writer.write(number, &[batch])).unwrap();
        assert_eq!(counts, Counts { results: size as u64, ..Counts::default() });
    }
}

#[test]
fn a_sheet_has_a_line_for_each_lot() {
    let folder = tempfile::tempdir().unwrap();
    let results = folder.path().display().to_string();
    write(&results, 10_000);
    let done = program(&["query", SHEET, "--results", &results, "--csv"]);
    assert!(done.status.success(), "{}", said(&done));
    let text = String::from_utf8(done.stdout).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 1001);
    assert!(lines[1].starts_with("L0000,10,"), "{}", lines[1]);
}

/// The figure of `docs/archive.md`; `LOT_SHEET_RESULTS` names a folder that keeps the results. `cargo test --release --test lot_sheet -- --ignored --nocapture`.
#[test]
#[ignore = "writes a million results"]
fn a_million_results_are_answered_in_two_seconds() {
    let folder = tempfile::tempdir().unwrap();
    let kept = std::env::var("LOT_SHEET_RESULTS").ok();
    let results = kept.unwrap_or_else(|| folder.path().display().to_string());
    if files(Path::new(&results), ".parquet").is_empty() {
        write(&results, 1_000_000);
    }
    let times: Vec<Duration> = (0..3)
        .map(|_| {
            let start = Instant::now();
            let done = program(&["query", SHEET, "--results", &results, "--csv"]);
            assert!(done.status.success(), "{}", said(&done));
            start.elapsed()
        })
        .collect();
    println!("three times the sheet of 1000 lots of 1000 units: {times:?}");
    assert!(times.iter().min().is_some_and(|t| *t < Duration::from_secs(2)), "{times:?}");
}
