//! Usable time after warm-up, exclusions and gaps: not "last minus first stamp".

use super::facts::{Condition, Facts, record};
use crate::i18n::{Arg, Note, note};
use crate::record::{ConditionRecord, ConditionStatus};

pub(super) struct Duration;

impl Condition for Duration {
    fn judge(&self, facts: &Facts<'_>) -> Vec<ConditionRecord> {
        let Some(required_s) = facts.procedure.conditions.minimum_duration_s else { return vec![] };
        // Half a sample short is the rounding of a stamp, not a short test.
        let enough = facts.usable_s >= required_s - 0.5 * facts.sample_interval_s;
        let (status, key) = if facts.usable_s >= required_s {
            (ConditionStatus::Ok, "note.condition.duration_enough")
        } else if enough {
            (ConditionStatus::Ok, "note.condition.duration_rounded")
        } else {
            (ConditionStatus::Invalid, "note.condition.duration_short")
        };
        let note = Note::new(key)
            .with("usable_h", facts.usable_s / 3600.0)
            .with("usable", Arg::span(facts.usable_s))
            .with("required", Arg::span(required_s))
            .with("warm_up_min", facts.procedure.conditions.warm_up_s / 60.0);
        let observed = [("usable_h", facts.usable_s / 3600.0)];
        let required = note!("note.required.duration", length = Arg::span(required_s));
        vec![record("duration", status, &observed, Some(required), note)]
    }
}
