//! Which test of a unit a result is, and what came of those before it.

use super::entry::{Entry, EntryRecording, EntryTest, Reason, ReasonKind};
use super::error::StoreError;
use super::index::{Attempt, Filter};
use super::opened::Store;
use super::reservation::Reservation;
use crate::estimate::Verdict;
use crate::i18n::{Arg, Note, note};
use crate::output::sha256_of_beginning;
use crate::record::{AttemptRecord, EarlierAttempt, Message, RunRecord};
use std::collections::BTreeSet;
use std::path::Path;

/// Earlier attempts that a sentence names.
const MAX_NAMED_ATTEMPTS: usize = 5;

/// Which attempt the test in a record is, and its number, which no other takes meanwhile. `None` where nothing tells the unit, or the
/// record is no test.
///
/// # Errors
/// What the index or the disk refuses.
pub fn attempt_of(
    store: &Store,
    record: &RunRecord,
) -> Result<Option<(AttemptRecord, Reservation)>, StoreError> {
    let bytes = serde_json::to_vec_pretty(record)
        .map_err(|e| StoreError::Database { path: store.layout.index(), reason: e.to_string() })?;
    let Ok(entry) = Entry::of_json(&bytes, Path::new("")) else { return Ok(None) };
    if entry.unit.key().is_empty() {
        return Ok(None);
    }
    let filter = Filter {
        serial_key: Some(entry.unit.key()),
        procedure: Some(entry.test.procedure.clone()),
        ..Filter::default()
    };
    let _turn = store.take_turn()?;
    let (unit, procedure) = (entry.unit.key(), &entry.test.procedure);
    let taken = store.highest_taken(&unit, procedure)?;
    let earlier = store.attempts(&filter)?;
    let before = earlier.iter().map(|a| a.number).max().unwrap_or(0).max(taken);
    let reservation = store.reserve(&unit, procedure, before + 1)?;
    let looked = record.interim.is_none().then(|| looked_before(&earlier, &entry)).flatten();
    Ok(Some((record_of(&earlier, reservation.number, &entry.test, looked), reservation)))
}

/// That an earlier attempt evaluated the beginning of the same growing recording.
fn looked_before(earlier: &[Attempt], entry: &Entry) -> Option<Note> {
    let [recording] = entry.recordings.as_slice() else { return None };
    let is_beginning = |before: &EntryRecording| {
        before.bytes > 0
            && before.bytes < recording.bytes
            && sha256_of_beginning(Path::new(&recording.path), before.bytes).as_ref() == Some(&before.sha256)
    };
    let looked =
        earlier.iter().rev().find(|a| matches!(a.entry.recordings.as_slice(), [one] if is_beginning(one)))?;
    Some(note!("interim.looked_before", number = looked.number))
}

/// The record of an attempt after others.
fn record_of(earlier: &[Attempt], number: u64, test: &EntryTest, looked: Option<Note>) -> AttemptRecord {
    AttemptRecord {
        number,
        earlier: earlier.iter().map(one).collect(),
        summary: summary(earlier, number, test).into_iter().chain(looked).map(Message::from).collect(),
    }
}

fn one(attempt: &Attempt) -> EarlierAttempt {
    let Attempt { address, entry, number, superseded, missing: _ } = attempt;
    EarlierAttempt {
        number: *number,
        result: address.clone(),
        evaluated_at: entry.test.evaluated_at.clone(),
        verdict: entry.verdict,
        reasons: entry.reasons.iter().map(|r| r.name.clone()).collect(),
        revision: entry.test.revision.clone(),
        limits_sha256: entry.test.limits_sha256.clone(),
        superseded: superseded.is_some(),
    }
}

