//! Quantities without a limit: a list, or a column for each channel where there are several but few.

use super::part::Part;
use super::rows::{self, Row};
use crate::report::page::{Block, Column, Table, Value};
use crate::report::translator::Translator;
use std::collections::{BTreeMap, BTreeSet};

/// Channels that fit side by side on a page.
const MAX_COLUMNS: usize = 4;

/// The quantities without a limit.
pub fn further(part: &Part<'_>) -> Vec<Block> {
    let words = part.words;
    if part.further.is_empty() {
        return part.notes(first_note(part)..=part.footnotes.len()).into_iter().collect();
    }
    let heading = words.t(if part.judged.is_empty() { "report.measured" } else { "report.further" });
    let mut below = match Matrix::new(&part.further, words) {
        Some(matrix) => vec![Block::Table(matrix.table(&part.anchor, words))],
        None => list(part),
    };
    below.extend(part.notes(first_note(part)..=part.footnotes.len()));
    vec![Block::section("", heading, below)]
}

/// Number of the first footnote that stands here: those of rows with a limit stand below these, but for a phase, whose rows
/// with a limit stand on the first page.
fn first_note(part: &Part<'_>) -> usize {
    if part.is_phase() { 1 } else { part.limit_footnotes + 1 }
}

/// A row for each quantity. One that was searched for and not found needs no row.
fn list(part: &Part<'_>) -> Vec<Block> {
    let words = part.words;
    let is_shown = |r: &&Row<'_>| {
        let m = r.of;
        m.identifiable
            || m.reference.is_some()
            || !rows::bound_alone(m, words).is_empty()
            || !r.hint(words).is_empty()
    };
    let (shown, absent): (Vec<&Row<'_>>, Vec<&Row<'_>>) = part.further.iter().partition(is_shown);
    let name = |r: &&Row<'_>| Value::Sentence(r.name(words)).noted(&part.anchor, r.footnotes.clone());
    let mut table = Table::new("measurands cards", shown.len())
        .column(words.column("report.quantity"), shown.iter().map(name));
    if part.several_channels {
        table = table.column(words.column("report.channel"), shown.iter().map(|r| r.channel(words)));
    }
    table = table
        .column(words.column("report.unit").class("unit"), shown.iter().map(|r| words.unit(&r.of.unit)))
        .column(words.number_column("report.value").class("n value"), shown.iter().map(|r| r.value(words)))
        .column(
            words.number_column("report.interval95").class("n interval"),
            shown.iter().map(|r| rows::interval(r.of, words)),
        );
    if part.has_references() {
        table =
            table.column(words.number_column("report.reference"), shown.iter().map(|r| r.reference(words)));
    }
    table = table.column(words.column("report.method"), shown.iter().map(|r| r.method(words)));
    let names: Vec<String> = absent.iter().map(|r| r.name_in(part.several_channels, words)).collect();
    let absent = format!("{}: {}.", words.t("report.absent_quantities"), names.join("; "));
    std::iter::once(Block::Table(table)).chain((!names.is_empty()).then_some(Block::Hint(absent))).collect()
}

/// Rows set out by channel.
struct Matrix<'a> {
    /// Channels, in the order of the record.
    channels: Vec<String>,
    /// A line for each quantity: a cell for each channel, none where the channel lacks the quantity.
    lines: Vec<Vec<Option<&'a Row<'a>>>>,
}

