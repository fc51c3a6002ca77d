//! A table that needs longer than the settling, and stamps in a wrong unit, name themselves.

use super::runs::run;
use super::{COUNT, pass, root};
use sagnac_studies::bench::rate_table::RateTable;
use serde_json::Value;

/// The sample of a good unit with its rows changed: time, counts, rate of the table, angle of the table, temperature.
fn changed(change: impl Fn(&mut Vec<f64>)) -> Value {
    let bench: RateTable = pass();
    let text = bench.record().csv(COUNT, 0.1);
    let mut out = String::new();
    for (i, line) in text.lines().enumerate() {
        if i == 0 {
            out.push_str(line);
        } else {
            let mut values: Vec<f64> = line.split(',').map(|v| v.parse().unwrap()).collect();
            change(&mut values);
            out.push_str(&values.iter().map(|v| format!("{v}")).collect::<Vec<_>>().join(","));
        }
        out.push('\n');
    }
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("recording.csv");
    std::fs::write(&data, out).unwrap();
    run(&root("procedures/scale-factor.toml"), &data).1
}

fn said(result: &Value) -> Vec<(String, String)> {
    let list = result["conditions"].as_array().unwrap();
    let text = |v: &Value| v.as_str().unwrap_or_default().to_owned();
    list.iter().map(|c| (text(&c["id"]), text(&c["status"]))).filter(|c| c.1 == "invalid").collect()
}

#[test]
fn stamps_in_milliseconds_are_named_and_nothing_that_follows_from_them() {
    let found = said(&changed(|v| v[0] *= 1000.0));
    assert!(found.iter().any(|c| c.0 == "table_stamps"), "{found:?}");
    assert!(
        !found.iter().any(|c| c.0.starts_with("table_response") || c.0 == "table_agreement"),
        "{found:?}"
    );
    let right = said(&changed(|_| ()));
    assert!(!right.iter().any(|c| c.0.starts_with("table_")), "{right:?}");
}
