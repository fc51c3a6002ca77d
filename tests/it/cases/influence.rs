//! An effect that arrives slowly: a supply voltage whose change reaches the bias with a time constant.

use super::{input, interval, is_right, run};
use crate::support::measurand;
use std::fmt::Write;

const CASE: &str = "influence-arrives-slowly";

#[test]
fn a_response_that_goes_on_is_no_value_and_no_pass() {
    let limits = input(CASE, "limits.toml");
    let (said, found) =
        run("supply-sensitivity", &input(CASE, "supply.csv"), &["--serial", "J-1", "--limits", &limits]);
    assert_eq!(said.code, 3, "{}", said.out);
    let row = measurand(&found, "supply_sensitivity");
    assert!(is_right(row, 1.0) && row["verdict"] == "indeterminate", "{row}");
    assert!(said.out.contains("Still responding") && said.out.contains("time constant"), "{}", said.out);
}

/// A supply test on the schedule of the case: steps of 0.25 V that arrive with a time constant, white noise and a drift.
fn supply(seed: u64, time_constant_s: f64, per_volt: f64) -> String {
    const LEVELS: [f64; 9] = [5.0, 5.25, 5.0, 4.75, 5.0, 5.25, 5.0, 4.75, 5.0];
    let mut out = String::from("# serial: J-1\ntime_s,rate_deg_h,temp_degC,supply_V\n");
    let mut level = 5.0;
    for i in 0..1080u64 {
        let volts = LEVELS[(i / 120) as usize];
        let share = if time_constant_s > 0.0 { 1.0 - (-1.0 / time_constant_s).exp() } else { 1.0 };
        level += (volts - level) * share;
        let noise = 0.12 * crate::support::synthetic::white(seed, i);
        let rate = 12.4 + per_volt * (level - 5.0) + 1e-5 * i as f64 + noise;
        let _ = writeln!(out, "{i}.0,{rate:.5},20.00,{volts:.3}");
    }
    out
}

fn row(seed: u64, time_constant_s: f64, per_volt: f64) -> serde_json::Value {
    let folder = tempfile::tempdir().unwrap();
    let recording = folder.path().join("supply.csv");
    std::fs::write(&recording, supply(seed, time_constant_s, per_volt)).unwrap();
    let (_, found) = run("supply-sensitivity", &recording.to_string_lossy(), &["--serial", "J-1"]);
    measurand(&found, "supply_sensitivity").clone()
}

#[test]
fn time_constants_from_none_to_several_intervals_give_the_truth_or_nothing() {
    for (seed, time_constant_s) in [(1, 0.0), (2, 0.0), (3, 8.0), (4, 20.0), (5, 20.0), (6, 60.0), (7, 300.0)]
    {
        let row = row(seed, time_constant_s, 1.0);
        assert!(is_right(&row, 1.0), "{time_constant_s} s: {row}");
        assert_eq!(row["value"].is_null(), time_constant_s > 50.0, "{time_constant_s} s: {row}");
        if time_constant_s == 0.0 {
            let (low, high) = interval(&row);
            assert!(high - low < 0.25, "{row}");
        }
    }
}

#[test]
fn noise_alone_is_no_response() {
    for seed in 20..26 {
        let row = row(seed, 0.0, 0.0);
        assert!(is_right(&row, 0.0) && !row["value"].is_null(), "{row}");
    }
}
