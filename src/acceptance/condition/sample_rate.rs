//! The measured sample rate against the declared one.

use super::facts::{Condition, Facts, record};
use crate::i18n::{Arg, Note, note};
use crate::record::{ConditionRecord, ConditionStatus};

pub(super) struct SampleRate;

impl Condition for SampleRate {
    fn judge(&self, facts: &Facts<'_>) -> Vec<ConditionRecord> {
        let mut records: Vec<ConditionRecord> = facts
            .clock_notes
            .iter()
            .map(|note| record("time_base", ConditionStatus::Remark, &[], None, note.clone()))
            .collect();
        let Some(declared_hz) = facts.procedure.sample_rate_hz else { return records };
        let tolerance = facts.procedure.sample_rate_tolerance;
        let required = note!(
            "note.required.sample_rate",
            hz = Arg::Stated(declared_hz),
            percent = Arg::Stated(tolerance * 100.0)
        );
        if !facts.has_stamps {
            let note = note!("note.condition.rate_unmeasured", declared_hz);
            records.push(record("sample_rate", ConditionStatus::Remark, &[], Some(required), note));
            return records;
        }
        let measured_hz = 1.0 / facts.sample_interval_s;
        let difference = measured_hz / declared_hz - 1.0;
        let (status, key) = if difference.abs() <= tolerance {
            (ConditionStatus::Ok, "note.condition.rate_right")
        } else {
            (ConditionStatus::Invalid, "note.condition.rate_wrong")
        };
        let note = Note::new(key)
            .with("measured_hz", measured_hz)
            .with("declared_hz", declared_hz)
            .with("percent", difference * 100.0);
        let observed = [("measured_hz", measured_hz), ("difference", difference)];
        records.push(record("sample_rate", status, &observed, Some(required), note));
        records
    }
}
