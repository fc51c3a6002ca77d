//! Calibration of the instruments on the day of the test.

use super::facts::{Condition, Facts, record};
use crate::i18n::{Note, note};
use crate::record::{ConditionRecord, ConditionStatus};

pub(super) struct Instruments;

impl Condition for Instruments {
    fn judge(&self, facts: &Facts<'_>) -> Vec<ConditionRecord> {
        let instruments = &facts.procedure.instruments;
        instruments
            .iter()
            .map(|instrument| {
                let status = instrument.record_on(facts.today).status;
                let key = match (status, instrument.calibration_due) {
                    (ConditionStatus::Ok, _) => "note.condition.calibration_valid",
                    (_, Some(due)) if facts.today <= due => "note.condition.calibration_unidentified",
                    (_, Some(_)) => "note.condition.calibration_overdue",
                    (_, None) => "note.condition.calibration_unknown",
                };
                let due = instrument.calibration_due.map(|d| d.to_string()).unwrap_or_default();
                let note = Note::new(key).with("instrument", instrument.name.clone()).with("due", due);
                let required = note!("note.required.calibration", date = facts.today.to_string());
                record("calibration", status, &[], Some(required), note)
            })
            .collect()
    }
}
