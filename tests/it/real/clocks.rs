//! Real recordings cut into two files with a clock of their own: the offset between the clocks is found again within its
//! uncertainty.

use crate::support::sagnac;
use std::fs;
use std::path::Path;

/// The offset that `inspect` states for the clock of the second file, s.
#[track_caller]
fn estimated_offset_s(folder: &Path) -> f64 {
    let said = sagnac(folder, &["inspect", "gyro.csv", "--source", "second.csv", "--estimate-offset"]);
    assert_eq!(said.code, 0, "{}", said.err);
    let text = said.out.split_whitespace().collect::<Vec<_>>().join(" ").replace('−', "-");
    let before = text.split(" s are added to its timestamps").next().unwrap_or_default();
    before.split(' ').next_back().and_then(|t| t.parse().ok()).unwrap_or_else(|| panic!("{text}"))
}

/// Rows of a table of numbers, and its header.
fn rows(text: &str) -> Vec<Vec<f64>> {
    text.lines().skip(1).filter_map(|line| line.split(',').map(|f| f.parse().ok()).collect()).collect()
}

#[test]
fn the_clock_of_an_angle_log_is_found_beside_a_fibre_optic_gyro_turned_by_hand() {
    let Some(set) = crate::support::real::set("fog_kvh1750_known_angle") else { return };
    let text = crate::support::real::unpacked(&set.join("direct_ext_rate.csv.gz"));
    let folder = tempfile::tempdir().unwrap();
    // An increment is the mean rate of the millisecond before its stamp.
    let all = rows(&text);
    let gyro: String = all.iter().map(|r| format!("{:.4},{:.3}\n", r[1] - 0.0005, 1000.0 * r[3])).collect();
    fs::write(folder.path().join("gyro.csv"), format!("time_s,rate_dps\n{gyro}")).unwrap();
    // The table: every 20 ms, with the steps of an encoder, 2.2 s later by a clock that is 300 ppm slow.
    let second: String = all
        .iter()
        .skip(1100)
        .step_by(20)
        .map(|r| format!("{:.5},{:.1}\n", (r[1] - 1.5) / 1.0003, r[6]))
        .collect();
    fs::write(folder.path().join("second.csv"), format!("time_s,table_angle_deg\n{second}")).unwrap();
    let offset_s = estimated_offset_s(folder.path());
    // At the start of the recording the truth is 1.5 s; the rate is stated about its middle.
    assert!((offset_s - 1.5).abs() < 0.001, "{offset_s} s");
}

#[test]
fn the_clock_of_a_second_log_of_one_thermometer_is_found_beside_a_heated_gyro() {
    let Some(set) = crate::support::real::set("fog_fizoptika_rate_table_temp") else { return };
    let text = fs::read_to_string(set.join("segments.csv")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let at_s = |r: &[f64]| 16.0 * r[0];
    let all = rows(&text);
    let line = |t: f64, r: &[f64]| format!("{t:.2},{:.5},{:.4}\n", -0.1294 / 3600.0 * r[3], r[4]);
    let gyro: String = all.iter().map(|r| line(at_s(r), r)).collect();
    fs::write(folder.path().join("gyro.csv"), format!("time_s,rate_dps,temp_degC\n{gyro}")).unwrap();
    let second: String =
        all.iter().skip(2).step_by(2).map(|r| format!("{:.2},{:.2}\n", at_s(r) - 167.0, r[4])).collect();
    fs::write(folder.path().join("second.csv"), format!("time_s,temp_degC\n{second}")).unwrap();
    let offset_s = estimated_offset_s(folder.path());
    assert!((offset_s - 167.0).abs() < 3.0, "{offset_s} s");
}