fn summary(earlier: &[Attempt], number: u64, test: &EntryTest) -> Vec<Note> {
    if earlier.is_empty() {
        return vec![];
    }
    let shown = earlier.get(earlier.len().saturating_sub(MAX_NAMED_ATTEMPTS)..).unwrap_or_default();
    let list = shown.iter().map(|a| said(a).into()).collect();
    let mut notes = vec![note!("attempt.again", number, earlier = Arg::Several(list, "; ".into()))];
    let missing: BTreeSet<&String> = earlier.iter().flat_map(|a| &a.missing).collect();
    if !missing.is_empty() {
        notes.push(note!("attempt.missing", n = missing.len()));
    }
    let tests: Vec<(u64, &EntryTest)> =
        earlier.iter().map(|a| (a.number, &a.entry.test)).chain([(number, test)]).collect();
    for pair in tests.windows(2) {
        let [(from, before), (to, after)] = pair else { continue };
        let change = |key: &'static str| Note::new(key).with("from", *from).with("to", *to);
        if before.limits_sha256 != after.limits_sha256 {
            notes.push(change("attempt.limits_changed"));
        }
        if before.procedure_sha256 != after.procedure_sha256 {
            notes.push(change("attempt.procedure_changed"));
        }
    }
    notes
}

/// What came of an earlier attempt.
fn said(attempt: &Attempt) -> Note {
    let names: Vec<Arg> = attempt.entry.reasons.iter().map(name).collect();
    let key = match (attempt.superseded.is_some(), names.is_empty() || attempt.entry.verdict == Verdict::Pass)
    {
        (true, _) => "attempt.superseded",
        (false, true) => "attempt.plain",
        (false, false) => "attempt.failed_on",
    };
    Note::new(key)
        .with("number", attempt.number)
        .with("verdict", Arg::key("verdict", attempt.entry.verdict.id()))
        .with("names", Arg::Several(names, ", ".into()))
}

/// The name of a reason.
fn name(reason: &Reason) -> Arg {
    let table = match reason.kind {
        ReasonKind::Measurand => "measurand",
        ReasonKind::Condition => "condition",
        ReasonKind::Fault => "fault",
        ReasonKind::Error => return Arg::key("attempt", "not_tested"),
    };
    // The id of a condition goes on with the name of its channel.
    Arg::key(table, reason.name.split('.').next().unwrap_or(&reason.name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::i18n::{Lang, Localize};

    fn attempt(number: u64, verdict: &str, failed: &str, limits: &str) -> Attempt {
        let json = format!(
            r#"{{"format": "result/1", "unit_under_test": {{"serial": "1"}}, "verdict": "{verdict}",
            "procedure": {{"id": "p", "limits": {{"sha256": "{limits}"}}}},
            "measurands": [{{"id": "{failed}", "verdict": "{verdict}"}}]}}"#
        );
        let entry = Entry::of_json(json.as_bytes(), Path::new("")).unwrap();
        Attempt { address: number.to_string(), entry, number, superseded: None, missing: vec![] }
    }

    #[test]
    fn the_third_attempt_tells_of_the_two_before_and_of_other_limits() {
        let earlier =
            [attempt(1, "fail", "angle_random_walk", "a"), attempt(2, "indeterminate", "static_bias", "a")];
        let test = attempt(3, "pass", "static_bias", "b").entry.test;
        let record = record_of(&earlier, 3, &test, None);
        assert_eq!(record.number, 3);
        let said: Vec<String> = record.summary.iter().map(|m| m.say(Lang::En)).collect();
        assert!(said[0].contains('3') && said[0].contains("1: fail"), "{said:?}");
        assert!(said[0].contains("2: indeterminate"), "{said:?}");
        assert!(said[1].contains("between attempts 2 and 3"), "{said:?}");
        assert_eq!(said.len(), 2, "{said:?}");
    }

    #[test]
    fn a_first_attempt_says_nothing() {
        let record = record_of(&[], 1, &attempt(1, "pass", "static_bias", "a").entry.test, None);
        assert_eq!((record.number, record.earlier.len(), record.summary.len()), (1, 0, 0));
    }
}
