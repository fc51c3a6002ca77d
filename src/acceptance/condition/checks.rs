//! Which checks were made. A check notes it itself where it runs; what a kind of test could check and nothing noted is
//! listed as not made.
//!
//! One more check: one line in [`ALL_CHECKS`], its name `check_name.<id>` in the tables, the kinds of test that could make it
//! (`checks` of each, or [`OF_EVERY_TEST`]), and a call of [`CheckLog::made`] or [`CheckLog::not_made`] where it runs.

use crate::i18n::{Note, note};
use crate::record::{CheckRecord, CheckStatus};
use std::sync::Mutex;

/// Every check, in the order of the report.
pub const ALL_CHECKS: &[&str] = &[
    "earth_rate",
    "earth_sign",
    "earth_in_positions",
    "table_response",
    "table_reached",
    "table_agreement",
    "column_units",
    "noise_level",
    "temperature_unit",
    "clock",
    "clock_by_turns",
    "warm_up",
    "temperature_in_step",
    "full_scale",
    "plausible",
    "distribution",
    "serial_number",
];

/// Checks that every kind of test could make from what it is given.
pub const OF_EVERY_TEST: &[&str] =
    &["column_units", "temperature_unit", "clock", "full_scale", "plausible", "serial_number"];

/// Log of the checks while a recording is judged.
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

    /// Every check of a kind of test in the order of [`ALL_CHECKS`]: as noted, or not made. What was made once on a channel
    /// was made. `own` are the checks that the kind of test adds to those of every test.
    pub fn records(&self, own: &[&str]) -> Vec<CheckRecord> {
        let told = self.0.lock().map(|list| list.clone()).unwrap_or_default();
        let mut all: Vec<CheckRecord> = Vec::new();
        for id in possible(own) {
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
                all.push(unmade(id, note!("check_list.no_part")));
            }
        }
        all
    }
}

/// The checks of a run that read nothing.
pub fn none_made(own: &[&str]) -> Vec<CheckRecord> {
    possible(own).map(|id| unmade(id, note!("check_list.not_read"))).collect()
}

fn possible(own: &[&str]) -> impl Iterator<Item = &'static str> {
    ALL_CHECKS.iter().copied().filter(move |id| OF_EVERY_TEST.contains(id) || own.contains(id))
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
        let all = log.records(&["earth_rate", "distribution"]);
        let of = |id: &str| all.iter().filter(|r| r.id == id).map(|r| r.status).collect::<Vec<_>>();
        assert_eq!(of("earth_rate"), [CheckStatus::Made, CheckStatus::NotMade]);
        assert_eq!(of("distribution"), [CheckStatus::NotMade]);
        assert!(of("table_response").is_empty());
        assert!(all.iter().all(|r| r.reason.is_some() != r.evidence.is_some()));
    }

    #[test]
    fn every_check_has_a_name() {
        for id in ALL_CHECKS {
            for lang in [Lang::En, Lang::Ru] {
                assert!(lookup(lang, &format!("check_name.{id}")).is_some(), "{id}");
            }
        }
    }
}
