//! Entry of a result in the index.
//!
//! It is read from `result.json` alone, with as few demands as a data sheet makes, so that results of other programs and of
//! earlier versions have their place too.

use super::address::sha256;
use super::error::StoreError;
use crate::estimate::Verdict;
use crate::i18n::LocalText;
use crate::ingest::serial;
use crate::record::read::{self, ReadError};
use crate::record::{ConditionStatus, MeasurandRecord, RunKind, RunRecord};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Members of a result that the index reads.
const INDEXED_MEMBERS: &[&str] = &[
    "kind",
    "procedure.id",
    "procedure.revision",
    "procedure.sha256",
    "procedure.limits.id",
    "procedure.limits.revision",
    "procedure.limits.sha256",
    "unit_under_test.serial",
    "unit_under_test.family",
    "unit_under_test.model",
    "unit_under_test.lot",
    "unit_under_test.build_date",
    "unit_under_test.reference",
    "unit_under_test.attributes",
    "session.operator",
    "session.station",
    "session.evaluated_at",
    "verdict",
    "attempt.number",
    "attempt.earlier.result",
    "measurands.id",
    "measurands.channel",
    "measurands.phase",
    "measurands.unit",
    "measurands.value",
    "measurands.interval",
    "measurands.upper_limit",
    "measurands.limit.min",
    "measurands.limit.max",
    "measurands.verdict",
    "conditions.id",
    "conditions.status",
    "integrity.faults.kind",
    "recording.path",
    "recording.sha256",
    "recording.bytes",
    "errors.id",
];

/// Entry of a result in the index.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Unit.
    pub unit: EntryUnit,
    /// Procedure, limits, station, operator and moment.
    pub test: EntryTest,
    /// Verdict of the whole.
    pub verdict: Verdict,
    /// SHA-256 of `result.json`.
    pub result_sha256: String,
    /// Rows in the order of the result: of each the members that the index has.
    pub measurands: Vec<MeasurandRecord>,
    /// What kept the unit from passing.
    pub reasons: Vec<Reason>,
    /// The files that were evaluated.
    pub recordings: Vec<EntryRecording>,
}

/// The unit of a result. What is not stated is empty.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct EntryUnit {
    /// Serial number as stated.
    pub serial: String,
    /// Model, or else the family.
    pub model: String,
    /// Lot.
    pub lot: String,
    /// Build date, ISO 8601.
    pub build_date: Option<String>,
    /// True for a reference unit, which is tested to watch the bench.
    pub reference: bool,
    /// Free attributes.
    pub attributes: BTreeMap<String, String>,
}

impl EntryUnit {
    /// The serial number in the form used for comparison; empty if there is none.
    pub fn key(&self) -> String {
        if self.serial.is_empty() { String::new() } else { serial::plain(&self.serial) }
    }
}

/// The test of a result. What is not stated is empty.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct EntryTest {
    /// Id of the procedure.
    pub procedure: String,
    /// Its revision.
    pub revision: String,
    /// SHA-256 of its file.
    pub procedure_sha256: String,
    /// Id of the limits with their revision.
    pub limits: String,
    /// SHA-256 of the limits file.
    pub limits_sha256: String,
    /// Station.
    pub station: String,
    /// Operator.
    pub operator: String,
    /// When it was evaluated, RFC 3339.
    pub evaluated_at: String,
    /// Number of the attempt as the result states it; 0 where it does not.
    pub attempt: u64,
    /// Addresses of the attempts before it, as the result states them.
    pub earlier: Vec<String>,
}

/// Kind of a reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum ReasonKind {
    /// A quantity that is not shown to keep its limit.
    Measurand,
    /// A condition that is not met.
    Condition,
    /// A fault of the recording.
    Fault,
    /// The test could not be carried out.
    Error,
}

impl ReasonKind {
    /// Every kind.
    pub const ALL: [ReasonKind; 4] =
        [ReasonKind::Measurand, ReasonKind::Condition, ReasonKind::Fault, ReasonKind::Error];

    /// The id used in the index and in tables.
    pub fn id(self) -> &'static str {
        match self {
            ReasonKind::Measurand => "measurand",
            ReasonKind::Condition => "condition",
            ReasonKind::Fault => "fault",
            ReasonKind::Error => "error",
        }
    }
}

/// What kept a unit from passing.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Reason {
    /// Kind.
    pub kind: ReasonKind,
    /// Id of the measurand, the condition, the kind of fault or the message.
    pub name: String,
}

/// A file that was evaluated.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EntryRecording {
    /// Path as given to the run.
    pub path: String,
    /// SHA-256 of its bytes.
    pub sha256: String,
    /// Its size, bytes.
    pub bytes: u64,
}

impl Entry {
    /// Entry of the result in the bytes of a `result.json`; `path` stands in diagnostics.
    ///
    /// # Errors
    /// [`StoreError::Result`] where the bytes are no result, [`StoreError::NoTest`] for one without a procedure.
    pub fn of_json(bytes: &[u8], path: &Path) -> Result<Entry, StoreError> {
        let refused = |source: ReadError| StoreError::Result { path: path.to_owned(), source };
        let result = read::of_any_program(bytes, INDEXED_MEMBERS).map_err(refused)?;
        if result.kind == RunKind::Analyze {
            return Err(StoreError::NoTest(path.to_owned()));
        }
        Ok(entry(result, sha256(bytes)))
    }
}

