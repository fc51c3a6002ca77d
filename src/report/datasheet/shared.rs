//! What both readers of a data sheet see: title, size, promise, conditions, Russian beside Allan values.

use super::quantity::several_channels;
use crate::record::{DataSheet, SheetCondition, SheetPair};
use crate::report::number::{count, duration, limit_digits};
use crate::report::page::{Block, Joined, Table, Value};
use crate::report::translator::Translator;

/// Russian beside Allan values; `None` where the sheet has none.
pub(super) fn pairs_section(sheet: &DataSheet, words: Translator) -> Option<Block> {
    let table = || pairs(&sheet.pairs, several_channels(sheet), words);
    let below = || vec![Block::Table(table()), Block::Hint(words.t("datasheet.pairs_hint"))];
    (!sheet.pairs.is_empty()).then(|| Block::section("", words.t("datasheet.pairs"), below()))
}

/// The title that a sheet file gives, or the model, or the procedure where none is named.
pub(super) fn title(sheet: &DataSheet, words: Translator) -> String {
    match (&sheet.title, &sheet.model) {
        (Some(title), _) => words.local(title),
        (None, Some(model)) => model.clone(),
        (None, None) => sheet.procedure.id.clone(),
    }
}

/// Units and lots, in words.
pub(super) fn size(sheet: &DataSheet, words: Translator) -> String {
    let count = |n: usize| count(n as u64, words.lang);
    words.with("datasheet.size", &[("units", &count(sheet.units)), ("lots", &count(sheet.lots))])
}

/// A sentence on what the bounds promise; `None` where there is none.
pub(super) fn promise(sheet: &DataSheet, words: Translator) -> Option<String> {
    let bound = sheet.quantities.iter().find_map(|q| q.bounds.first())?;
    let percent = |p: f64| limit_digits(100.0 * p, 4, words.lang);
    Some(words.with(
        "datasheet.promise",
        &[("proportion", &percent(bound.proportion)), ("confidence", &percent(bound.confidence))],
    ))
}

/// Name and range of a condition.
pub(super) fn condition(c: &SheetCondition, words: Translator) -> (String, String) {
    let printed = |v: f64| match c.id.as_str() {
        "temperature_degC" => words.quantity(&limit_digits(v, 4, words.lang), "degC"),
        "sample_rate_hz" => words.quantity(&limit_digits(v, 4, words.lang), "Hz"),
        _ => duration(v, words.lang),
    };
    let (from, to) = (printed(c.from), printed(c.to));
    let span = if from == to { from } else { words.with("datasheet.span", &[("from", &from), ("to", &to)]) };
    (words.name("datasheet.condition", &c.id), span)
}

/// Russian beside Allan values, a pair a row.
fn pairs(pairs: &[SheetPair], several: bool, words: Translator) -> Table {
    let digits = |v: f64| limit_digits(v, 3, words.lang);
    let russian = |p: &SheetPair| {
        let name = words.name("measurand", &p.russian);
        Value::Sentence(if several { format!("{name} · {}", p.channel) } else { name })
    };
    let ratio = |p: &SheetPair| {
        let [low, high] = p.range.map(digits);
        let range = words.with("report.interval", &[("low", &low), ("high", &high)]);
        Value::Text(digits(p.ratio)).strong().detail(Joined::Interval, range)
    };
    let value = |v: f64, p: &SheetPair| words.quantity(&digits(v), &p.unit);
    let allan = |p: &SheetPair| Value::Sentence(words.name("measurand", &p.allan));
    let column = |key: &str| words.column(&format!("datasheet.column.{key}"));
    let number = |key: &str| words.number_column(&format!("datasheet.column.{key}"));
    Table::new("sheet cards", pairs.len())
        .column(column("russian"), pairs.iter().map(russian))
        .column(number("median"), pairs.iter().map(|p| value(p.russian_value, p)))
        .column(column("allan"), pairs.iter().map(allan))
        .column(number("median"), pairs.iter().map(|p| value(p.allan_value, p)))
        .column(number("ratio"), pairs.iter().map(ratio))
        .column(number("units"), pairs.iter().map(|p| count(p.units as u64, words.lang)))
}
