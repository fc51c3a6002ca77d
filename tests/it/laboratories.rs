//! Two results of one unit, compared by `sagnac compare MAKER CUSTOMER` as a user runs it.

use crate::support::synthetic::{HEADER, white};
use crate::support::{Said, altered, procedure, sagnac};
use serde_json::Value;
use std::path::Path;
use tempfile::{TempDir, tempdir};

/// Rows of a recording, one a second.
const ROWS: u64 = 3000;

/// A recording of a unit at rest: noise of its own, and what is changed of the bias.
fn recording(folder: &Path, name: &str, seed: u64, rows: u64, shift_deg_h: f64, temperature: f64) {
    let row = |i: u64| {
        let rate = 12.5 + shift_deg_h + 0.1 * white(seed, i);
        format!("{i},{rate:.5},{:.3}\n", temperature + 0.01 * white(seed + 1000, i))
    };
    let rows: String = (0..rows).map(row).collect();
    std::fs::write(folder.join(name), format!("{HEADER}\n{rows}")).unwrap();
}

/// The procedure of the maker, and one of the customer that keeps the Earth rate in the bias.
fn procedures(folder: &Path) -> (String, String) {
    let short = ("warm_up = \"30 min\"", "warm_up = \"10 s\"");
    let kept = ("options.earth_rate = \"remove\"", "options.earth_rate = \"keep\"");
    let maker = altered(folder, "by-maker.toml", &procedure(), &[short]);
    (maker, altered(folder, "by-customer.toml", &procedure(), &[short, kept]))
}

fn tested(folder: &Path, procedure: &str, recording: &str, out: &str) {
    let said = sagnac(folder, &["run", procedure, recording, "--serial", "SN-1", "--out", out, "--no-store"]);
    assert!(folder.join(out).join("result.json").is_file(), "{said:?}");
}

fn compared(folder: &Path, more: &[&str]) -> (Said, Value) {
    let said = sagnac(folder, &[&["compare", "maker", "customer", "--out", "c"], more].concat());
    assert_eq!((said.code, said.err.as_str()), (0, ""), "{said:?}");
    let text = std::fs::read_to_string(folder.join("c/comparison.json")).unwrap();
    let all: Value = serde_json::from_str(&text).unwrap();
    (said, all["laboratories"].clone())
}

fn row<'a>(all: &'a Value, id: &str) -> &'a Value {
    all["rows"].as_array().unwrap().iter().find(|r| r["first"]["id"] == id).unwrap()
}

fn kinds(row: &Value) -> Vec<(String, bool)> {
    let reasons = row["reasons"].as_array().unwrap().iter();
    reasons.map(|r| (r["kind"].as_str().unwrap().to_owned(), r["shown"].as_bool().unwrap())).collect()
}

/// Two recordings, each tested by its own procedure.
fn two(second_shift: f64, second_rows: u64, temperature: f64, by_customer: bool) -> TempDir {
    let dir = tempdir().unwrap();
    let (maker, customer) = procedures(dir.path());
    recording(dir.path(), "m.csv", 1, ROWS, 0.0, 20.0);
    recording(dir.path(), "c.csv", 2, second_rows, second_shift, temperature);
    tested(dir.path(), &maker, "m.csv", "maker");
    tested(dir.path(), if by_customer { &customer } else { &maker }, "c.csv", "customer");
    dir
}

#[test]
fn results_of_one_truth_agree_and_the_russian_comparison_stays_below() {
    let dir = two(0.0, ROWS, 20.0, false);
    let (said, all) = compared(dir.path(), &[]);
    let bias = row(&all, "static_bias");
    let (x, y) = (bias["first"]["value"].as_f64().unwrap(), bias["second"]["value"].as_f64().unwrap());
    let side = |row: &Value, end: &str| {
        (row["interval"][end].as_f64().unwrap() - row["value"].as_f64().unwrap()).abs()
    };
    let towards = if y > x { ("high", "low") } else { ("low", "high") };
    let expanded = side(&bias["first"], towards.0).hypot(side(&bias["second"], towards.1));
    let en = bias["score"]["en"].as_f64().unwrap();
    assert!((en - (y - x) / expanded).abs() < 1e-9, "{bias}");
    assert_eq!((bias["agreement"].as_str(), kinds(bias).len()), (Some("agrees"), 0), "{bias}");
    assert!(all["differing_keys"].as_array().unwrap().is_empty());
    // The units stand below as always, and the tables for programs beside each other.
    assert!(said.out.contains("E_n") && said.out.contains("σ100"), "{}", said.out);
    let table = std::fs::read_to_string(dir.path().join("c/agreement.csv")).unwrap();
    assert!(table.starts_with("id,channel,unit,first,second,"), "{table}");
    assert!(table.lines().any(|l| l.starts_with("static_bias,") && l.contains(",agrees,")), "{table}");
    let page = std::fs::read_to_string(dir.path().join("c/comparison.html")).unwrap();
    assert!(page.contains("Two results of unit SN-1") && page.contains("E_n"));
    let russian = sagnac(dir.path(), &["compare", "maker", "customer", "--out", "r", "--lang", "ru"]);
    assert!(russian.out.contains("Два результата изделия SN-1"), "{russian:?}");
}

