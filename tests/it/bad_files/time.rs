//! Odd time stamps, odd lengths and odd levels: faults are located, and what is no fault changes nothing.

use crate::support::synthetic::{HEADER, recording, white, with};
use crate::support::{analysed, both, measurand, result};
use serde_json::Value;
use std::io::Write;
use std::time::{Duration, Instant};
use tempfile::tempdir;

const ROWS: u64 = 1000;

fn refused(name: &str, text: &str, fragments: &[&str]) {
    let dir = tempdir().unwrap();
    std::fs::write(dir.path().join(name), text).unwrap();
    let (analysed, run) = both(dir.path(), name);
    for said in [analysed, run] {
        assert_eq!(said.code, 2, "{name}: {said:?}");
        for fragment in fragments {
            assert!(said.err.contains(fragment), "{name}: no `{fragment}` in\n{}", said.err);
        }
    }
}

/// Reads a recording with both verbs; gives the result of the analysis.
fn read(name: &str, text: &str) -> Value {
    let dir = tempdir().unwrap();
    std::fs::write(dir.path().join(name), text).unwrap();
    let (analysed, run) = both(dir.path(), name);
    assert_eq!((analysed.code, run.code), (0, 3), "{name}: {analysed:?} {run:?}");
    result(&dir.path().join("a"))
}

fn has_fault(result: &Value, kind: &str, row: u64, count: u64) -> bool {
    let faults = result["integrity"]["faults"].as_array().unwrap();
    faults.iter().any(|f| f["kind"] == kind && f["row"] == row && f["count"] == count)
}

fn value(result: &Value, id: &str) -> f64 {
    measurand(result, id)["value"].as_f64().unwrap_or_else(|| panic!("{id}: null"))
}

/// The recording with other stamps: `stamp` of the row counted from 1.
fn stamped(rows: u64, stamp: impl Fn(u64) -> String) -> String {
    with(rows, |i, row| format!("{},{}", stamp(i + 1), row.split_once(',').unwrap().1))
}

#[test]
fn what_changes_only_the_form_changes_no_figure() {
    let sound = recording(ROWS);
    let packed = |bytes: &[u8]| {
        let mut e = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
        e.write_all(bytes).unwrap();
        e.finish().unwrap()
    };
    let (first, second) = sound.split_at(sound.len() / 2);
    let members = [packed(first.as_bytes()), packed(second.as_bytes())].concat();
    let quoted: String = sound.lines().map(|l| format!("\"{}\"\n", l.replace(',', "\",\""))).collect();
    let forms: [(&str, Vec<u8>); 9] = [
        ("crlf.csv", sound.replace('\n', "\r\n").into_bytes()),
        ("bom.csv", format!("\u{feff}{sound}").into_bytes()),
        ("cut.csv", sound.trim_end().as_bytes().to_vec()),
        ("blank-lines-at-the-end.csv", format!("{sound}\n\n").into_bytes()),
        ("tabs.txt", sound.replace(',', "\t").into_bytes()),
        ("spaces-about.csv", sound.replace(',', " , ").into_bytes()),
        ("semicolons.csv", sound.replace(',', ";").into_bytes()),
        ("quoted.csv", quoted.into_bytes()),
        ("members.csv.gz", members),
    ];
    let dir = tempdir().unwrap();
    std::fs::write(dir.path().join("sound.csv"), &sound).unwrap();
    assert_eq!(both(dir.path(), "sound.csv").0.code, 0);
    let plain = result(&dir.path().join("a"));
    for (name, bytes) in forms {
        std::fs::write(dir.path().join(name), bytes).unwrap();
        let said = analysed(dir.path(), name);
        assert_eq!(said.code, 0, "{name}: {said:?}");
        let other = result(&dir.path().join("a"));
        assert_eq!(plain["measurands"], other["measurands"], "{name}");
        assert_eq!(plain["integrity"], other["integrity"], "{name}");
    }
}

#[test]
fn gaps_duplicates_and_backward_steps_are_located() {
    let r = read("gap.csv", &stamped(ROWS, |row| (row - 1 + 7 * u64::from(row > 500)).to_string()));
    assert!(has_fault(&r, "gap", 501, 7), "{:#}", r["integrity"]);
    assert_eq!((&r["integrity"]["gaps"], &r["integrity"]["missing_samples"]), (&1.into(), &7.into()));

    let r = read("twice.csv", &with(ROWS, |i, row| if i == 500 { format!("{row}\n{row}") } else { row }));
    assert!(has_fault(&r, "duplicate_timestamp", 502, 1), "{:#}", r["integrity"]);
    assert_eq!(r["integrity"]["duplicate_timestamps"], 1);

    let back = |row: u64| if row == 500 { row - 101 } else { row - 1 };
    let r = read("back.csv", &stamped(ROWS, |row| back(row).to_string()));
    assert!(has_fault(&r, "backward_timestamp", 500, 1), "{:#}", r["integrity"]);
    assert_eq!(r["integrity"]["backward_timestamps"], 1);

    let r =
        read("no-stamp.csv", &stamped(ROWS, |row| if row == 500 { "NaN".into() } else { row.to_string() }));
    assert!(has_fault(&r, "non_finite", 500, 1), "{:#}", r["integrity"]);
    let r = read(
        "bad-stamp.csv",
        &stamped(ROWS, |row| if row == 500 { "12:00".into() } else { row.to_string() }),
    );
    assert!(has_fault(&r, "unparsable", 500, 1), "{:#}", r["integrity"]);
}