impl<'a> Matrix<'a> {
    /// Sets rows out by channel; `None` for one channel, for more than fit, or for a quantity that a channel has twice.
    fn new(rows: &'a [Row<'a>], words: Translator) -> Option<Matrix<'a>> {
        let mut channels: Vec<String> = vec![];
        for row in rows {
            let channel = row.channel(words);
            if !channels.contains(&channel) {
                channels.push(channel);
            }
        }
        // Rows by zone or by ramp are a list, not a channel beside others.
        if !(2..=MAX_COLUMNS).contains(&channels.len()) || rows.iter().any(|r| r.of.channel.contains('@')) {
            return None;
        }
        let mut quantities: Vec<(&str, &str)> = vec![];
        let mut lines: Vec<Vec<Option<&Row<'_>>>> = vec![];
        for row in rows {
            let channel = row.channel(words);
            let column = channels.iter().position(|c| *c == channel)?;
            let quantity = (row.of.id.as_str(), row.of.unit.as_str());
            let at = quantities.iter().position(|q| *q == quantity).unwrap_or_else(|| {
                quantities.push(quantity);
                lines.push(vec![None; channels.len()]);
                lines.len() - 1
            });
            let cell = lines.get_mut(at)?.get_mut(column)?;
            if cell.is_some() {
                return None;
            }
            *cell = Some(row);
        }
        Some(Matrix { channels, lines })
    }

    fn table(&self, anchor: &str, words: Translator) -> Table {
        let firsts: Vec<&Row<'_>> =
            self.lines.iter().filter_map(|l| l.iter().flatten().next().copied()).collect();
        let name = |r: &&Row<'_>| Value::Sentence(r.name(words)).over([Value::Text(r.method(words))]);
        let table = Table::new("measurands matrix cards", self.lines.len())
            .column(words.column("report.quantity"), firsts.iter().map(name))
            .column(words.column("report.unit").class("unit"), firsts.iter().map(|r| words.unit(&r.of.unit)));
        self.channels.iter().enumerate().fold(table, |table, (i, channel)| {
            let cells = self.lines.iter().map(|line| {
                let row = line.get(i).copied().flatten();
                row.map_or(Value::Empty, |r| cell(r, anchor, words))
            });
            table.column(Column::number(channel.as_str(), channel.as_str()), cells.collect::<Vec<_>>())
        })
    }
}

/// Value with its footnotes, below it the interval or why there is no value, and the reference.
fn cell(row: &Row<'_>, anchor: &str, words: Translator) -> Value {
    let reference = row.reference(words);
    let reference =
        if reference.is_empty() { reference } else { format!("{} {reference}", words.t("report.reference")) };
    let below = [rows::interval(row.of, words), row.hint(words), reference];
    let value = Value::Text(rows::value(row.of, words)).noted(anchor, row.footnotes.clone());
    value.over(below.map(Value::Text))
}

/// Where the reference values come from, each source once with the conventions of its values.
pub fn references(part: &Part<'_>) -> Option<Block> {
    let words = part.words;
    let mut sources: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for r in part.record.measurands.iter().filter_map(|m| m.reference.as_ref()) {
        let notes = sources.entry(words.local(&r.source)).or_default();
        notes.extend(r.note.as_ref().map(|n| words.local(n)));
    }
    let said = |(source, notes): (String, BTreeSet<String>)| match notes.len() {
        0 => source,
        _ => {
            let notes: Vec<String> = notes.into_iter().collect();
            words.with("report.reference_notes", &[("source", &source), ("notes", &notes.join("; "))])
        }
    };
    let sources: Vec<String> = sources.into_iter().map(said).collect();
    let sentence = format!("{} {}", words.t("report.references_from"), sources.join("; "));
    (!sources.is_empty()).then_some(Block::Hint(sentence))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::i18n::Lang;
    use crate::record::MeasurandRecord;

    const WORDS: Translator = Translator { lang: Lang::En };

    fn measured(id: &str, channel: &str) -> MeasurandRecord {
        MeasurandRecord { id: id.into(), channel: channel.into(), ..MeasurandRecord::default() }
    }

    fn rows(of: &[MeasurandRecord]) -> Vec<Row<'_>> {
        of.iter().map(|m| Row { of: m, footnotes: vec![] }).collect()
    }

    #[test]
    fn no_row_is_lost_and_none_stands_under_another_channel() {
        let all = [measured("a", "x"), measured("a", "y"), measured("b", "y"), measured("c", "x")];
        let rows = rows(&all);
        let matrix = Matrix::new(&rows, WORDS).unwrap();
        assert_eq!(matrix.channels, ["x", "y"]);
        assert_eq!(matrix.lines.len(), 3);
        assert_eq!(matrix.lines.iter().flatten().flatten().count(), rows.len());
        for line in &matrix.lines {
            for (cell, channel) in line.iter().zip(&matrix.channels) {
                assert!(cell.is_none_or(|c| c.of.channel == *channel));
            }
        }
    }

    #[test]
    fn what_does_not_fit_side_by_side_stays_a_list() {
        let is_list = |all: &[MeasurandRecord]| Matrix::new(&rows(all), WORDS).is_none();
        assert!(is_list(&[measured("a", "x"), measured("b", "x")]));
        assert!(is_list(&[measured("a", "x"), measured("a", "x"), measured("a", "y")]));
        let many: Vec<MeasurandRecord> = (0..5).map(|i| measured("a", &i.to_string())).collect();
        assert!(is_list(&many));
    }
}
