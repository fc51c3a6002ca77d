//! Whether the warm-up left out was long enough.

use super::facts::{Condition, Facts, record};
use crate::i18n::{Arg, Note, note};
use crate::record::{ConditionRecord, ConditionStatus};

pub(super) struct WarmUp;

/// Standard deviations from which a transient counts as seen.
const MIN_SIGNIFICANCE: f64 = 4.0;

impl Condition for WarmUp {
    fn judge(&self, facts: &Facts<'_>) -> Vec<ConditionRecord> {
        let warm_up_s = facts.procedure.conditions.warm_up_s;
        let mut records = Vec::new();
        if facts.warm_up.is_empty() {
            facts.checks.not_made("warm_up", None, "check_list.short");
        }
        for fact in facts.warm_up {
            facts.checks.made("warm_up", Some(&fact.channel), "warm_up");
            // A transient matters when it moves the mean by more than a third of the uncertainty of the mean.
            let shift = fact.residual_deg_h * fact.time_constant_s / facts.usable_s.max(fact.time_constant_s);
            let matters = shift.abs() > fact.bias_uncertainty_deg_h / 3.0;
            let seen = fact.significance > MIN_SIGNIFICANCE && matters;
            let (status, key) = if seen {
                (ConditionStatus::Remark, "note.condition.warm_up_short")
            } else {
                (ConditionStatus::Ok, "note.condition.warm_up_enough")
            };
            let note = Note::new(key)
                .with("channel", fact.channel.clone())
                .with("residual", fact.residual_deg_h)
                .with("time_constant_min", fact.time_constant_s / 60.0)
                .with("warm_up_min", warm_up_s / 60.0);
            let mut observed = vec![("left_out_s", warm_up_s)];
            if seen {
                observed.push(("residual_deg_h", fact.residual_deg_h));
                observed.push(("time_constant_s", fact.time_constant_s));
            }
            let required = note!("note.required.warm_up", minutes = Arg::Stated(warm_up_s / 60.0));
            records.push(record("warm_up", status, &observed, Some(required), note));
        }
        records
    }
}
