//! Bits of status words: failures are 0 and valid-data bits are 1 over the evaluated window.

use super::facts::{Condition, Facts, record};
use super::status_track::{StatusTrack, bits};
use crate::config::procedure::model::StatusCondition;
use crate::config::section::Allowance;
use crate::i18n::{Note, note};
use crate::record::{ConditionRecord, ConditionStatus};

pub(super) struct Status;

impl Condition for Status {
    fn judge(&self, facts: &Facts<'_>) -> Vec<ConditionRecord> {
        let conditions = facts.procedure.conditions.statuses.iter().enumerate();
        conditions.map(|(position, c)| judge(c, facts.statuses.get(position))).collect()
    }
}

fn judge(condition: &StatusCondition, track: Option<&StatusTrack>) -> ConditionRecord {
    let id = format!("status.{}", condition.channel);
    let required = note!(
        "note.required.status",
        failure = bits(condition.failure_mask as u64),
        valid = bits(condition.valid_mask as u64)
    );
    let Some(track) = track.filter(|t| t.samples > 0) else {
        let note = note!("note.condition.no_data", channel = condition.channel.as_str());
        return record(id, ConditionStatus::Invalid, &[], Some(required), note);
    };
    let allowed = condition.allowed.unwrap_or(Allowance::Count(0)).allows(track.bad, track.samples);
    let (status, key) = match (track.bad, allowed) {
        (0, _) => (ConditionStatus::Ok, "note.condition.status_held"),
        (_, true) => (ConditionStatus::Remark, "note.condition.status_within"),
        (_, false) => (ConditionStatus::Invalid, "note.condition.status_over"),
    };
    let note = Note::new(key)
        .with("count", track.bad)
        .with("samples", track.samples)
        .with("time_s", track.first_s.unwrap_or(0.0))
        .with("bits", bits(track.wrong_bits));
    let observed = [("count", track.bad as f64), ("share", track.bad as f64 / track.samples as f64)];
    record(id, status, &observed, Some(required), note)
}
