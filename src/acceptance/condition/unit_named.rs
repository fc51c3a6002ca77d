//! The serial number that the recording states against the one under which it is tested.

use super::facts::{Condition, Facts, record};
use crate::i18n::Note;
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
        match given {
            Some(_) => facts.checks.made("serial_number", None, "unit_named"),
            None => facts.checks.not_made("serial_number", None, "check_list.no_serial_given"),
        }
        let (status, key) = match given {
            Some(given) if plain(given) == plain(stated) => (ConditionStatus::Ok, "unit_named.same"),
            Some(_) => (ConditionStatus::Invalid, "unit_named.other"),
            None => (ConditionStatus::Remark, "unit_named.not_given"),
        };
        let note =
            Note::new(key).with("stated", format!("`{stated}`")).with("given", given.unwrap_or_default());
        let required = Note::new("unit_named.required").with("serial", given.unwrap_or("–"));
        vec![record("unit_named", status, &[], Some(required), note)]
    }
}

/// A serial number without what is written before it, and without punctuation, case and leading zeros: `S/N 0043` and
/// `sn-43` are one unit.
fn plain(serial: &str) -> String {
    let upper = serial.trim().to_uppercase();
    let bare = ["S/N", "SN", "№", "NO.", "ЗАВ."].iter().find_map(|p| upper.strip_prefix(p)).unwrap_or(&upper);
    let groups = bare.split(|c: char| !c.is_alphanumeric()).filter(|g| !g.is_empty());
    let without = |g: &str| {
        let rest = g.trim_start_matches('0');
        if rest.is_empty() { "0".to_owned() } else { rest.to_owned() }
    };
    groups.map(without).collect::<Vec<_>>().join("-")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_unit_written_in_several_ways_is_one() {
        for same in ["SN-0043", "sn-43", "S/N 0043", "0043", " 43 ", "№ 43"] {
            assert_eq!(plain(same), "43", "{same}");
        }
        for other in ["SN-0034", "430", "43-1", "A43", ""] {
            assert_ne!(plain(other), "43", "{other}");
        }
        assert_ne!(plain("0"), plain(""));
        assert_ne!(plain("4-3"), plain("43"));
    }
}
