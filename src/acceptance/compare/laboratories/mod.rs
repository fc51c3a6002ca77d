//! Two results of one unit: whether they agree within their uncertainties, row by row, and why where they do not.
//!
//! A result is a recording under a procedure. With both recordings and both procedures there are four results; two of them share
//! a procedure and two a recording, so that what the procedures make of the difference and what the recordings make of it
//! are told apart. One recording under two practices, such as the Russian and the Allan figures of a unit, is the case
//! without a difference of recordings.

mod agreement;
mod given;
mod reasons;

pub use agreement::{Agreement, Score, score};
pub use given::{Evaluated, Given, Side};
pub use reasons::{PairedRow, Reason, ReasonKind};

use crate::i18n::{Arg, Note, note};
use crate::record::{MeasurandRecord, RunRecord};
use agreement::Common;
use given::same_row;
use serde::{Deserialize, Serialize};

/// Names that a sentence lists.
const MAX_NAMES: usize = 8;
/// Share of rows that differ by chance where nothing differs: that of the intervals.
const CHANCE_OF_DIFFERENCE: f64 = 0.05;

/// Two results of one unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Laboratories {
    /// Serial number of the unit.
    pub serial: String,
    /// The results, in the order given.
    pub sides: [Side; 2],
    /// True where both come from one recording: their errors are the same, so that E_n says nothing.
    pub same_recording: bool,
    /// The rows that both have and of which one at least tells something.
    pub rows: Vec<PairedRow>,
    /// Keys of the two procedures that differ; empty where the procedures are not known.
    pub differing_keys: Vec<String>,
    /// The findings in sentences.
    #[serde(with = "crate::record::message::notes", rename = "says")]
    pub summary: Vec<Note>,
    /// What could not be compared or evaluated, and why.
    #[serde(with = "crate::record::message::notes")]
    pub missing: Vec<Note>,
}

impl Laboratories {
    /// The comparison of two results of one unit with what was evaluated for it; `None` where they name no unit, or two.
    pub fn of(given: [Given<'_>; 2], evaluated: Evaluated) -> Option<Laboratories> {
        let [first, second] = &given;
        let serial = serial_of_both(first.record, second.record)?.to_owned();
        let sides = [Side::of(first), Side::of(second)];
        // A recording in memory has no hash.
        let known = |side: &Side| {
            !side.recording_sha256.is_empty() && side.recording_sha256.iter().all(|hash| !hash.is_empty())
        };
        let same_recording = known(&sides[0]) && sides[0].recording_sha256 == sides[1].recording_sha256;
        let common = Common::of(first, second);
        let pair = |a: &MeasurandRecord| {
            let b = second.record.measurands.iter().find(|b| same_row(a, b))?;
            (tells(a) || tells(b)).then(|| (a.clone(), b.clone()))
        };
        let pairs: Vec<(MeasurandRecord, MeasurandRecord)> =
            first.record.measurands.iter().filter_map(pair).collect();
        let case = reasons::Case {
            sides: &sides,
            same_recording,
            common: &common,
            evaluated: &evaluated,
            given: &given,
        };
        let rows: Vec<PairedRow> = pairs.into_iter().map(|(a, b)| case.row(a, b)).collect();
        let summary = summary(&rows, same_recording);
        let mut missing = evaluated.missing;
        missing.extend(alone(first, second));
        missing.extend(alone(second, first));
        let differing_keys = evaluated.differing_keys;
        Some(Laboratories { serial, sides, same_recording, rows, differing_keys, summary, missing })
    }
}

/// The serial number of two results of one unit, by the rule of serial numbers: as it is written.
pub fn serial_of_both<'a>(first: &'a RunRecord, second: &RunRecord) -> Option<&'a str> {
    let of = |r: &'a RunRecord| r.unit_under_test.serial.as_deref().map(str::trim).filter(|s| !s.is_empty());
    let serial = of(first)?;
    let other = second.unit_under_test.serial.as_deref().map(str::trim);
    (other == Some(serial)).then_some(serial)
}

/// True for a row with a value or a bound.
fn tells(row: &MeasurandRecord) -> bool {
    row.value.is_some() || row.upper_limit.is_some() || row.lower_limit.is_some()
}

/// The rows of a result that the other lacks.
fn alone(one: &Given<'_>, other: &Given<'_>) -> Option<Note> {
    let lacks = |a: &&MeasurandRecord| tells(a) && !other.record.measurands.iter().any(|b| same_row(a, b));
    let mut ids: Vec<&str> = one.record.measurands.iter().filter(lacks).map(|r| r.id.as_str()).collect();
    ids.dedup();
    let more = ids.len().saturating_sub(MAX_NAMES);
    let names = ids.iter().take(MAX_NAMES).map(|id| Arg::key("measurand", id)).collect();
    let note = note!("laboratories.alone", name = one.name, names = Arg::Several(names, ", ".into()));
    let note = if more == 0 { note } else { note!("laboratories.and_more", what = note, more) };
    (!ids.is_empty()).then_some(note)
}

/// How many rows agree, and how many would differ by chance.
fn summary(rows: &[PairedRow], same_recording: bool) -> Vec<Note> {
    if rows.is_empty() {
        return vec![note!("laboratories.no_row")];
    }
    let count = |agreement| rows.iter().filter(|r| r.agreement == agreement).count();
    let (agree, differ) = (count(Agreement::Agrees), count(Agreement::Differs));
    let open = count(Agreement::Undecided);
    if same_recording {
        return vec![note!("laboratories.one_recording", n = rows.len(), differ)];
    }
    let chance = Arg::rounded(CHANCE_OF_DIFFERENCE * (agree + differ) as f64, 2);
    let mut said = vec![note!("laboratories.counts", n = rows.len(), agree, differ, open, chance)];
    let kinds = ReasonKind::ALL.into_iter().filter_map(|kind| {
        let of = |r: &&PairedRow| r.reasons.iter().any(|reason| reason.kind == kind && reason.shown);
        let rows: Vec<Arg> =
            rows.iter().filter(of).map(|r| Arg::key("measurand", &r.first.id)).take(MAX_NAMES).collect();
        let name = Arg::key("laboratories.kind", kind.id());
        (!rows.is_empty())
            .then(|| note!("laboratories.because", name, rows = Arg::Several(rows, ", ".into())))
    });
    said.extend(kinds);
    said
}
