//! The sheet for customers, one page: a row for each parameter with its footnotes, typical curves, Russian beside Allan values.
//! The page of the engineer is its annex.

use super::quantity::{Printed, limit_text};
use super::shared::{condition, pairs_section, promise, size, title};
use crate::i18n::Localize;
use crate::record::{DataSheet, SheetBound, SheetOf, SheetQuantity, SheetSide};
use crate::report::number::{NOTHING, bound, limit};
use crate::report::page::{Block, Footnotes, Head, Table, Value};
use crate::report::translator::Translator;
use crate::report::view::FigureView;

/// Beginning of the marks of its footnotes.
const ANCHOR: &str = "sheet-";

/// One parameter as customers read it.
struct Row {
    /// Name, with its footnotes.
    parameter: Value,
    conditions: String,
    min: String,
    typical: String,
    max: String,
    unit: String,
}

/// The head and the blocks of the page.
pub(super) fn blocks(
    sheet: &DataSheet,
    all: &[Printed<'_>],
    curves: Vec<FigureView>,
    words: Translator,
) -> Vec<Block> {
    let head =
        Head { kind: words.t("datasheet.customer.kind"), title: title(sheet, words), ..Head::default() };
    let mut footnotes: Vec<String> = vec![];
    let rows: Vec<Row> = all.iter().map(|printed| row(printed, &mut footnotes, words)).collect();
    let curves = curves.into_iter().map(|f| Block::Figure(Box::new(FigureView { is_titled: true, ..f })));
    let curves: Vec<Block> = curves.collect();
    let typical =
        (!curves.is_empty()).then(|| Block::section("figures", words.t("datasheet.customer.curves"), curves));
    let notes = (1..).zip(footnotes).collect::<Vec<_>>();
    let footnotes =
        (!notes.is_empty()).then(|| Block::Footnotes(Footnotes { anchor: ANCHOR.to_owned(), notes }));
    let below = [Some(Block::Table(table(&rows, words))), footnotes];
    std::iter::once(Block::Head(head))
        .chain([Block::Hint(general(sheet, words))])
        .chain([Block::Section("customer", below.into_iter().flatten().collect())])
        .chain(typical)
        .chain(pairs_section(sheet, words))
        .chain([Block::PageEnd])
        .collect()
}

/// What holds for every row: what the columns promise, of how many units, under which conditions.
fn general(sheet: &DataSheet, words: Translator) -> String {
    let facts = sheet.conditions.iter().map(|c| {
        let (name, span) = condition(c, words);
        words.with("datasheet.customer.condition", &[("name", &name), ("span", &span)])
    });
    let conditions = facts.collect::<Vec<_>>().join("; ");
    let conditions = (!conditions.is_empty())
        .then(|| words.with("datasheet.customer.conditions", &[("conditions", &conditions)]));
    let columns = words.with("datasheet.customer.columns", &[("size", &size(sheet, words))]);
    [promise(sheet, words), Some(columns), conditions].into_iter().flatten().collect::<Vec<_>>().join(" ")
}

fn table(rows: &[Row], words: Translator) -> Table {
    let column = |key: &str| words.column(&format!("datasheet.customer.column.{key}"));
    let number = |key: &str| words.number_column(&format!("datasheet.customer.column.{key}"));
    let text = |of: fn(&Row) -> &String| rows.iter().map(move |row| of(row).clone());
    Table::new("sheet cards", rows.len())
        .column(column("parameter"), rows.iter().map(|row| row.parameter.clone()))
        .column(column("conditions"), text(|row| &row.conditions))
        .column(number("min"), text(|row| &row.min))
        .column(number("typical"), rows.iter().map(|row| Value::Text(row.typical.clone()).strong()))
        .column(number("max"), text(|row| &row.max))
        .column(column("unit").class("unit"), text(|row| &row.unit))
}

/// A parameter; its footnotes join those that are there.
fn row(printed: &Printed<'_>, footnotes: &mut Vec<String>, words: Translator) -> Row {
    let q = printed.quantity;
    let mut own: Vec<String> = q.footnote.iter().map(|f| words.local(f)).collect();
    let (min, max) = ends(q, &mut own, words);
    let mut numbers: Vec<usize> = vec![];
    for sentence in own {
        let known = footnotes.iter().position(|f| *f == sentence);
        let place = known.unwrap_or_else(|| {
            footnotes.push(sentence);
            footnotes.len() - 1
        });
        numbers.push(place + 1);
    }
    numbers.sort_unstable();
    let conditions = [q.phase.clone(), q.reading.as_ref().map(|how| words.name("how", how))];
    let typical = q.typical.as_ref().map_or_else(|| NOTHING.to_owned(), |t| printed.show(t.value));
    Row {
        parameter: Value::Sentence(printed.parameter()).noted(ANCHOR, numbers),
        conditions: conditions.into_iter().flatten().collect::<Vec<_>>().join("; "),
        min: min.unwrap_or_else(|| NOTHING.to_owned()),
        typical,
        max: max.unwrap_or_else(|| NOTHING.to_owned()),
        unit: words.unit(&q.unit),
    }
}

/// What can be promised: the bounds for true values; without them the bound of what no unit resolved, or the limit that every
/// unit is tested by, each with its footnote.
fn ends(q: &SheetQuantity, notes: &mut Vec<String>, words: Translator) -> (Option<String>, Option<String>) {
    let on = |side: SheetSide| q.bounds.iter().find(|b| b.of == SheetOf::True && b.side == side);
    let shown = |b: &SheetBound| bound(b.value, b.side == SheetSide::Upper, words.lang);
    let (lower, upper) = (on(SheetSide::Lower).map(shown), on(SheetSide::Upper).map(shown));
    if q.bounded > 0 && q.bounded < q.units {
        let n = |v: usize| v.to_string();
        let counts = [("bounded", n(q.bounded)), ("units", n(q.units))];
        let counts: Vec<(&str, &str)> = counts.iter().map(|(k, v)| (*k, v.as_str())).collect();
        notes.push(words.with("datasheet.customer.partly_bounded", &counts));
    }
    if lower.is_some() || upper.is_some() {
        return (lower, upper);
    }
    // Why nothing is promised stands in the notes of the quantity.
    notes.extend(q.notes.iter().map(|n| n.say(words.lang)));
    let unresolved = q.values.iter().filter(|v| v.value.is_none()).filter_map(|v| v.upper_limit.as_ref());
    if q.bounded == q.units
        && let Some(largest) = unresolved.map(|u| u.value).reduce(f64::max)
    {
        notes.push(words.t("datasheet.customer.unresolved"));
        return (None, Some(format!("≤\u{202f}{}", bound(largest, true, words.lang))));
    }
    let Some(limits) = q.limit.filter(|_| !limit_text(q, words).is_empty()) else { return (None, None) };
    notes.push(words.t("datasheet.customer.limit"));
    let of = |v: Option<f64>| v.map(|v| limit(v, words.lang));
    (of(limits.min), of(limits.max))
}

/// The heading of the page of the engineer below the sheet.
pub(super) fn annex(words: Translator) -> Block {
    Block::Section("annex", vec![Block::heading(words.t("datasheet.customer.annex"))])
}
