//! What can be counted: results, yields, reasons, verdicts by month.

use super::selection::{Selection, Tested};
use crate::lot::share::Share;
use crate::record::{HistoryCounts, HistoryMonth, HistoryReason, HistoryShare, HistoryYield};
use crate::store::Reason;
use std::collections::{BTreeMap, BTreeSet};

pub(super) fn counts(selection: &Selection<'_>) -> HistoryCounts {
    let keys = |reference: bool| -> BTreeSet<String> {
        let of = selection.all().filter(|t| t.is_reference() == reference);
        of.map(|t| t.attempt.entry.unit.key()).filter(|k| !k.is_empty()).collect()
    };
    let count = |of: &dyn Fn(&Tested<'_>) -> bool| selection.all().filter(|t| of(t)).count();
    HistoryCounts {
        results: selection.all().count(),
        units: keys(false).len(),
        reference_units: keys(true).len(),
        of_reference_units: count(&|t| t.is_reference()),
        superseded: count(&|t| t.attempt.superseded.is_some()),
        not_done: count(&|t| !t.is_done && t.attempt.superseded.is_none()),
        incomplete: selection.incomplete().len(),
        without_serial: count(&|t| !t.is_reference() && t.attempt.entry.unit.serial.is_empty()),
    }
}

fn share(count: usize, of: usize) -> Option<HistoryShare> {
    Share::of(count, of).map(Into::into)
}

/// First-pass and last-pass yield of every procedure, over the units of which no attempt is missing.
pub(super) fn yields(selection: &Selection<'_>) -> Vec<HistoryYield> {
    let incomplete = selection.incomplete();
    let (mut first, mut last) = (selection.first_of_each(), selection.last_of_each());
    for tests in [&mut first, &mut last] {
        tests.retain(|t| !incomplete.contains(&t.test()));
    }
    let procedures: BTreeSet<&str> = first.iter().map(|t| t.attempt.entry.test.procedure.as_str()).collect();
    let of = |tests: &[Tested<'_>], procedure: &str| {
        let own = || tests.iter().filter(|t| t.attempt.entry.test.procedure == procedure);
        share(own().filter(|t| t.passes()).count(), own().count())
    };
    let each = |procedure: &str| {
        Some(HistoryYield {
            procedure: procedure.to_owned(),
            first_pass: of(&first, procedure)?,
            last_pass: of(&last, procedure)?,
        })
    };
    procedures.into_iter().filter_map(each).collect()
}

/// Reasons that kept products from passing, the most frequent first. Tests that were not done as required are among them.
pub(super) fn reasons(selection: &Selection<'_>) -> Vec<HistoryReason> {
    let mut counts: BTreeMap<&Reason, usize> = BTreeMap::new();
    let results: Vec<Tested<'_>> =
        selection.all().filter(|t| !t.is_reference() && t.attempt.superseded.is_none()).collect();
    for reason in results.iter().flat_map(|t| &t.attempt.entry.reasons) {
        *counts.entry(reason).or_default() += 1;
    }
    let total: usize = counts.values().sum();
    let mut sorted: Vec<(&Reason, usize)> = counts.into_iter().collect();
    sorted.sort_by_key(|(reason, n)| (std::cmp::Reverse(*n), *reason));
    let mut until = 0;
    sorted
        .into_iter()
        .map(|(reason, results)| {
            until += results;
            HistoryReason {
                kind: reason.kind.id().to_owned(),
                name: reason.name.clone(),
                results,
                cumulative: until as f64 / total as f64,
            }
        })
        .collect()
}

/// The verdicts of products by month; results that do not say when are left out.
pub(super) fn months(selection: &Selection<'_>) -> Vec<HistoryMonth> {
    let mut months: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    for t in selection.products() {
        let Some(month) = t.attempt.entry.test.evaluated_at.get(..7) else { continue };
        let (tests, passed) = months.entry(month).or_default();
        *tests += 1;
        *passed += usize::from(t.passes());
    }
    let month = |(month, (tests, passed)): (&str, (usize, usize))| HistoryMonth {
        month: month.to_owned(),
        tests,
        passed,
    };
    months.into_iter().map(month).collect()
}
