//! Faults of the recording against the budget of the procedure.

use super::facts::{Condition, Facts, record};
use crate::config::procedure::model::Allowance;
use crate::i18n::{Arg, Note, note};
use crate::record::{ConditionRecord, ConditionStatus};

pub(super) struct Faults;

impl Condition for Faults {
    fn judge(&self, facts: &Facts<'_>) -> Vec<ConditionRecord> {
        // The pass over the rows counted these on every channel that was read.
        for id in ["full_scale", "plausible"] {
            if facts.rows > 0 {
                facts.checks.made(id, None, "integrity");
            } else {
                facts.checks.not_made(id, None, "check_list.not_read");
            }
        }
        let found = facts.integrity;
        let budget = &facts.procedure.conditions.faults;
        let counted: [(&str, u64, Option<Allowance>); 10] = [
            ("gaps", found.gaps, budget.gaps),
            ("missing_samples", found.missing_samples, budget.missing_samples),
            ("duplicate_timestamps", found.duplicate_timestamps, budget.duplicate_timestamps),
            ("backward_timestamps", found.backward_timestamps, budget.backward_timestamps),
            ("non_finite", found.non_finite, budget.non_finite),
            ("unparsable", found.unparsable, budget.unparsable),
            ("outliers", found.outliers, budget.outliers),
            ("saturated", found.saturated, budget.saturated),
            ("stuck", found.stuck, budget.stuck),
            ("repeated", found.repeated, budget.repeated),
        ];
        // What no sensor shows and what is missing at the end cannot be allowed.
        let never = [("implausible", found.implausible), ("cut_off", found.cut_off)];
        let mut records: Vec<ConditionRecord> =
            never.into_iter().filter_map(|(id, count)| never_allowed(id, count, facts)).collect();
        records.extend(counted.into_iter().filter_map(|(id, count, allowance)| match allowance {
            Some(allowance) => Some(budgeted(id, count, allowance, facts)),
            None => unbudgeted(id, count, facts),
        }));
        records.extend(longest_gap(facts));
        records.extend(jitter(facts));
        records
    }
}

/// A fault of which not a single one is allowed; `None` where there is none.
fn never_allowed(id: &str, count: u64, facts: &Facts<'_>) -> Option<ConditionRecord> {
    let first = facts.integrity.faults.iter().find(|f| f.kind == id);
    let note = note!("plausible.condition", count);
    let note = match first {
        Some(first) => note.with("first", first.seen.clone()),
        None => note.with("first", ""),
    };
    let required = note!("note.required.at_most_count", count = 0u64);
    let observed = [("count", count as f64)];
    (count > 0).then(|| record(id, ConditionStatus::Invalid, &observed, Some(required), note))
}

/// A fault that the procedure allows a number of.
fn budgeted(id: &str, count: u64, allowance: Allowance, facts: &Facts<'_>) -> ConditionRecord {
    let (status, key) = if count == 0 && !facts.integrity.has_examined(id) {
        (ConditionStatus::Remark, "note.condition.fault_not_examined")
    } else if !allowance.allows(count, facts.rows) {
        (ConditionStatus::Invalid, "note.condition.fault_over")
    } else if count > 0 {
        (ConditionStatus::Remark, "note.condition.fault_within")
    } else {
        (ConditionStatus::Ok, "note.condition.fault_none")
    };
    let required = match allowance {
        Allowance::Count(most) => note!("note.required.at_most_count", count = most),
        Allowance::Share(most) => {
            note!("note.required.at_most_share", percent = Arg::Stated(most * 100.0))
        }
    };
    let share = share(count, facts);
    let observed = [("count", count as f64), ("share", share)];
    record(id, status, &observed, Some(required), note(key, id, count, share))
}

/// A remark on a fault that the procedure says nothing of; `None` where there is none.
fn unbudgeted(id: &str, count: u64, facts: &Facts<'_>) -> Option<ConditionRecord> {
    let share = share(count, facts);
    let observed = [("count", count as f64), ("share", share)];
    let note = note("note.condition.fault_unbudgeted", id, count, share);
    (count > 0).then(|| record(id, ConditionStatus::Remark, &observed, None, note))
}

fn longest_gap(facts: &Facts<'_>) -> Option<ConditionRecord> {
    let most_s = facts.procedure.conditions.faults.longest_gap_s?;
    let (status, key) = if facts.longest_gap_s <= most_s {
        (ConditionStatus::Ok, "note.condition.longest_gap_within")
    } else {
        (ConditionStatus::Invalid, "note.condition.longest_gap_over")
    };
    let note = Note::new(key).with("seconds", facts.longest_gap_s);
    let observed = [("seconds", facts.longest_gap_s)];
    let required = note!("note.required.at_most_seconds", seconds = Arg::Stated(most_s));
    Some(record("longest_gap", status, &observed, Some(required), note))
}

fn jitter(facts: &Facts<'_>) -> Option<ConditionRecord> {
    let most_s = facts.procedure.conditions.faults.timestamp_jitter_s?;
    let jitter_s = facts.integrity.timestamp_jitter_s?;
    let (status, key) = if jitter_s <= most_s {
        (ConditionStatus::Ok, "note.condition.jitter_within")
    } else {
        (ConditionStatus::Invalid, "note.condition.jitter_over")
    };
    let note = Note::new(key).with("seconds", jitter_s);
    let required = note!("note.required.at_most_rms", seconds = Arg::Stated(most_s));
    Some(record("timestamp_jitter", status, &[("seconds", jitter_s)], Some(required), note))
}

/// Share of the rows.
fn share(count: u64, facts: &Facts<'_>) -> f64 {
    count as f64 / facts.rows.max(1) as f64
}

fn note(key: &'static str, id: &str, count: u64, share: f64) -> Note {
    Note::new(key).with("kind", Arg::key("condition", id)).with("count", count).with("percent", share * 100.0)
}
