//! The sizes of effects that would have been noticed.

use super::print::capital;
use super::print::{parameter, title};
use crate::effect;
use crate::mismatch::finding::Explanation;
use crate::mismatch::noticeable_record::NoticeableSize;
use crate::report::number::{digits, limit_digits};
use crate::report::page::{Block, OnTerminal, Table, Value};
use crate::report::translator::Translator;
use std::collections::BTreeMap;

/// The columns of a page.
const ON_PAGE: [&str; 5] = ["effect", "size", "place", "worst", "rms"];

/// The columns of a terminal.
const ON_TERMINAL: [&str; 3] = ["effect", "noticed_from", "place"];

/// Most rows on a terminal.
const MAX_ON_TERMINAL: usize = 8;

/// The section of a page; `None` without sizes.
pub(super) fn section(all: &Explanation, words: Translator) -> Option<Block> {
    let hint = |key: &str| Block::Hint(words.t(key));
    let not_computed = Block::remarks(not_computed(all, words));
    let not_computed =
        not_computed.into_iter().flat_map(|list| [hint("explain.noticeable.not_computed"), list]);
    let sizes = [hint("explain.noticeable.hint"), Block::Table(table(all, words).only(&ON_PAGE))];
    let below = sizes.into_iter().chain(not_computed).collect();
    let is_shown = !all.noticeable.is_empty();
    is_shown.then(|| Block::section("", words.t("explain.noticeable.title"), below))
}

/// The first sizes on a terminal, and how many there are besides.
pub(super) fn on_terminal(all: &Explanation, words: Translator) -> Vec<Block> {
    let mut shown = table(all, words).only(&ON_TERMINAL);
    if shown.rows.is_empty() {
        return vec![];
    }
    shown.rows.truncate(MAX_ON_TERMINAL);
    let further = all.noticeable.len() - shown.rows.len();
    let sentence = || words.with("explain.noticeable.further", &[("n", &further.to_string())]);
    let further = (further > 0).then(|| Block::Paragraph(sentence()));
    let heading = Block::heading(words.t("explain.noticeable.terminal"));
    [heading, Block::Table(shown)].into_iter().chain(further).collect()
}

/// The sizes in their order; at its typical place for an effect that is searched.
fn table(all: &Explanation, words: Translator) -> Table {
    let each = || all.noticeable.iter();
    let name =
        |n: &NoticeableSize| Value::Named { text: capital(&title(&n.kind, words)), id: n.kind.clone() };
    let of_parameter = |n: &NoticeableSize| {
        Value::Sentence(format!("{}: {}", parameter(&n.parameter, words), size(n, n.size, words)))
    };
    let typical_place = |n: &NoticeableSize| {
        Value::Sentence(if n.worst.is_some() { place(&n.at, words) } else { String::new() })
    };
    let worst = |n: &NoticeableSize| Value::Sentence(worst(n, words));
    let rms = |n: &NoticeableSize| {
        let shown = n.rms_deg_h.map(|v| words.quantity(&digits(v, 2, words.lang), "deg/h"));
        shown.unwrap_or_default()
    };
    let short = |id: &str| words.name("terminal_column", id);
    Table::new("cards", all.noticeable.len())
        .column(words.column("explain.noticeable.effect").short(short("effect")), each().map(name))
        .column(words.column("explain.noticeable.size"), each().map(of_parameter))
        .column(words.number_column("terminal_column.noticed_from"), each().map(|n| size(n, n.size, words)))
        .column(
            words.column("explain.noticeable.place").short(short("place")).on_terminal(OnTerminal::Optional),
            each().map(typical_place),
        )
        .column(words.column("explain.noticeable.worst"), each().map(worst))
        .column(words.number_column("explain.noticeable.rms"), each().map(rms))
}

/// Size and place where an effect must be largest to be noticed; empty for one that is not searched.
fn worst(n: &NoticeableSize, words: Translator) -> String {
    let Some(worst) = &n.worst else { return String::new() };
    let (size, place) = (size(n, worst.size, words), place(&worst.at, words));
    if place.is_empty() {
        return size;
    }
    words.with("explain.noticeable.at", &[("size", &size), ("place", &place)])
}

/// A size with its unit, beyond what the claim states, below which or above which.
fn size(n: &NoticeableSize, value: f64, words: Translator) -> String {
    let whole = effect::parameter(&n.parameter).is_some_and(|p| p.whole);
    let shown = if whole { limit_digits(value.ceil(), 12, words.lang) } else { digits(value, 2, words.lang) };
    if let Some(claimed) = n.claimed.filter(|c| *c != 0.0) {
        let claimed = limit_digits(claimed, 6, words.lang);
        let sum = words.with("explain.noticeable.beyond", &[("claimed", &claimed), ("size", &shown)]);
        return words.quantity(&sum, &n.unit);
    }
    // A coefficient of a column without a role of its own has no unit that is known here.
    let unit = if n.unit.is_empty() && n.column.is_some() { "deg/h" } else { &n.unit };
    let shown = words.quantity(&shown, unit);
    match (&n.column, n.below) {
        (Some(column), _) => {
            words.with("explain.noticeable.per_unit", &[("size", &shown), ("column", column)])
        }
        (None, true) => words.with("explain.noticeable.below", &[("size", &shown)]),
        (None, false) => shown,
    }
}

/// Parameters of a place with their names.
fn place(at: &BTreeMap<String, f64>, words: Translator) -> String {
    let one = |(name, value): (&String, &f64)| {
        let known = effect::parameter(name);
        let unit = known.map_or("", |p| p.unit);
        let shown = if known.is_some_and(|p| p.whole || p.instant) {
            limit_digits(value.round(), 12, words.lang)
        } else {
            digits(*value, 2, words.lang)
        };
        let value = words.quantity(&shown, unit);
        words.with("explain.noticeable.parameter", &[("name", &parameter(name, words)), ("value", &value)])
    };
    at.iter().map(one).collect::<Vec<_>>().join(&words.t("number.list"))
}

/// Kinds without a size, each with the reason.
fn not_computed(all: &Explanation, words: Translator) -> Vec<String> {
    all.noticeable_not_computed
        .iter()
        .map(|n| {
            let reason = words.name("explain.noticeable", n.reason.id());
            format!("{} `{}`: {reason}", capital(&title(&n.kind, words)), n.kind)
        })
        .collect()
}