#[test]
fn a_second_header_in_the_middle_is_a_row_of_words() {
    let text = with(ROWS, |i, row| if i == 500 { format!("{HEADER}\n{row}") } else { row });
    let r = read("two.csv", &text);
    assert_eq!(r["recording"][0]["samples"], ROWS + 1);
    assert!(has_fault(&r, "unparsable", 501, 1), "{:#}", r["integrity"]);
    let stacked = format!("{HEADER}\n{}", recording(ROWS));
    let r = read("stacked.csv", &stacked);
    assert!(has_fault(&r, "unparsable", 1, 1), "{:#}", r["integrity"]);
}

#[test]
fn a_file_cut_in_the_middle_of_a_line_ends_with_a_located_fault() {
    // The last line keeps its stamp and half its rate; its temperature is gone.
    let text = recording(ROWS);
    let line = text.lines().nth(501).unwrap();
    let end = text.find(line).unwrap() + line.find(',').unwrap() + 4;
    let r = read("cut.csv", &text[..end]);
    assert_eq!(r["recording"][0]["samples"], 501);
    assert!(has_fault(&r, "unparsable", 501, 1), "{:#}", r["integrity"]);
}

#[test]
fn samples_in_pairs_are_every_third_lost() {
    // Stamps 0, 1, 3, 4, 6, 7 ... are those of a 1-s clock that loses every third sample, or of a 1.5-s clock whose
    // stamps are rounded. The record cannot tell; the reading that shows is taken, and a remark names the other one.
    let r = read("pairs.csv", &stamped(ROWS, |row| (row - 1 + (row - 1) / 2).to_string()));
    assert_eq!((&r["integrity"]["gaps"], &r["integrity"]["missing_samples"]), (&499.into(), &499.into()));
    let told = |c: &Value| c["id"] == "time_base" && c["note"].as_str().unwrap().contains("1.5 s");
    assert!(r["conditions"].as_array().unwrap().iter().any(told), "{:#}", r["conditions"]);
}

#[test]
fn every_second_stamp_is_half_the_rate_and_no_fault() {
    let r = read("half.csv", &stamped(ROWS, |row| (2 * (row - 1)).to_string()));
    assert_eq!(r["integrity"]["gaps"], 0);
    assert_eq!(r["recording"][0]["sample_interval_s"], 2.0);
}

#[test]
fn a_clock_that_leaps_is_a_gap_and_costs_nothing() {
    // No recording lacks 1e12 samples: the clock was set, and how many are missing is not known.
    for (leap, missing) in [(1_000_000_u64, 1_000_000), (1_000_000_000_000, 1), (1_000_000_000_000_000, 1)] {
        let began = Instant::now();
        let r = read("leap.csv", &stamped(ROWS, |row| (row + leap * u64::from(row > 500)).to_string()));
        assert!(has_fault(&r, "gap", 501, missing), "{leap}: {:#}", r["integrity"]);
        assert_eq!(r["integrity"]["missing_samples"], missing);
        assert!(began.elapsed() < Duration::from_secs(60));
    }
}

#[test]
fn stamps_that_are_no_clock_are_refused() {
    refused("equal.csv", &stamped(ROWS, |_| "5".into()), &["stamp"]);
    refused("falling.csv", &stamped(ROWS, |row| (ROWS - row).to_string()), &["stamp"]);
    refused("none.csv", &stamped(ROWS, |_| "NaN".into()), &["stamp"]);
    refused("one.csv", &recording(1), &["one.csv"]);
    let dir = tempdir().unwrap();
    std::fs::write(dir.path().join("two.csv"), recording(2)).unwrap();
    let (analysed, run) = both(dir.path(), "two.csv");
    assert!([0, 2].contains(&analysed.code) && [2, 3].contains(&run.code), "{analysed:?} {run:?}");
}

#[test]
fn an_offset_of_a_thousand_million_times_the_noise_changes_no_noise_figure() {
    let level = |offset: f64| with(4000, |i, _| format!("{i},{:.3},20.0", offset + white(1, i)));
    let (plain, high) = (read("plain.csv", &level(0.0)), read("high.csv", &level(1e9)));
    for id in ["angle_random_walk", "bias_instability_minimum", "russian_sigma_10s", "russian_drift_100s"] {
        let (a, b) = (value(&plain, id), value(&high, id));
        assert!((a / b - 1.0).abs() < 1e-5, "{id}: {a} {b}");
    }
    assert!((value(&high, "static_bias") - 1e9 - value(&plain, "static_bias")).abs() < 1e-5);
}

#[test]
fn a_rate_that_never_changes_is_stuck_and_no_noise_is_claimed() {
    let r = read("constant.csv", &with(ROWS, |i, _| format!("{i},12.5,20.0")));
    assert_eq!(r["integrity"]["stuck"], ROWS);
    assert_eq!(value(&r, "static_bias"), 12.5);
    for id in ["angle_random_walk", "bias_instability", "rate_random_walk"] {
        let row = measurand(&r, id);
        assert!(row["value"].is_null() || row["value"] == 0.0, "{row:#}");
    }
}

#[test]
fn a_rate_without_a_number_is_refused() {
    for nothing in ["NaN", ""] {
        let text = with(ROWS, |i, _| format!("{i},{nothing},20.0"));
        refused("nothing.csv", &text, &["nothing.csv"]);
    }
}