#[test]
fn a_difference_of_definition_is_shown_by_exchanging_the_procedures() {
    let dir = two(0.0, ROWS, 20.0, true);
    let (said, all) = compared(dir.path(), &[]);
    let bias = row(&all, "static_bias");
    assert_eq!(
        (bias["agreement"].as_str(), kinds(bias)),
        (Some("differs"), vec![("definition".into(), true)])
    );
    // The Earth rate on a vertical axis at 55.98°: the procedures make all of the difference.
    let by_procedures = bias["by_procedures"].as_f64().unwrap();
    assert!((by_procedures - 15.041 * 55.98f64.to_radians().sin()).abs() < 0.01, "{bias}");
    for by in ["by_first", "by_second"] {
        assert!(bias[by]["en"].as_f64().unwrap().abs() <= 1.0, "{bias}");
    }
    assert_eq!(all["differing_keys"], serde_json::json!(["measurand.static_bias.options.earth_rate"]));
    assert!(said.out.contains("definition") && said.out.contains("options.earth_rate"), "{}", said.out);
    // The noise is defined alike: the procedures make nothing of its difference.
    assert_eq!(row(&all, "angle_random_walk")["by_procedures"], 0.0);
}

#[test]
fn one_recording_under_two_procedures_differs_by_definition_alone() {
    let dir = tempdir().unwrap();
    let (maker, customer) = procedures(dir.path());
    recording(dir.path(), "m.csv", 1, ROWS, 0.0, 20.0);
    tested(dir.path(), &maker, "m.csv", "maker");
    tested(dir.path(), &customer, "m.csv", "customer");
    let (_, all) = compared(dir.path(), &[]);
    assert_eq!(all["same_recording"], true);
    let bias = row(&all, "static_bias");
    assert_eq!((kinds(bias), &bias["score"]), (vec![("definition".into(), true)], &Value::Null));
    assert_eq!(row(&all, "angle_random_walk")["agreement"], "agrees");
}

#[test]
fn a_changed_unit_has_no_other_reason_and_a_temperature_is_named_as_possible() {
    let changed = two(0.1, ROWS, 20.0, false);
    let (said, all) = compared(changed.path(), &[]);
    let bias = row(&all, "static_bias");
    // No instrument has a serial number: the benches may differ too.
    assert_eq!(bias["agreement"], "differs", "{bias}");
    assert_eq!(kinds(bias), [("bench".into(), false), ("change".into(), false)], "{bias}");
    assert!(said.out.contains("real change?"), "{}", said.out);
    let warmer = two(0.1, ROWS, 23.0, false);
    let (said, all) = compared(warmer.path(), &[]);
    let found = kinds(row(&all, "static_bias"));
    assert_eq!(found.first(), Some(&("temperature".to_owned(), false)), "{found:?}");
    assert!(said.out.contains("differ by 3.0 °C"), "{}", said.out);
}

#[test]
fn a_recording_that_is_not_at_hand_is_said_and_can_be_named() {
    let dir = two(0.0, ROWS, 20.0, true);
    std::fs::create_dir(dir.path().join("moved")).unwrap();
    std::fs::rename(dir.path().join("c.csv"), dir.path().join("moved/c.csv")).unwrap();
    let (said, all) = compared(dir.path(), &[]);
    assert!(said.out.contains("is not at hand"), "{}", said.out);
    assert_eq!(row(&all, "static_bias")["by_procedures"], Value::Null);
    std::fs::remove_dir_all(dir.path().join("c")).unwrap();
    let (_, all) = compared(dir.path(), &["--data", "m.csv", "--data", "moved/c.csv"]);
    assert_eq!(kinds(row(&all, "static_bias")), [("definition".into(), true)]);
    // The files in the wrong order are not the recordings of the results.
    std::fs::remove_dir_all(dir.path().join("c")).unwrap();
    let (said, all) = compared(dir.path(), &["--data", "moved/c.csv", "--data", "m.csv"]);
    assert!(said.out.contains("is not its recording"), "{}", said.out);
    assert_eq!(row(&all, "static_bias")["by_procedures"], Value::Null);
    let one = sagnac(dir.path(), &["compare", "maker", "customer", "--data", "m.csv", "--out", "e"]);
    assert!(one.code == 2 && one.err.contains("two files in their order"), "{one:?}");
    let none = sagnac(dir.path(), &["compare", "m.csv", "--data", "m.csv", "--out", "e"]);
    assert!(none.code == 2 && none.err.contains("same serial number"), "{none:?}");
    assert!(!dir.path().join("e").exists());
}

#[test]
fn what_both_results_share_drops_out_of_the_score() {
    let share = |one_table, change| {
        let (hits, of) = sagnac_studies::two_laboratories::drawn(one_table, change, 2000, 1);
        assert_eq!(of, 2000);
        hits as f64 / of as f64
    };
    // 5 % by chance, three standard deviations of 2000 pairs about it.
    for one_table in [true, false] {
        assert!((0.035..0.065).contains(&share(one_table, 0.0)), "{one_table}");
    }
    // A change that the error of the table would hide is found where both have the table.
    let (with, without) = (share(true, 2.0), share(false, 2.0));
    assert!(with > 0.95 && without < 0.6, "{with} {without}");
}
