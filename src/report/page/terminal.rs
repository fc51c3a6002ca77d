//! Blocks as text for a terminal.

use super::block::{Block, Head};
use super::table::{OnTerminal, Table};
use super::value::Value;
use crate::i18n::visible;
use crate::report::terminal::Terminal;
use crate::report::terminal::table::{self, Cell};
use crate::report::terminal::verdict_style;

/// The blocks one below the other. Facts, figures, footnotes, methods and lines to be signed are for pages.
pub fn terminal(blocks: &[Block], terminal: Terminal) -> String {
    let mut out = String::new();
    let mut before = None;
    for block in blocks {
        out += &shown(block, before, terminal);
        before = Some(block);
    }
    out
}

fn shown(block: &Block, before: Option<&Block>, on: Terminal) -> String {
    match block {
        Block::Head(of) => head(of, on),
        Block::Lead(lead) => on.indented(&lead.sentences),
        Block::Heading(heading) => format!("\n{}\n", on.heading(&visible(&heading.text.plain()))),
        Block::Paragraph(text) => on.indented([text]),
        Block::Hint(text) => format!("\n{}", on.indented([text])),
        Block::Steps(steps) => {
            on.indented(steps.items.iter().zip(1..).map(|(step, n)| format!("{n}. {}", step.text)))
        }
        Block::Table(of) if matches!(before, None | Some(Block::Heading(_))) => grid(of, on),
        Block::Table(of) => format!("\n{}", grid(of, on)),
        Block::Reasons(of) => {
            let heading = on.heading(&visible(&of.heading));
            format!("\n{heading}\n{}", on.indented(&of.sentences))
        }
        Block::List(list) => format!("\n{}", on.indented(list.items.iter().map(|(text, _)| text))),
        Block::Section(_, below) | Block::Fold(_, below) => terminal(below, on),
        Block::Facts(_) | Block::Figure(_) | Block::Footnotes(_) | Block::Link(_) | Block::Method(_) => {
            String::new()
        }
        Block::SignOff | Block::PageEnd | Block::SummaryEnd => String::new(),
    }
}

fn head(head: &Head, on: Terminal) -> String {
    let counts = head.counts.iter().map(|(of, n)| format!("{} {n}", of.word));
    let counts = counts.collect::<Vec<_>>().join(", ");
    let title = visible(&head.title);
    let of = if head.size.is_empty() {
        title.into_owned()
    } else {
        let counts = if counts.is_empty() { counts } else { format!(" ({counts})") };
        format!("{title} · {}{counts}", head.size)
    };
    if !head.has_verdict() {
        return format!("{}\n", on.heading(&of));
    }
    let verdict = on.verdict(&head.verdict.word.to_uppercase(), &head.verdict.id);
    on.headed(&verdict, &head.verdict.word, &of)
}

/// A table in columns. Units stand at their numbers.
fn grid(of: &Table, on: Terminal) -> String {
    let of = of.with(|c| c.on_terminal != OnTerminal::Hidden);
    let is_bracketed = |i: usize| of.columns.get(i).is_some_and(|c| c.on_terminal == OnTerminal::Bracketed);
    let places: Vec<usize> = (0..of.columns.len()).filter(|i| !is_bracketed(*i)).collect();
    let columns: Vec<table::Column> = places
        .iter()
        .filter_map(|i| of.columns.get(*i))
        .map(|c| table::Column {
            head: c.short.as_ref().unwrap_or(&c.head).clone(),
            align: c.align,
            left_out: (c.on_terminal == OnTerminal::Optional).then_some(0),
        })
        .collect();
    let rows: Vec<Vec<Cell>> = of
        .rows
        .iter()
        .map(|row| {
            let cell = |i: &usize| {
                let mut cell = row.cells.get(*i).map(styled).unwrap_or_default();
                if is_bracketed(i + 1)
                    && let Some(more) = row.cells.get(i + 1)
                {
                    cell.text = format!("{} ({})", cell.text, more.plain());
                }
                cell
            };
            places.iter().map(cell).collect()
        })
        .collect();
    table::table(&columns, &rows, on)
}

fn styled(value: &Value) -> Cell {
    match value {
        Value::Detailed(detailed) => styled(&detailed.value),
        Value::State(state) => Cell { text: state.word.clone(), style: verdict_style(&state.id) },
        other => other.plain().into(),
    }
}
