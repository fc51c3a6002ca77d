//! The tables of an explanation: tests, candidates, the fit before and after.

use super::print::capital;
use super::print::{chance, difference, ends, plain, test, title, view};
use crate::mismatch::finding::{ColumnRecord, Explanation, FitFigures, PlaceRecord};
use crate::report::number::digits;
use crate::report::page::Table;
use crate::report::translator::Translator;
use serde::Serialize;

/// A test of one view.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TestRow {
    /// In words.
    pub name: String,
    /// The view of the largest departure.
    pub view: String,
    /// Where in it.
    pub place: String,
    /// Probability with the claim.
    pub before: String,
    /// Probability with the augmented claim.
    pub after: String,
    /// Whether it departs, with the claim.
    pub departs_before: bool,
    /// The same with the augmented claim.
    pub departs_after: bool,
}

/// The tests, the most significant first.
pub(super) fn tests(all: &Explanation, words: Translator) -> Vec<TestRow> {
    let mut sorted: Vec<_> = all.tests.iter().collect();
    sorted.sort_by(|a, b| a.p_before.total_cmp(&b.p_before));
    sorted
        .into_iter()
        .map(|t| {
            let place = PlaceRecord { domain: t.domain, from: t.from, to: t.to };
            TestRow {
                name: test(&t.id, words),
                view: view(t.domain, words),
                place: ends(&place, words),
                before: chance(t.p_before, words),
                after: chance(t.p_after, words),
                departs_before: t.p_before < all.alpha,
                departs_after: t.p_after < all.alpha,
            }
        })
        .collect()
}

/// An effect that was tried.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CandidateRow {
    /// Title.
    pub title: String,
    /// Kind as the files have it.
    pub kind: String,
    /// What it is worth alone.
    pub delta_bic: String,
    /// Gain of log-likelihood.
    pub gain: String,
    /// Probability under its absence.
    pub p: String,
    /// `chosen`, `equivalent` or nothing, in words.
    pub role: String,
    /// Whether it was chosen.
    pub chosen: bool,
}

/// Candidates in their order, the largest ΔBIC first.
pub(super) fn candidates(all: &Explanation, words: Translator) -> Vec<CandidateRow> {
    all.candidates
        .iter()
        .map(|c| {
            let chosen = all.effects.iter().any(|f| f.effect_id() == c.kind);
            let equivalent = all.effects.iter().any(|f| f.equivalents.contains(&c.kind));
            let role = match (chosen, equivalent) {
                (true, _) => words.t("explain.role.chosen"),
                (_, true) => words.t("explain.role.equivalent"),
                _ => String::new(),
            };
            CandidateRow {
                title: capital(&title(&c.kind, words)),
                kind: c.kind.clone(),
                delta_bic: difference(c.delta_bic, words),
                gain: difference(c.log_likelihood_gain, words),
                p: chance(c.p_value, words),
                role,
                chosen,
            }
        })
        .collect()
}

/// What became of a recorded column.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ColumnRow {
    /// Its name in the file.
    pub name: String,
    /// What became of it, in words.
    pub status: String,
    /// Limit of what a silent one could add to the rate.
    pub limit: String,
}

/// The columns beside time and rate.
pub(super) fn columns(all: &Explanation, words: Translator) -> Vec<ColumnRow> {
    let row = |c: &ColumnRecord| ColumnRow {
        name: c.recorded_as.as_ref().unwrap_or(&c.name).clone(),
        status: match c.reason {
            Some(reason) => words.name("explain.columns", reason.id()),
            None => words.name("explain.columns", c.status.id()),
        },
        limit: c
            .at_most_deg_h
            .map(|v| words.quantity(&digits(v, 2, words.lang), "deg/h"))
            .unwrap_or_default(),
    };
    all.columns.iter().map(row).collect()
}

/// One figure of the fit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FitRow {
    /// What it is.
    pub name: String,
    /// With the claim.
    pub baseline: String,
    /// With the augmented claim.
    pub augmented: String,
    /// Augmented less baseline.
    pub change: String,
}

/// The fit before and after.
pub(super) fn fit(all: &Explanation, words: Translator) -> Vec<FitRow> {
    let (a, b) = (&all.fit.baseline, &all.fit.augmented);
    let row = |key: &str, of: fn(&FitFigures) -> f64| FitRow {
        name: words.t(key),
        baseline: plain(of(a), words),
        augmented: plain(of(b), words),
        change: difference(of(b) - of(a), words),
    };
    let rms = |v: f64| digits(v, 4, words.lang);
    let tau = crate::report::number::duration(all.fit.heldout_tau_s, words.lang);
    vec![
        row("explain.fit.log_likelihood", |f| f.log_likelihood),
        row("explain.fit.bic", |f| f.bic),
        row("explain.fit.heldout_log_likelihood", |f| f.heldout_log_likelihood),
        FitRow {
            name: words.with("explain.fit.heldout_rms", &[("tau", &tau)]),
            baseline: rms(a.heldout_rms_deg_h),
            augmented: rms(b.heldout_rms_deg_h),
            change: relative(a.heldout_rms_deg_h, b.heldout_rms_deg_h, words),
        },
        FitRow {
            name: words.t("explain.fit.family_p"),
            baseline: chance(all.family_p_value, words),
            augmented: chance(all.family_p_value_after, words),
            change: String::new(),
        },
    ]
}

/// The fit before and after as a table.
pub(in crate::report) fn fit_table(rows: &[FitRow], words: Translator) -> Table {
    let all = |of: fn(&FitRow) -> &String| rows.iter().map(move |r| of(r).as_str());
    Table::new("cards", rows.len())
        .column(words.column("explain.column.figure"), all(|r| &r.name))
        .column(words.number_column("explain.column.baseline"), all(|r| &r.baseline))
        .column(words.number_column("explain.column.augmented"), all(|r| &r.augmented))
        .column(words.number_column("explain.column.change"), all(|r| &r.change))
}

/// The change of a size in percent of what it was.
fn relative(before: f64, after: f64, words: Translator) -> String {
    let change = 100.0 * (after / before - 1.0);
    if change.is_finite() { format!("{}\u{202f}%", difference(change, words)) } else { String::new() }
}

/// Change of log-likelihood that is worth calling one.
const MIN_LOG_LIKELIHOOD_CHANGE: f64 = 0.5;

/// What adding the effects does to the fit, in a sentence.
pub(super) fn fit_summary(all: &Explanation, words: Translator) -> String {
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
