//! Which checks were made. The checks tell it themselves where they run; what a kind of test could check and nobody told
//! of is listed as not made.
//!
//! One more check: one line in [`CHECKS`], its name `check_name.<id>` in the tables, and a call of [`CheckLog::made`] or
//! [`CheckLog::not_made`] where it runs.

use crate::config::procedure::Procedure;
use crate::i18n::Note;
use crate::record::{CheckRecord, CheckStatus};
use std::sync::Mutex;

/// A kind of test.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// At rest at constant conditions.
    Static,
    /// At rest over temperature.
    Temperature,
    /// From switching on.
    WarmUp,
    /// Steps of a rate table.
    RateTable,
    /// Positions and turns by known angles.
    Positions,
    /// Without and with an influence.
    Influence,
    /// Switching off and on.
    Repeatability,
}

impl Kind {
    /// The kind of test that a procedure describes.
    pub fn of(procedure: &Procedure) -> Kind {
        match &procedure.rate_table {
            Some(setup) if setup.known.is_empty() => Kind::RateTable,
            Some(_) => Kind::Positions,
            None if procedure.repeatability_test.is_some() => Kind::Repeatability,
            None if procedure.comparison_test.is_some() => Kind::Influence,
            None if procedure.temperature_test.is_some() => Kind::Temperature,
            None if procedure.warm_up_test.is_some() => Kind::WarmUp,
            None => Kind::Static,
        }
    }
}

use Kind::{Influence, Positions, RateTable, Repeatability, Static, Temperature, WarmUp};

const ALL: &[Kind] = &[Static, Temperature, WarmUp, RateTable, Positions, Influence, Repeatability];
const AT_REST: &[Kind] = &[Static, Temperature, WarmUp, Influence, Repeatability];

/// What each kind of test could check from what it is given.
#[rustfmt::skip]
const CHECKS: &[(&str, &[Kind])] = &[
    ("earth_rate", AT_REST),
    ("earth_sign", &[RateTable]),
    ("earth_in_positions", &[Positions]),
    ("table_response", &[RateTable]),
    ("table_reached", &[RateTable]),
    ("table_agreement", &[RateTable]),
    ("column_units", ALL),
    ("noise_level", AT_REST),
    ("temperature_unit", ALL),
    ("clock", ALL),
    ("clock_by_turns", &[RateTable]),
    ("warm_up", &[Static]),
    ("temperature_in_step", &[Influence]),
    ("full_scale", ALL),
    ("plausible", ALL),
    ("distribution", AT_REST),
    ("serial_number", ALL),
];

/// What checks tell of themselves while a recording is judged.
#[derive(Debug, Default)]
pub struct CheckLog(Mutex<Vec<CheckRecord>>);

impl CheckLog {
    /// A check was made; its finding stands in the condition `evidence`.
    pub fn made(&self, id: &str, channel: Option<&str>, evidence: &str) {
        self.add(id, channel, CheckStatus::Made, None, Some(evidence.to_owned()));
    }

    /// A check could not be made.
    pub fn not_made(&self, id: &str, channel: Option<&str>, reason: impl Into<Note>) {
        self.add(id, channel, CheckStatus::NotMade, Some(reason.into()), None);
    }

    fn add(
        &self,
        id: &str,
        channel: Option<&str>,
        status: CheckStatus,
        reason: Option<Note>,
        evidence: Option<String>,
    ) {
        let record = CheckRecord {
            id: id.to_owned(),
            channel: channel.map(str::to_owned),
            phase: None,
            status,
            reason: reason.map(Into::into),
            evidence,
        };
        if let Ok(mut list) = self.0.lock() {
            list.push(record);
        }
    }

    /// Every check of a kind of test in the order of the table: as told, or not made. What was made once on a channel
    /// was made.
    pub fn settle(&self, kind: Kind) -> Vec<CheckRecord> {
        let told = self.0.lock().map(|list| list.clone()).unwrap_or_default();
        let mut all: Vec<CheckRecord> = Vec::new();
        for id in known(kind) {
            let before = all.len();
            for record in told.iter().filter(|r| r.id == id) {
                match all.iter_mut().skip(before).find(|r| r.channel == record.channel) {
                    Some(same) if record.status < same.status => *same = record.clone(),
                    Some(_) => {}
                    None => all.push(record.clone()),
                }
            }
            // What one part of the test could not check, another may have.
            let made = all.iter().skip(before).any(|r| r.status == CheckStatus::Made);
            let mut own = all.split_off(before);
            own.retain(|r| !made || r.status == CheckStatus::Made || r.channel.is_some());
            all.append(&mut own);
            if all.len() == before {
                all.push(unmade(id, Note::new("check_list.no_part")));
            }
        }
        all
    }
}

/// The checks of a run that read nothing.
pub fn none_made(kind: Kind) -> Vec<CheckRecord> {
    known(kind).map(|id| unmade(id, Note::new("check_list.not_read"))).collect()
}

fn known(kind: Kind) -> impl Iterator<Item = &'static str> {
    CHECKS.iter().filter(move |(_, kinds)| kinds.contains(&kind)).map(|(id, _)| *id)
}

fn unmade(id: &str, reason: Note) -> CheckRecord {
    CheckRecord {
        id: id.to_owned(),
        channel: None,
        phase: None,
        status: CheckStatus::NotMade,
        reason: Some(reason.into()),
        evidence: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::i18n::{Lang, lookup};

    #[test]
    fn what_nobody_tells_of_is_not_made_and_what_was_made_once_was_made() {
        let log = CheckLog::default();
        log.not_made("earth_rate", Some("x"), "check_list.no_site");
        log.made("earth_rate", Some("x"), "earth_rate");
        log.not_made("earth_rate", Some("y"), "check_list.no_site");
        log.made("table_response", None, "table_response");
        let all = log.settle(Kind::Static);
        let of = |id: &str| all.iter().filter(|r| r.id == id).map(|r| r.status).collect::<Vec<_>>();
        assert_eq!(of("earth_rate"), [CheckStatus::Made, CheckStatus::NotMade]);
        assert_eq!(of("distribution"), [CheckStatus::NotMade]);
        assert!(of("table_response").is_empty());
        assert!(all.iter().all(|r| r.reason.is_some() != r.evidence.is_some()));
    }

    #[test]
    fn every_check_has_a_name_and_a_kind() {
        for (id, kinds) in CHECKS {
            assert!(!kinds.is_empty());
            for lang in [Lang::En, Lang::Ru] {
                assert!(lookup(lang, &format!("check_name.{id}")).is_some(), "{id}");
            }
        }
    }
}
