//! The sizes of effects that would have been noticed.

use super::print::capital;
use super::print::{parameter, title};
use crate::effect;
use crate::mismatch::finding::Explanation;
use crate::mismatch::noticeable_record::NoticeableSize;
use crate::report::number::{digits, limit_digits};
use crate::report::translator::Translator;
use serde::Serialize;
use std::collections::BTreeMap;

/// The size from which one kind of effect would have been noticed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NoticeableRow {
    /// Title.
    pub title: String,
    /// Kind as the files have it.
    pub kind: String,
    /// Column that it would follow; empty for none.
    pub column: String,
    /// Parameter that says how large.
    pub parameter: String,
    /// The size; at the typical place of an effect that is searched.
    pub size: String,
    /// That place; empty for an effect that is not searched.
    pub at: String,
    /// Size and place where it must be largest.
    pub worst: String,
    /// What it adds to the rate, rms.
    pub rms: String,
}

/// A kind without a size.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NotComputedRow {
    /// Title.
    pub title: String,
    /// Kind as the files have it.
    pub kind: String,
    /// Why.
    pub reason: String,
}

/// Sizes in their order.
pub(super) fn sizes(all: &Explanation, words: Translator) -> Vec<NoticeableRow> {
    all.noticeable.iter().map(|n| row(n, words)).collect()
}

fn row(n: &NoticeableSize, words: Translator) -> NoticeableRow {
    let worst = n.worst.as_ref().map(|w| {
        let (size, place) = (size(n, w.size, words), place(&w.at, words));
        if place.is_empty() {
            return size;
        }
        words.with("explain.noticeable.at", &[("size", &size), ("place", &place)])
    });
    NoticeableRow {
        title: capital(&title(&n.kind, words)),
        kind: n.kind.clone(),
        column: n.column.clone().unwrap_or_default(),
        parameter: parameter(&n.parameter, words),
        size: size(n, n.size, words),
        at: if n.worst.is_some() { place(&n.at, words) } else { String::new() },
        worst: worst.unwrap_or_default(),
        rms: n.rms_deg_h.map(|v| words.quantity(&digits(v, 2, words.lang), "deg/h")).unwrap_or_default(),
    }
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

/// Kinds without a size.
pub(super) fn not_computed(all: &Explanation, words: Translator) -> Vec<NotComputedRow> {
    all.noticeable_not_computed
        .iter()
        .map(|n| NotComputedRow {
            title: capital(&title(&n.kind, words)),
            kind: n.kind.clone(),
            reason: words.name("explain.noticeable", n.reason.id()),
        })
        .collect()
}
