//! Rates up to the range of a unit and beyond: the samples, the shipped procedure on them, and tables that end first.

use crate::support::pairs::sample_once;
use crate::support::{altered, result, sagnac, shipped};
use sagnac_studies::bench::rate_table::RateTable;
use serde_json::Value;
use tempfile::tempdir;

/// Rates of the samples on the way out, deg/s, in both directions.
const OUT: [f64; 12] = [0.0, 30.0, 75.0, 150.0, 200.0, 250.0, 275.0, 300.0, 325.0, 350.0, 375.0, 400.0];

/// A unit with these rails, deg/s, that stays there so long after an overload, s.
pub fn unit(low: f64, high: f64, recovery_s: f64, seed: u64) -> RateTable {
    let mut rates = OUT.to_vec();
    rates.extend([300.0, 0.0]);
    rates.extend(OUT.iter().skip(1).map(|r| -r));
    rates.extend([-250.0, 0.0]);
    RateTable {
        rates,
        cycles: 1,
        dwell_s: 16.0,
        acceleration: 100.0,
        n: 0.02,
        error_ppm: 300.0,
        rails: Some((3600.0 * low, 3600.0 * high)),
        recovery_s,
        seed,
        ..RateTable::default()
    }
}

/// The recording of a unit as it is saved.
pub fn csv(unit: &RateTable) -> String {
    let r = unit.record();
    let mut out = String::from("time_s,rate_deg_s,table_rate_deg_s,table_angle_deg\n");
    for i in 0..r.time_s.len() {
        let (rate, table) = (r.rate_deg_h[i] / 3600.0, r.table_rate_deg_h[i] / 3600.0);
        let angle = r.table_angle_arcsec[i] / 3600.0;
        out.push_str(&format!("{:.1},{rate:.5},{table},{angle:.4}\n", r.time_s[i]));
    }
    out
}

fn rows<'a>(result: &'a Value, id: &str) -> Vec<&'a Value> {
    result["measurands"].as_array().unwrap().iter().filter(|r| r["id"] == id).collect()
}

#[test]
fn a_unit_with_room_passes_between_two_levels() {
    let r = sample_once("maximum-rate-pass").result();
    let rate = rows(r, "maximum_rate")[0];
    assert!(rate["value"].is_null() && rate["verdict"] == "pass", "{rate}");
    let bounds = [&rate["lower_limit"]["value"], &rate["upper_limit"]["value"]].map(|v| v.as_f64().unwrap());
    assert!((bounds[0] - 325.0).abs() < 0.1 && (bounds[1] - 350.0).abs() < 0.1, "{bounds:?}");
    let levels = rows(r, "saturation_level");
    for (row, (channel, truth)) in levels.iter().zip([("rate@positive", 340.0), ("rate@negative", -345.0)]) {
        assert_eq!(row["channel"], channel);
        assert!((row["value"].as_f64().unwrap() - truth).abs() < 0.01, "{row}");
    }
    assert_eq!(rows(r, "overload_recovery")[0]["verdict"], "pass");
}

#[test]
fn a_unit_that_ends_early_and_recovers_late_fails() {
    let r = sample_once("maximum-rate-fail").result();
    let rate = rows(r, "maximum_rate")[0];
    assert_eq!(rate["verdict"], "fail", "{rate}");
    assert!((rate["upper_limit"]["value"].as_f64().unwrap() - 275.0).abs() < 0.1, "{rate}");
    let recovery = rows(r, "overload_recovery")[0];
    assert_eq!(recovery["verdict"], "fail", "{recovery}");
    let ends = ["low", "high"].map(|end| recovery["interval"][end].as_f64().unwrap());
    // 2.5 s from the last sample beyond the rail, less what the table needs from there into the range.
    assert!(ends[0] < 2.5 && ends[1] > 2.0, "{recovery}");
}

