//! Quantities with a limit, and how they were obtained.

use super::part::{Part, Phase};
use super::rows::{self, Row};
use crate::report::page::{Block, Facts, Row as Line, State, Table, Value};
use crate::report::translator::Translator;

/// A line of the table of limits.
enum Limit<'a> {
    /// The name of a phase, above its rows.
    Phase(&'a Phase<'a>),
    /// A row of a run or of a phase.
    Row(&'a Part<'a>, &'a Row<'a>),
}

/// The quantities with a limit; those of phases below the name of each.
pub fn limits(whole: &Part<'_>, phases: &[Phase<'_>]) -> Vec<Block> {
    let words = whole.words;
    if whole.judged.is_empty() {
        return vec![];
    }
    let lines: Vec<Limit<'_>> = if phases.is_empty() {
        whole.judged.iter().map(|r| Limit::Row(whole, r)).collect()
    } else {
        phases.iter().flat_map(of_phase).collect()
    };
    let shared = shared_rule(whole);
    let rule = |r: &Row<'_>| if shared.is_some() { String::new() } else { r.rule(words) };
    let cells = |of: &dyn Fn(&Row<'_>) -> Value| -> Vec<Value> {
        let cell = |line: &Limit<'_>| match line {
            Limit::Phase(_) => Value::Empty,
            Limit::Row(_, row) => of(row),
        };
        lines.iter().map(cell).collect()
    };
    let mut table = Table::new("measurands cards", lines.len())
        .column(words.column("report.quantity"), lines.iter().map(|l| first_cell(l, words)))
        .column(words.number_column("report.value").class("n value"), cells(&|r| r.value(words)))
        .column(
            words.number_column("report.interval95").class("n interval"),
            cells(&|r| Value::Text(rows::interval(r.of, words))),
        )
        .column(
            words.number_column("report.limit").class("n limit"),
            cells(&|r| Value::Text(r.limit(words)).over([Value::Text(rule(r))])),
        )
        .column(
            words.number_column("report.acceptance").class("n acceptance"),
            cells(&|r| Value::Text(r.acceptance(words))),
        )
        .column(words.number_column("report.margin"), cells(&|r| Value::Text(r.margin(words))))
        .column(words.number_column("report.risk"), cells(&|r| Value::Text(r.risk(words))));
    if whole.has_references() {
        table = table
            .column(words.number_column("report.reference"), cells(&|r| Value::Text(r.reference(words))));
    }
    table = table.column(words.column("report.verdict"), cells(&|r| verdict(r, words)));
    for (row, line) in table.rows.iter_mut().zip(&lines) {
        mark(row, line);
    }
    let rule = shared.map(|rule| Block::Hint(words.with("report.shared_rule", &[("rule", &rule)])));
    // Phases count their footnotes from 1 each, so that theirs stand where the phase does.
    let notes = if phases.is_empty() { whole.notes(1..=whole.limit_footnotes) } else { None };
    let below = rule.into_iter().chain([Block::Table(table)]).chain(notes).collect();
    vec![Block::section("limits", words.t("report.judged"), below)]
}

fn of_phase<'a>(phase: &'a Phase<'a>) -> Vec<Limit<'a>> {
    let part = phase.part.iter().flat_map(|p| p.judged.iter().map(move |r| Limit::Row(p, r)));
    std::iter::once(Limit::Phase(phase)).chain(part).collect()
}

/// The decision rule where all rows have the same one.
fn shared_rule(whole: &Part<'_>) -> Option<String> {
    let first = whole.judged.first()?.rule(whole.words);
    whole.judged.iter().all(|r| r.rule(whole.words) == first).then_some(first)
}

fn first_cell(line: &Limit<'_>, words: Translator) -> Value {
    match line {
        Limit::Phase(phase) => {
            let title = format!("{} {}: {}", words.t("phases.phase"), phase.number, phase.title(words));
            let verdict = phase.phase.verdict;
            let verdict = Value::state(verdict.id(), words.verdict(verdict));
            let link = Value::Link { text: title, to: format!("#{}", phase.mark()) };
            Value::Several { values: vec![link, verdict], between: " · " }
        }
        Limit::Row(part, row) => {
            let first = part.judged.first().map(|r| &r.of.channel);
            let several = part.judged.iter().any(|r| Some(&r.of.channel) != first);
            let unit = words.unit(&row.of.unit);
            let name = row.name_in(several, words);
            let name = if unit.is_empty() { name } else { format!("{name}, {unit}") };
            Value::Sentence(name).noted(&part.anchor, row.footnotes.clone())
        }
    }
}

fn verdict(row: &Row<'_>, words: Translator) -> Value {
    Value::State(State { id: row.of.verdict.id().to_owned(), word: rows::verdict_word(row.of, words) })
}

/// Marks a line of the table as the heading of a phase, or with the name that signatures have for its row.
fn mark(line: &mut Line, limit: &Limit<'_>) {
    match limit {
        Limit::Phase(_) => line.is_heading = true,
        Limit::Row(_, row) => {
            row.of.id.clone_into(&mut line.id);
            row.of.channel.clone_into(&mut line.channel);
        }
    }
}

/// How the rows with a limit were obtained: each method with its quantities, in the order of the rows.
pub fn methods(part: &Part<'_>) -> Vec<Block> {
    let words = part.words;
    let mut all: Vec<(String, Vec<String>)> = vec![];
    for row in &part.judged {
        let (method, name) = (row.method(words), row.name(words));
        match all.iter_mut().find(|(known, _)| *known == method) {
            Some((_, names)) if names.contains(&name) => {}
            Some((_, names)) => names.push(name),
            None => all.push((method, vec![name])),
        }
    }
    if all.is_empty() {
        return vec![];
    }
    let rows = all.into_iter().map(|(method, names)| (method.into(), names.join("; ").into())).collect();
    let facts = Block::Facts(Facts { class: "options", rows });
    vec![Block::section("", words.t("report.judged_methods"), vec![facts])]
}
