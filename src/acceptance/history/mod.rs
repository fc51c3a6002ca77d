//! What the results of a store tell over time.

mod charts;
mod counts;
pub mod figures;
mod selection;
mod stability;
mod units;

use crate::i18n::{Arg, Note, note};
use crate::record::{
    HISTORY_FORMAT, HistoryAsked, HistoryChart, HistoryChartOf, HistoryRecord, HistoryResult, Message,
    Program,
};
use crate::store::Attempt;
use selection::Selection;

/// Benches that a note names.
const MAX_NAMED_BENCHES: usize = 5;

/// The history of results that are in the order of time. `common` is the standard uncertainty that all tests of a unit share, in
/// the unit of the measurand that was asked for.
pub fn history(attempts: &[Attempt], asked: HistoryAsked, common: f64) -> HistoryRecord {
    let selection = Selection::of(attempts);
    let quantities = selection.quantities(asked.measurand.as_deref());
    let charts = charts::charts(&selection, &quantities, asked.serial.is_some());
    let of_unit = asked.serial.is_some();
    let drifts = if of_unit { units::drifts(&selection, &quantities, common) } else { vec![] };
    let stabilities = if of_unit { stability::stabilities(&selection, &quantities) } else { vec![] };
    HistoryRecord {
        format: HISTORY_FORMAT.to_owned(),
        program: Program::this(),
        counts: counts::counts(&selection),
        yields: counts::yields(&selection),
        reasons: counts::reasons(&selection),
        months: counts::months(&selection),
        stations: if asked.serial.is_some() { vec![] } else { units::stations(&selection, &quantities) },
        notes: notes(&selection, &charts).into_iter().map(Message::from).collect(),
        results: selection.all().map(|t| result(t.attempt, t.is_done)).collect(),
        asked,
        charts,
        drifts,
        stabilities,
    }
}

/// What must be known of the whole: benches that wander, results that count in no yield.
fn notes(selection: &Selection<'_>, charts: &[HistoryChart]) -> Vec<Note> {
    let mut notes = vec![];
    let wander: Vec<Arg> = charts
        .iter()
        .filter(|c| c.of == HistoryChartOf::Bench && c.control.as_ref().is_some_and(|c| !c.in_control))
        .map(|c| {
            note!(
                "history.note.bench",
                station = c.station.clone().unwrap_or_default(),
                serial = c.serial.clone().unwrap_or_default(),
                quantity = Arg::key("measurand", &c.quantity.measurand)
            )
            .into()
        })
        .collect();
    if !wander.is_empty() {
        let n = wander.len();
        let shown = wander.into_iter().take(MAX_NAMED_BENCHES).collect();
        notes.push(note!("history.note.wander", n, benches = Arg::Several(shown, "; ".into())));
    }
    let counts = counts::counts(selection);
    for (key, n) in [
        ("history.note.reference", counts.of_reference_units),
        ("history.note.not_done", counts.not_done),
        ("history.note.superseded", counts.superseded),
        ("history.note.without_serial", counts.without_serial),
        ("history.note.incomplete", counts.incomplete),
    ] {
        if n > 0 {
            notes.push(Note::new(key).with("n", n));
        }
    }
    notes
}

fn result(attempt: &Attempt, done: bool) -> HistoryResult {
    let (unit, test) = (&attempt.entry.unit, &attempt.entry.test);
    HistoryResult {
        address: attempt.address.clone(),
        serial: unit.serial.clone(),
        model: unit.model.clone(),
        lot: unit.lot.clone(),
        reference: unit.reference,
        procedure: test.procedure.clone(),
        revision: test.revision.clone(),
        station: test.station.clone(),
        operator: test.operator.clone(),
        evaluated_at: test.evaluated_at.clone(),
        attempt: attempt.number,
        verdict: attempt.entry.verdict,
        done,
        reasons: attempt.entry.reasons.iter().map(|r| (r.kind.id().to_owned(), r.name.clone())).collect(),
        superseded_by: attempt.superseded.as_ref().map(|c| c.by.clone()),
        superseded_because: attempt.superseded.as_ref().map(|c| c.reason.clone()),
    }
}
