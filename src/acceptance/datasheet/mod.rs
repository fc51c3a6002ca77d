//! The data sheet of a lot, from the results of its units.

mod curves;
pub mod figures;
pub mod limits;
mod outlook;
mod pairs;
mod quantity;
mod rows;
mod units;

pub use rows::apply;
pub use units::{Refusal, TestedUnit, select};

use crate::i18n::Note;
use crate::lot::free::units_for_largest;
use crate::lot::tolerance::Promise;
use crate::record::{DATASHEET_FORMAT, DataSheet, Message, Program, SheetCondition, SheetResult};
use std::collections::BTreeSet;
use units::Selected;

/// The data sheet of units that were selected.
pub fn datasheet(selected: Selected, promise: Promise, made_at: String) -> DataSheet {
    let Selected { units, model, procedure, mut notes } = selected;
    let lots: BTreeSet<&str> = units.iter().map(TestedUnit::lot_name).collect();
    let quantities = quantity::quantities(&units, promise);
    if let Some(n) = units_for_largest(promise).filter(|n| units.len() < *n) {
        notes.push(
            Note::new("datasheet.note.largest")
                .with("n", units.len())
                .with("needed", n)
                .with("proportion", 100.0 * promise.proportion)
                .with("confidence", 100.0 * promise.confidence),
        );
    }
    DataSheet {
        format: DATASHEET_FORMAT.to_owned(),
        program: Program { name: "sagnac".to_owned(), version: env!("CARGO_PKG_VERSION").to_owned() },
        made_at,
        title: None,
        model,
        procedure,
        units: units.len(),
        lots: lots.len(),
        notes: notes.into_iter().map(Message::from).collect(),
        conditions: conditions(&units),
        pairs: pairs::pairs(&quantities),
        curves: curves::curves(&units, promise),
        quantities,
        results: units
            .iter()
            .map(|u| SheetResult {
                serial: u.serial.clone(),
                lot: u.input.unit_under_test.lot.clone(),
                verdict: u.input.verdict,
                path: u.path.clone(),
                sha256: u.sha256.clone(),
            })
            .collect(),
    }
}

/// What the results tell of the conditions: how much was evaluated, and what of the start was left out.
fn conditions(units: &[TestedUnit]) -> Vec<SheetCondition> {
    let windows = || units.iter().filter_map(|u| u.input.window.as_ref());
    let of = |id: &str, values: Vec<f64>| {
        let (from, to) =
            values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)));
        (from.is_finite() && to.is_finite()).then(|| SheetCondition {
            id: id.to_owned(),
            from,
            to,
            units: values.len(),
        })
    };
    let warm_up = |w: &crate::recording::window::Window| {
        w.excluded.iter().filter(|e| e.reason == "warm_up").map(|e| e.to_s - e.from_s).sum::<f64>()
    };
    [
        of("duration_s", windows().map(|w| w.usable_s).collect()),
        of("warm_up_s", windows().map(warm_up).collect()),
    ]
    .into_iter()
    .flatten()
    .collect()
}
