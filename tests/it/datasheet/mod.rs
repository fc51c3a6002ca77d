//! The verb `datasheet`, as a user runs it: on results of the program, and on results that others write.
//!
//! `cargo test --test it datasheet -- --ignored write_the_samples` writes `samples/lot/` anew.

mod by_others;
mod customer;
mod over_temperature;
mod rows;
mod samples;
mod tables;

use crate::support::shared::{SharedRun, shared};
use crate::support::shipped;
use serde_json::Value;
use std::path::Path;

/// The data sheet of the sample lot.
pub fn of_the_lot() -> &'static SharedRun {
    shared(&["datasheet", &shipped("samples/lot/*/result.json"), "--lang", "en"], "sheet")
}

/// The data sheet in a folder.
fn sheet(folder: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(folder.join("datasheet.json")).unwrap()).unwrap()
}

/// A quantity of a data sheet.
fn quantity<'a>(sheet: &'a Value, id: &str) -> &'a Value {
    sheet["quantities"].as_array().unwrap().iter().find(|q| q["id"] == id).unwrap_or_else(|| panic!("{id}"))
}

/// A bound of a quantity.
fn bound(quantity: &Value, of: &str, side: &str) -> f64 {
    let all = quantity["bounds"].as_array().unwrap();
    let one = all.iter().find(|b| b["of"] == of && b["side"] == side);
    one.unwrap_or_else(|| panic!("{of} {side}: {quantity}"))["value"].as_f64().unwrap()
}

/// The names of notes.
fn notes(of: &Value) -> Vec<String> {
    of["notes"].as_array().unwrap().iter().map(|n| n["id"].as_str().unwrap().to_owned()).collect()
}
