//! The tables of an explanation: tests, candidates, recorded columns, the fit before and after.

use super::print::{capital, chance, difference, ends, plain, test, title, view};
use crate::mismatch::finding::{Candidate, ColumnRecord, Explanation, FitFigures, PlaceRecord};
use crate::report::number::{digits, duration};
use crate::report::page::{Joined, Table, Value};
use crate::report::translator::Translator;

/// Tests of the residual, the most significant first, and in the last row all of them together.
pub(super) fn tests(all: &Explanation, words: Translator) -> Table {
    let mut sorted: Vec<_> = all.tests.iter().collect();
    sorted.sort_by(|a, b| a.p_before.total_cmp(&b.p_before));
    let departs = words.t("explain.column.departs");
    let probability = |p: f64| {
        let shown = Value::Text(chance(p, words));
        if p < all.alpha { shown.strong().detail(Joined::Remark, departs.as_str()) } else { shown }
    };
    let together = |text: String| std::iter::once(Value::Text(text).strong());
    let places = sorted.iter().map(|t| {
        let place = PlaceRecord { domain: t.domain, from: t.from, to: t.to };
        Value::Sentence(ends(&place, words))
    });
    let alpha = Value::Text(format!("α = {}", digits(all.alpha, 1, words.lang)));
    Table::new("cards", sorted.len() + 1)
        .column(
            words.column("explain.test.title"),
            sorted
                .iter()
                .map(|t| Value::Text(test(&t.id, words)))
                .chain(together(words.t("explain.test.family"))),
        )
        .column(words.column("explain.column.view"), sorted.iter().map(|t| view(t.domain, words)))
        .column(words.number_column("explain.column.place"), places.chain([alpha]))
        .column(
            words.number_column("explain.column.before"),
            sorted.iter().map(|t| probability(t.p_before)).chain(together(chance(all.family_p_value, words))),
        )
        .column(
            words.number_column("explain.column.after"),
            sorted
                .iter()
                .map(|t| probability(t.p_after))
                .chain(together(chance(all.family_p_value_after, words))),
        )
}

/// Effects that were tried, the largest ΔBIC first.
pub(super) fn candidates(all: &Explanation, words: Translator) -> Table {
    let is_chosen = |c: &Candidate| all.effects.iter().any(|f| f.effect_id() == c.kind);
    let role = |c: &Candidate| {
        if is_chosen(c) {
            words.t("explain.role.chosen")
        } else if all.effects.iter().any(|f| f.equivalents.contains(&c.kind)) {
            words.t("explain.role.equivalent")
        } else {
            String::new()
        }
    };
    let each = || all.candidates.iter();
    let name = |c: &Candidate| Value::Named { text: capital(&title(&c.kind, words)), id: c.kind.clone() };
    let number = |key: &str| words.number_column(key);
    let mut table = Table::new("cards", all.candidates.len())
        .column(words.column("explain.column.candidate"), each().map(name))
        .column(number("explain.column.delta_bic"), each().map(|c| difference(c.delta_bic, words)))
        .column(number("explain.column.gain"), each().map(|c| difference(c.log_likelihood_gain, words)))
        .column(number("explain.column.p"), each().map(|c| chance(c.p_value, words)))
        .column(words.column("explain.column.role"), each().map(role));
    for (row, candidate) in table.rows.iter_mut().zip(&all.candidates) {
        row.chosen = is_chosen(candidate);
    }
    table
}

/// Recorded columns beside time and rate: the part that each was given, and the limit of what a silent one could add.
pub(super) fn columns(all: &Explanation, words: Translator) -> Table {
    let name = |c: &ColumnRecord| Value::Code(c.recorded_as.as_ref().unwrap_or(&c.name).clone());
    let part = |c: &ColumnRecord| {
        let id = c.reason.map_or_else(|| c.status.id(), |reason| reason.id());
        words.name("explain.columns", id)
    };
    let limit = |c: &ColumnRecord| {
        let shown = c.at_most_deg_h.map(|v| words.quantity(&digits(v, 2, words.lang), "deg/h"));
        shown.unwrap_or_default()
    };
    Table::new("compact", all.columns.len())
        .column(words.column("explain.columns.column"), all.columns.iter().map(name))
        .column(words.column("explain.columns.part"), all.columns.iter().map(part))
        .column(words.number_column("explain.columns.limit"), all.columns.iter().map(limit))
}

/// The fit before and after. `class`: classes in HTML.
pub(in crate::report) fn fit(class: &'static str, all: &Explanation, words: Translator) -> Table {
    let (a, b) = (&all.fit.baseline, &all.fit.augmented);
    let row = |key: &str, of: fn(&FitFigures) -> f64| {
        let change = difference(of(b) - of(a), words);
        [words.t(key), plain(of(a), words), plain(of(b), words), change]
    };
    let rms = |v: f64| digits(v, 4, words.lang);
    let tau = duration(all.fit.heldout_tau_s, words.lang);
    let rows = [
        row("explain.fit.log_likelihood", |f| f.log_likelihood),
        row("explain.fit.bic", |f| f.bic),
        row("explain.fit.heldout_log_likelihood", |f| f.heldout_log_likelihood),
        [
            words.with("explain.fit.heldout_rms", &[("tau", &tau)]),
            rms(a.heldout_rms_deg_h),
            rms(b.heldout_rms_deg_h),
            relative(a.heldout_rms_deg_h, b.heldout_rms_deg_h, words),
        ],
        [
            words.t("explain.fit.family_p"),
            chance(all.family_p_value, words),
            chance(all.family_p_value_after, words),
            String::new(),
        ],
    ];
    let columns = [
        words.column("explain.column.figure"),
        words.number_column("explain.column.baseline"),
        words.number_column("explain.column.augmented"),
        words.number_column("explain.column.change"),
    ];
    let cells = |i: usize| rows.iter().filter_map(move |row| row.get(i).cloned());
    let all = columns.into_iter().enumerate();
    all.fold(Table::new(class, rows.len()), |table, (i, column)| table.column(column, cells(i)))
}

/// The change of a size in percent of what it was.
fn relative(before: f64, after: f64, words: Translator) -> String {
    let change = 100.0 * (after / before - 1.0);
    if change.is_finite() { format!("{}\u{202f}%", difference(change, words)) } else { String::new() }
}

/// Smallest held-out gain of log-likelihood that is called a gain.
const MIN_LOG_LIKELIHOOD_CHANGE: f64 = 0.5;

/// What adding the effects does to the fit, in a sentence.
pub(in crate::report) fn fit_summary(all: &Explanation, words: Translator) -> String {
    if all.effects.iter().all(|f| f.is_unnamed()) {
        return words.t("explain.fit.unchanged");
    }
    let gain = all.fit.augmented.heldout_log_likelihood - all.fit.baseline.heldout_log_likelihood;
    let shown = difference(gain, words);
    if !gain.is_finite() {
        String::new()
    } else if gain.abs() < MIN_LOG_LIKELIHOOD_CHANGE {
        words.with("explain.fit.heldout_same", &[("gain", &shown)])
    } else if gain > 0.0 {
        words.with("explain.fit.heldout_gains", &[("gain", &shown)])
    } else {
        words.with("explain.fit.heldout_does_not", &[("gain", &shown)])
    }
}
