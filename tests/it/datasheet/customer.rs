//! The sheet for customers.

use super::{of_the_lot, sheet};
use crate::support::shared::{SharedRun, shared};
use crate::support::{sagnac, shipped};
use serde_json::{Value, json};
use tempfile::tempdir;

fn for_customers() -> &'static SharedRun {
    let results = shipped("samples/lot/*/result.json");
    shared(&["datasheet", &results, "--audience", "customer", "--lang", "en"], "sheet")
}

#[test]
fn the_page_begins_with_what_a_customer_reads_and_the_engineers_page_is_its_annex() {
    let page = for_customers().text("datasheet.html");
    let (first, annex) = page.split_once("Annex: how the values were obtained").expect("an annex");
    for head in ["Parameter", "Conditions", "Min", "Typ", "Max", "Unit"] {
        assert!(first.contains(&format!(">{head}</th>")), "{head}");
    }
    assert!(first.contains("Typical curves") && first.contains("<svg"));
    // Russian beside Allan values are a block of the sheet, and stand once.
    assert_eq!(
        (first.matches("Russian value").count() > 0, annex.matches("Russian value</th>").count()),
        (true, 0)
    );
    assert!(!first.contains("SN-30") && annex.contains("SN-3001"), "units are named in the annex alone");
}

#[test]
fn bounds_are_those_of_the_record_and_the_record_of_an_engineer_stays() {
    let (customer, engineer) = (sheet(&for_customers().out), sheet(&of_the_lot().out));
    assert_eq!(customer["audience"], "customer");
    assert!(engineer.get("audience").is_none());
    assert_eq!(customer["quantities"], engineer["quantities"]);
}

#[test]
fn a_page_is_made_anew_for_the_same_reader() {
    let dir = tempdir().unwrap();
    let said = sagnac(dir.path(), &["report", for_customers().path(), "--lang", "ru", "--out", "again"]);
    assert_eq!(said.code, 0, "{said:?}");
    let page = std::fs::read_to_string(dir.path().join("again/datasheet.html")).unwrap();
    assert!(page.contains("Технические характеристики") && page.contains(">Макс.</th>"), "{page}");
}

/// Results of units, all but one of their quantities only bounded.
fn unresolved(folder: &std::path::Path) {
    for i in 1..=6 {
        let limit = 0.01 + 0.001 * f64::from(i);
        let result: Value = json!({
            "format": "result/1", "procedure": {"id": "p", "revision": "A"}, "verdict": "pass",
            "unit_under_test": {"serial": format!("S{i}"), "model": "M"},
            "measurands": [{
                "id": "rate_random_walk", "channel": "rate", "unit": "deg/h/sqrt(h)", "identifiable": false,
                "upper_limit": {"value": limit, "coverage": 0.95}
            }]
        });
        std::fs::write(folder.join(format!("{i}.json")), result.to_string()).unwrap();
    }
}

#[test]
fn a_row_that_no_unit_resolves_shows_its_bound_and_says_so() {
    let dir = tempdir().unwrap();
    unresolved(dir.path());
    let args = ["datasheet", "*.json", "--audience", "customer", "--lang", "en", "--out", "sheet"];
    let said = sagnac(dir.path(), &args);
    assert_eq!(said.code, 0, "{said:?}");
    let page = std::fs::read_to_string(dir.path().join("sheet/datasheet.md")).unwrap();
    let (first, _) = page.split_once("Annex").expect("an annex");
    assert!(first.contains("≤\u{202f}0.016") && first.contains("Not resolved in any unit"), "{first}");
}