#[test]
fn a_table_that_ends_first_says_at_least() {
    let dir = tempdir().unwrap();
    let unit = RateTable {
        rates: vec![0.0, 50.0, 100.0, 150.0, 300.0, 0.0, -50.0, -150.0, -300.0],
        ..unit(-500.0, 500.0, 0.0, 3)
    };
    std::fs::write(dir.path().join("r.csv"), csv(&unit)).unwrap();
    let shipped = shipped("procedures/maximum-rate.toml");
    for (limit, code, verdict) in [("305 deg/s", 3, "indeterminate"), ("300 deg/s", 0, "pass")] {
        let changes = [
            ("min = \"300 deg/s\"", &*format!("min = \"{limit}\"")),
            ("minimum_duration = \"5 min\"", "minimum_duration = \"1 min\""),
        ];
        altered(dir.path(), "p.toml", &shipped, &changes);
        let text = std::fs::read_to_string(dir.path().join("p.toml")).unwrap();
        let without = text.replace("[[limit]]\nmeasurand = \"overload_recovery\"\nmax = \"1 s\"\n", "");
        std::fs::write(dir.path().join("p.toml"), without).unwrap();
        let said = sagnac(dir.path(), &["run", "p.toml", "r.csv", "--serial", "S", "--out", "o"]);
        assert_eq!(said.code, code, "{said:?}");
        let r = result(&dir.path().join("o"));
        let rate = rows(&r, "maximum_rate")[0];
        assert_eq!(rate["verdict"], verdict, "{rate}");
        assert!(rate["upper_limit"].is_null(), "{rate}");
        assert!(rate["notes"].to_string().contains("overload.of_table"), "{rate}");
        assert!(rows(&r, "saturation_level").iter().all(|row| row["value"].is_null()));
    }
}

#[test]
fn a_reversed_unit_fails_its_polarity() {
    let dir = tempdir().unwrap();
    let unit = unit(-345.0, 340.0, 0.3, 4);
    let reversed: String = csv(&unit)
        .lines()
        .enumerate()
        .map(|(row, line)| match line.split(',').collect::<Vec<&str>>()[..] {
            [time, rate, table, angle] if row > 0 => {
                format!("{time},{},{table},{angle}\n", -rate.parse::<f64>().unwrap())
            }
            _ => format!("{line}\n"),
        })
        .collect();
    std::fs::write(dir.path().join("r.csv"), reversed).unwrap();
    let shipped = shipped("procedures/maximum-rate.toml");
    let said = sagnac(dir.path(), &["run", &shipped, "r.csv", "--serial", "S", "--out", "o"]);
    assert_eq!(said.code, 1, "{said:?}");
    let r = result(&dir.path().join("o"));
    let polarity = rows(&r, "polarity")[0];
    assert_eq!((polarity["value"].as_f64(), polarity["verdict"].as_str()), (Some(-1.0), Some("fail")));
    // Without a limit on it the test is not valid.
    altered(dir.path(), "p.toml", &shipped, &[("[[limit]]\nmeasurand = \"polarity\"\nmin = \"1\"\n", "")]);
    let said = sagnac(dir.path(), &["run", "p.toml", "r.csv", "--serial", "S", "--out", "o"]);
    assert_eq!(said.code, 3, "{said:?}");
}

#[test]
fn what_makes_no_sense_is_refused_with_the_place() {
    let dir = tempdir().unwrap();
    let shipped = shipped("procedures/maximum-rate.toml");
    for (from, to, expected) in [
        ("maximum_rate_error = \"1 %\"", "maximum_rate_error = \"60 %\"", "maximum_rate_error"),
        ("maximum_rate_error = \"1 %\"", "maximum_rate_error = \"0 %\"", "maximum_rate_error"),
        ("id = \"saturation_level\"", "id = \"g_sensitivity_i\"", "[acceleration_test]"),
        ("min = \"300 deg/s\"", "min = \"300 s\"", "deg/s"),
    ] {
        altered(dir.path(), "p.toml", &shipped, &[(from, to)]);
        let said = sagnac(dir.path(), &["check", "p.toml", "--lang", "en"]);
        assert_eq!(said.code, 2, "{to}: {said:?}");
        let text = format!("{}{}", said.out, said.err);
        assert!(text.contains(expected) && text.contains("p.toml:"), "{expected}: {text}");
    }
}
