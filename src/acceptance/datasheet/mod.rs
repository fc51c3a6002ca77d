//! The data sheet of a lot, from the results of its units.

mod compensation_table;
mod curves;
pub mod figures;
pub mod limits;
mod outlook;
mod over_temperature;
mod pairs;
mod quantity;
mod rows;
mod units;

pub use rows::apply;
pub use units::{Refusal, TestedUnit, select};

use crate::i18n::note;
use crate::lot::free::units_for_largest;
use crate::lot::tolerance::Promise;
use crate::record::{
    DATASHEET_FORMAT, DataSheet, Message, Program, SheetAudience, SheetCondition, SheetResult,
};
use crate::recording::window::Window;
use std::collections::BTreeSet;
use units::Selected;

/// The data sheet of units that were selected.
pub fn datasheet(selected: Selected, promise: Promise, made_at: String) -> DataSheet {
    let Selected { units, model, procedure, mut notes } = selected;
    let lots: BTreeSet<&str> = units.iter().map(TestedUnit::lot_name).collect();
    let quantities = quantity::quantities(&units, promise);
    if let Some(n) = units_for_largest(promise).filter(|n| units.len() < *n) {
        notes.push(note!(
            "datasheet.note.largest",
            n = units.len(),
            needed = n,
            proportion = 100.0 * promise.proportion,
            confidence = 100.0 * promise.confidence
        ));
    }
    DataSheet {
        format: DATASHEET_FORMAT.to_owned(),
        program: Program::this(),
        made_at,
        audience: SheetAudience::default(),
        title: None,
        model,
        procedure,
        units: units.len(),
        lots: lots.len(),
        notes: notes.into_iter().map(Message::from).collect(),
        conditions: conditions(&units),
        pairs: pairs::pairs(&quantities),
        curves: curves::curves(&units, promise),
        temperature_curves: over_temperature::curves(&units, promise),
        quantities,
        results: units
            .iter()
            .map(|u| SheetResult {
                serial: u.serial.clone(),
                lot: u.result.unit_under_test.lot.clone(),
                verdict: u.result.verdict,
                path: u.path.clone(),
                sha256: u.sha256.clone(),
            })
            .collect(),
    }
}

/// Conditions that the results tell of: temperature, how much was evaluated, what of the start was left out, sample rate.
fn conditions(units: &[TestedUnit]) -> Vec<SheetCondition> {
    let windows = || units.iter().map(|u| Some(&u.result.window).filter(|w| **w != Window::default()));
    // The values of each unit that tells any.
    let of = |id: &str, values: Vec<Vec<f64>>| {
        let told = values.iter().filter(|v| !v.is_empty()).count();
        let all = || values.iter().flatten().copied();
        let (from, to) = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
        (from.is_finite() && to.is_finite()).then(|| SheetCondition {
            id: id.to_owned(),
            from,
            to,
            units: told,
        })
    };
    let temperatures = |u: &TestedUnit| -> Vec<f64> {
        let met = u.result.conditions.iter().filter(|c| c.id == "temperature");
        met.flat_map(|c| ["min", "max"].map(|end| c.observed.get(end)?.as_f64())).flatten().collect()
    };
    let rates = |u: &TestedUnit| -> Vec<f64> {
        let intervals = u.result.recording.iter().map(|r| r.sample_interval_s);
        intervals.filter(|i| *i > 0.0).map(|i| 1.0 / i).collect()
    };
    let warm_up = |w: &Window| {
        w.excluded.iter().filter(|e| e.reason == "warm_up").map(|e| e.to_s - e.from_s).sum::<f64>()
    };
    [
        of("temperature_degC", units.iter().map(temperatures).collect()),
        of("duration_s", windows().map(|w| w.iter().map(|w| w.usable_s).collect()).collect()),
        of("warm_up_s", windows().map(|w| w.into_iter().map(warm_up).collect()).collect()),
        of("sample_rate_hz", units.iter().map(rates).collect()),
    ]
    .into_iter()
    .flatten()
    .collect()
}