/// Entry of a result.
fn entry(result: RunRecord, result_sha256: String) -> Entry {
    let reasons = reasons(&result);
    let text = |given: Option<&str>| given.unwrap_or_default().trim().to_owned();
    let (unit, session) = (result.unit_under_test, result.session);
    let procedure = result.procedure.unwrap_or_default();
    let limits = procedure.limits.unwrap_or_default();
    let model = unit.model.as_deref().filter(|m| !m.trim().is_empty());
    Entry {
        unit: EntryUnit {
            serial: text(unit.serial.as_deref()),
            model: text(model.or(unit.family.as_ref().map(LocalText::text))),
            lot: text(unit.lot.as_deref()),
            build_date: unit.build_date,
            reference: unit.reference,
            attributes: unit.attributes,
        },
        test: EntryTest {
            procedure: procedure.id,
            revision: procedure.revision,
            procedure_sha256: procedure.sha256,
            limits: [limits.id, limits.revision].join(" ").trim().to_owned(),
            limits_sha256: limits.sha256,
            station: text(session.station.as_deref()),
            operator: text(session.operator.as_deref()),
            evaluated_at: text(Some(&session.evaluated_at)),
            attempt: result.attempt.as_ref().map_or(0, |a| a.number),
            earlier: result.attempt.into_iter().flat_map(|a| a.earlier).map(|e| e.result).collect(),
        },
        verdict: result.verdict,
        result_sha256,
        measurands: result.measurands.into_iter().map(indexed).collect(),
        reasons,
        recordings: result
            .recording
            .into_iter()
            .map(|f| EntryRecording { path: f.path, sha256: f.sha256, bytes: f.bytes })
            .collect(),
    }
}

/// A row as the index holds it: numbers that are none are absent.
pub(super) fn indexed(row: MeasurandRecord) -> MeasurandRecord {
    MeasurandRecord {
        identifiable: row.value.is_some(),
        value: row.value.filter(|v| v.is_finite()),
        interval: row.interval.filter(|i| i.low.is_finite() && i.high.is_finite()),
        upper_limit: row.upper_limit.filter(|u| u.value.is_finite()),
        limit: row.limit.filter(|l| !l.limits().is_empty()),
        ..row
    }
}

/// Each reason once, in the order of the kinds and names. A unit that passes has none, whatever faults there were.
fn reasons(result: &RunRecord) -> Vec<Reason> {
    if matches!(result.verdict, Verdict::Pass | Verdict::None) {
        return vec![];
    }
    let failed = |m: &&MeasurandRecord| !matches!(m.verdict, Verdict::Pass | Verdict::None);
    let measurands = result.measurands.iter().filter(failed);
    let conditions = result.conditions.iter().filter(|c| c.status == ConditionStatus::Invalid);
    let named = |kind: ReasonKind, name: &str| Reason { kind, name: name.to_owned() };
    let all = measurands
        .map(|m| named(ReasonKind::Measurand, &m.id))
        .chain(conditions.map(|c| named(ReasonKind::Condition, &c.id)))
        .chain(result.integrity.faults.iter().map(|f| named(ReasonKind::Fault, &f.kind)))
        .chain(result.errors.iter().map(|e| named(ReasonKind::Error, &e.id)));
    all.collect::<BTreeSet<Reason>>().into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(json: &str) -> Entry {
        Entry::of_json(json.as_bytes(), Path::new("result.json")).unwrap()
    }

    #[test]
    fn a_result_of_another_program_needs_four_fields() {
        let found = entry(
            r#"{"format": "result/1", "unit_under_test": {"serial": " SN-7 ", "family": "OIUS"}, "verdict": "pass",
                "measurands": [{"id": "static_bias", "value": null}]}"#,
        );
        assert_eq!((found.unit.serial.as_str(), found.unit.model.as_str()), ("SN-7", "OIUS"));
        assert_eq!(found.unit.key(), "7");
        assert_eq!(found.measurands[0].value, None);
        assert!(found.reasons.is_empty());
    }

    #[test]
    fn reasons_are_those_of_a_unit_that_does_not_pass() {
        let json = |verdict: &str| {
            format!(
                r#"{{"format": "result/1", "unit_under_test": {{}}, "verdict": "{verdict}",
                "measurands": [{{"id": "b", "verdict": "fail"}}, {{"id": "a", "verdict": "pass"}}, {{"id": "b", "verdict": "fail"}}],
                "conditions": [{{"id": "temperature", "status": "invalid"}}, {{"id": "supply", "status": "remark"}}],
                "integrity": {{"faults": [{{"kind": "gap"}}, {{"kind": "gap"}}]}}}}"#
            )
        };
        let said: Vec<(ReasonKind, String)> =
            entry(&json("fail")).reasons.into_iter().map(|r| (r.kind, r.name)).collect();
        let expected = [
            (ReasonKind::Measurand, "b"),
            (ReasonKind::Condition, "temperature"),
            (ReasonKind::Fault, "gap"),
        ];
        assert_eq!(said, expected.map(|(kind, name)| (kind, name.to_owned())));
        assert!(entry(&json("pass")).reasons.is_empty());
    }

    #[test]
    fn an_analysis_is_no_test_of_a_unit() {
        let json = r#"{"format": "result/1", "kind": "analyze", "unit_under_test": {}, "verdict": "none", "measurands": []}"#;
        let refused = Entry::of_json(json.as_bytes(), Path::new("result.json"));
        assert!(matches!(refused, Err(StoreError::NoTest(_))));
        let broken = Entry::of_json(b"{", Path::new("result.json"));
        assert!(matches!(broken, Err(StoreError::Result { .. })));
    }
}
