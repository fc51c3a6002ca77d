//! Faults of the recording against the budget of the procedure.

use super::{Condition, Facts, record};
use crate::config::procedure::model::Allowance;
use crate::i18n::{Arg, Note};
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
        let budget = &facts.procedure.conditions.faults;
        let found = facts.integrity;
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
        let mut records = Vec::new();
        // What no sensor shows and what is missing at the end cannot be allowed.
        for (id, count, what) in
            [("implausible", found.implausible, "implausible"), ("cut_off", found.cut_off, "cut_off")]
        {
            let first = found.faults.iter().find(|f| f.kind == what).map(|f| f.message.clone());
            if count > 0 {
                let note = Note::new("plausible.condition").with("count", count);
                let note = match first {
                    Some(first) => note.with("first", first),
                    None => note.with("first", ""),
                };
                let required = Note::new("note.required.at_most_count").with("count", 0u64);
                let observed = [("count", count as f64)];
                records.push(record(id, ConditionStatus::Invalid, &observed, Some(required), note));
            }
        }
        for (id, count, allowance) in counted {
            let share = count as f64 / facts.rows.max(1) as f64;
            let Some(allowance) = allowance else {
                if count > 0 {
                    let note = note("note.condition.fault_unbudgeted", id, count, share);
                    records.push(record(
                        id,
                        ConditionStatus::Remark,
                        &[("count", count as f64), ("share", share)],
                        None,
                        note,
                    ));
                }
                continue;
            };
            let (status, key) = if count == 0 && !found.has_examined(id) {
                (ConditionStatus::Remark, "note.condition.fault_not_examined")
            } else if !allowance.allows(count, facts.rows) {
                (ConditionStatus::Invalid, "note.condition.fault_over")
            } else if count > 0 {
                (ConditionStatus::Remark, "note.condition.fault_within")
            } else {
                (ConditionStatus::Ok, "note.condition.fault_none")
            };
            let required = match allowance {
                Allowance::Count(most) => Note::new("note.required.at_most_count").with("count", most),
                Allowance::Share(most) => {
                    Note::new("note.required.at_most_share").with("percent", Arg::Stated(most * 100.0))
                }
            };
            let observed = [("count", count as f64), ("share", share)];
            records.push(record(id, status, &observed, Some(required), note(key, id, count, share)));
        }
        if let Some(most_s) = budget.longest_gap_s {
            let (status, key) = if facts.longest_gap_s <= most_s {
                (ConditionStatus::Ok, "note.condition.longest_gap_within")
            } else {
                (ConditionStatus::Invalid, "note.condition.longest_gap_over")
            };
            let note = Note::new(key).with("seconds", facts.longest_gap_s);
            let observed = [("seconds", facts.longest_gap_s)];
            let required = Note::new("note.required.at_most_seconds").with("seconds", Arg::Stated(most_s));
            records.push(record("longest_gap", status, &observed, Some(required), note));
        }
        if let (Some(most_s), Some(jitter_s)) = (budget.timestamp_jitter_s, found.timestamp_jitter_s) {
            let (status, key) = if jitter_s <= most_s {
                (ConditionStatus::Ok, "note.condition.jitter_within")
            } else {
                (ConditionStatus::Invalid, "note.condition.jitter_over")
            };
            let note = Note::new(key).with("seconds", jitter_s);
            let required = Note::new("note.required.at_most_rms").with("seconds", Arg::Stated(most_s));
            records.push(record("timestamp_jitter", status, &[("seconds", jitter_s)], Some(required), note));
        }
        records
    }
}

fn note(key: &'static str, id: &str, count: u64, share: f64) -> Note {
    Note::new(key).with("kind", Arg::key("condition", id)).with("count", count).with("percent", share * 100.0)
}
