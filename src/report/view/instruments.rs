//! Instruments with the state of their calibration.

use super::common::status;
use super::part::Part;
use crate::i18n::Arg;
use crate::record::{ConditionStatus, InstrumentRecord, Message, RunRecord};
use crate::report::number::NOTHING;
use crate::report::page::{Block, State, Table, Value};
use crate::report::translator::Translator;

/// The instruments that are declared.
pub fn section(part: &Part<'_>) -> Vec<Block> {
    let (record, words) = (part.record, part.words);
    let all = &record.instruments;
    if all.is_empty() {
        return vec![];
    }
    let or_nothing = |text: &Option<String>| text.clone().unwrap_or_else(|| NOTHING.to_owned());
    let mut table = Table::new("cards", all.len())
        .column(words.column("report.instrument"), all.iter().map(|i| words.local(&i.name)))
        .column(words.column("report.serial"), all.iter().map(|i| or_nothing(&i.serial)));
    if all.iter().any(|i| i.certificate.is_some() || i.calibrated.is_some()) {
        table = table.column(words.column("report.certificate"), all.iter().map(certificate));
    }
    table = table
        .column(words.column("report.calibration_due"), all.iter().map(|i| or_nothing(&i.calibration_due)))
        .column(words.column("report.state"), all.iter().map(|i| Value::State(state(i, record, words))));
    let hint = Block::Hint(words.t("report.instruments_declared"));
    vec![Block::section("", words.t("report.instruments"), vec![hint, Block::Table(table)])]
}

/// Number of the certificate with the day of the calibration.
fn certificate(i: &InstrumentRecord) -> String {
    let both = [i.certificate.as_deref(), i.calibrated.as_deref()];
    let stated: Vec<&str> = both.into_iter().flatten().collect();
    if stated.is_empty() { NOTHING.to_owned() } else { stated.join(", ") }
}

/// The state of the calibration of an instrument.
pub fn state(i: &InstrumentRecord, record: &RunRecord, words: Translator) -> State {
    let calibration = calibration(i, record);
    let id = if calibration == "unidentified" { "remark" } else { status(i.status) };
    State { id: id.to_owned(), word: words.name("calibration", calibration) }
}

/// Id of what is to be said of a calibration: why it is remarked on, where its condition says so.
fn calibration(i: &InstrumentRecord, record: &RunRecord) -> &'static str {
    let of_instrument = |n: &&Message| match n.args.get("instrument") {
        Some(Arg::Text(name)) => *name == i.name.text(),
        Some(Arg::Local(name)) => *name == i.name,
        _ => false,
    };
    let notes = record.conditions.iter().filter(|c| c.id == "calibration").filter_map(|c| c.message.as_ref());
    match notes.into_iter().find(of_instrument).map(|n| n.id.as_ref()) {
        Some("note.condition.calibration_unidentified") => "unidentified",
        Some("note.condition.calibration_overdue") => "overdue",
        Some("note.condition.calibration_unknown") => "unknown",
        // Results of earlier versions called an instrument without a serial number valid.
        _ if i.serial.is_none() && i.status == ConditionStatus::Ok => "unidentified",
        _ => status(i.status),
    }
}
