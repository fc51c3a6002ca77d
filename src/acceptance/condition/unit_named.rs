//! The serial number that the recording states against the one under which it is tested.

use super::facts::{Condition, Facts, record};
use crate::i18n::{Note, note};
use crate::ingest::serial::plain;
use crate::record::{ConditionRecord, ConditionStatus};

pub(super) struct UnitNamed;

impl Condition for UnitNamed {
    fn judge(&self, facts: &Facts<'_>) -> Vec<ConditionRecord> {
        let given = facts.serial.map(str::trim).filter(|s| !s.is_empty());
        let named = || facts.stated_serials.iter().filter(|s| !plain(s).is_empty());
        // One foreign number is enough: a file of another unit among those of this one.
        let other = named().find(|s| given.is_none_or(|g| plain(g) != plain(s)));
        let Some(stated) = other.or_else(|| named().next()) else {
            facts.checks.not_made("serial_number", None, "check_list.no_serial_stated");
            return vec![];
        };
        match given.filter(|_| !facts.serial_of_recording) {
            Some(_) => facts.checks.made("serial_number", None, "unit_named"),
            None => facts.checks.not_made("serial_number", None, "check_list.no_serial_given"),
        }
        let (status, key) = match given {
            Some(_) if facts.serial_of_recording => (ConditionStatus::Remark, "unit_named.used"),
            Some(given) if plain(given) == plain(stated) => (ConditionStatus::Ok, "unit_named.same"),
            Some(_) => (ConditionStatus::Invalid, "unit_named.other"),
            None => (ConditionStatus::Remark, "unit_named.not_given"),
        };
        let note =
            Note::new(key).with("stated", format!("`{stated}`")).with("given", given.unwrap_or_default());
        let required = given
            .filter(|_| !facts.serial_of_recording)
            .map(|given| note!("unit_named.required", serial = given));
        vec![record("unit_named", status, &[], required, note)]
    }
}
