//! A whole acceptance test: scale factor over temperature, of a good unit and of one with a concealed defect.

use super::{Bench, unit};
use crate::support::{measurand, result, sagnac, shipped};
use serde_json::Value;
use std::fs;

/// Five soaks, two cycles of rates at each.
fn schedule() -> String {
    let mut text = "format = \"schedule/1\"\n[start]\ntemp_degC = 25.0\n".to_owned();
    for temp in [-10.0, 25.0, 60.0, 25.0, -10.0] {
        text += &format!("[[step]]\ndo = \"ramp\"\nto_degC = {temp:?}\nrate_degC_per_h = 900.0\n");
        text += "[[step]]\ndo = \"hold\"\nduration_h = 0.05\n[[step]]\ndo = \"table_rates\"\n";
        text += "rates_deg_s = [0.0, 40.0, -40.0, 100.0, -100.0]\ndwell_s = 20.0\ncount = 2\n";
    }
    text
}

fn tested(per_degree_ppm: f64) -> (i32, Value) {
    let bench = Bench::new(unit(per_degree_ppm), &[], "60 s", &schedule());
    let said = bench.record();
    assert_eq!(said.code, 0, "{said:?}");
    bench.is_safe();
    let procedure = shipped("procedures/scale-factor-over-temperature.toml");
    let run = sagnac(bench.folder(), &["run", &procedure, "rec/recording.toml", "--out", "o"]);
    assert!(run.code < 2, "{run:?}");
    (run.code, result(&bench.at("o")))
}

#[test]
fn a_good_unit_passes_and_one_with_a_concealed_defect_fails() {
    const SLOPE: &str = "scale_factor_temperature_sensitivity";
    for (per_degree_ppm, code, verdict) in [(2.0, 0, "pass"), (5.5, 1, "fail")] {
        let (found, result) = tested(per_degree_ppm);
        assert_eq!((found, result["verdict"].as_str()), (code, Some(verdict)), "{}", result["measurands"]);
        assert_eq!(result["unit_under_test"]["serial"], "SN-7");
        let row = measurand(&result, SLOPE);
        let value = row["value"].as_f64().unwrap();
        assert!((value - per_degree_ppm).abs() < 0.2, "{row}");
        assert_eq!(row["verdict"], verdict, "{row}");
    }
}

#[test]
fn what_was_commanded_and_reached_stands_beside_the_parts() {
    let bench = Bench::new(unit(2.0), &[], "20 s", super::SHORT);
    let said = bench.record();
    assert_eq!(said.code, 0, "{said:?}");
    let set: Vec<f64> = bench
        .event("set")
        .iter()
        .filter(|e| e["quantity"] == "table_rate_deg_s")
        .map(|e| e["value"].as_f64().unwrap())
        .collect();
    assert_eq!(set, [20.0, -20.0, 20.0, -20.0, 0.0]);
    let times = |name: &str| -> Vec<f64> {
        let events = bench.event(name).into_iter().filter(|e| e["device"] == "table");
        events.map(|e| e["t_s"].as_f64().unwrap()).collect()
    };
    let (asked, reached) = (times("set"), times("reached"));
    assert_eq!(asked.len(), reached.len());
    for (asked, reached) in asked.iter().zip(&reached) {
        assert!((0.1..5.0).contains(&(reached - asked)), "{asked} {reached}");
    }
    assert_eq!(bench.event("end")[0]["how"], "complete");
    assert_eq!(bench.event("safe").len(), 3);
    // Whole parts of at most 20 s, which follow each other.
    let mut last = f64::NEG_INFINITY;
    for number in 1.. {
        let Ok(text) = fs::read_to_string(bench.at(&format!("rec/gyro-{number:06}.csv"))) else {
            assert!(number > 8, "{number}");
            break;
        };
        let stamps: Vec<f64> =
            text.lines().skip(1).map(|line| line.split(',').next().unwrap().parse().unwrap()).collect();
        let (first, end) = (stamps[0], *stamps.last().unwrap());
        assert!(end - first <= 20.0 && first > last && text.ends_with('\n'), "{number}: {first} {end}");
        last = end;
    }
    let sums = fs::read_to_string(bench.at("rec/SHA256SUMS")).unwrap();
    for name in ["gyro-000001.csv", "recording.toml", "bench.toml", "schedule.toml", "events.jsonl"] {
        assert!(sums.contains(name), "{name}");
    }
    let said = sagnac(bench.folder(), &["inspect", "rec/recording.toml"]);
    assert_eq!(said.code, 0, "{said:?}");
    for column in ["rate_deg_h", "table_rate_deg_s", "chamber_temp_degC", "supply_v"] {
        assert!(said.out.contains(column), "{column}: {}", said.out);
    }
}
