//! What the index has of a result.
//!
//! It is read from `result.json` alone, with as few demands as a data sheet makes, so that results of other programs and of
//! earlier versions have their place too.

use super::address::sha256;
use super::error::StoreError;
use crate::estimate::{Interval, UpperLimit, Verdict};
use crate::ingest::serial;
use crate::record::read::{self, ReadError};
use crate::record::{ConditionStatus, RESULT_FORMAT, RunKind};
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// What the index has of a result.
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
    /// What was measured, in the order of the result.
    pub measurands: Vec<EntryMeasurand>,
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

/// A measurand of a result.
#[derive(Debug, Clone, PartialEq)]
pub struct EntryMeasurand {
    /// Id.
    pub id: String,
    /// Channel.
    pub channel: String,
    /// Phase, in a test of several.
    pub phase: Option<String>,
    /// Unit of the numbers.
    pub unit: String,
    /// Value.
    pub value: Option<f64>,
    /// Its interval.
    pub interval: Option<Interval>,
    /// Bound where there is no value.
    pub upper_limit: Option<UpperLimit>,
    /// Lower limit.
    pub min: Option<f64>,
    /// Upper limit.
    pub max: Option<f64>,
    /// Verdict of the row.
    pub verdict: Verdict,
}

/// What a reason is of.
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
    /// What it is of.
    pub kind: ReasonKind,
    /// Id of the measurand, the condition, the kind of fault or the message.
    pub name: String,
}

/// A file that was evaluated.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
pub struct EntryRecording {
    /// Path as given to the run.
    #[serde(default)]
    pub path: String,
    /// SHA-256 of its bytes.
    #[serde(default)]
    pub sha256: String,
    /// Its size.
    #[serde(default)]
    pub bytes: u64,
}

impl Entry {
    /// What the index has of the result in the bytes of a `result.json`; `path` stands in diagnostics.
    ///
    /// # Errors
    /// [`StoreError::Result`] where the bytes are no result, [`StoreError::NoTest`] for one without a procedure.
    pub fn of_json(bytes: &[u8], path: &Path) -> Result<Entry, StoreError> {
        let refused = |source: ReadError| StoreError::Result { path: path.to_owned(), source };
        let given: Given = read::of_format(bytes, RESULT_FORMAT).map_err(refused)?;
        if given.kind == Some(RunKind::Analyze) {
            return Err(StoreError::NoTest(path.to_owned()));
        }
        Ok(given.entry(sha256(bytes)))
    }
}

/// The part of a `result.json` that is read.
#[derive(Deserialize)]
struct Given {
    #[serde(default)]
    kind: Option<RunKind>,
    #[serde(default)]
    procedure: Option<GivenProcedure>,
    unit_under_test: GivenUnit,
    #[serde(default)]
    session: GivenSession,
    verdict: Verdict,
    #[serde(default)]
    attempt: Option<GivenAttempt>,
    measurands: Vec<GivenMeasurand>,
    #[serde(default)]
    conditions: Vec<GivenCondition>,
    #[serde(default)]
    integrity: GivenIntegrity,
    #[serde(default)]
    recording: Vec<EntryRecording>,
    #[serde(default)]
    errors: Vec<GivenMessage>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct GivenProcedure {
    id: String,
    revision: String,
    sha256: String,
    limits: Option<GivenLimits>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct GivenLimits {
    id: String,
    revision: String,
    sha256: String,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct GivenUnit {
    serial: Option<String>,
    family: Option<String>,
    model: Option<String>,
    lot: Option<String>,
    build_date: Option<String>,
    reference: bool,
    attributes: BTreeMap<String, String>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct GivenSession {
    operator: Option<String>,
    station: Option<String>,
    evaluated_at: Option<String>,
}

#[derive(Deserialize)]
struct GivenAttempt {
    number: u64,
    #[serde(default)]
    earlier: Vec<GivenEarlier>,
}

#[derive(Deserialize)]
struct GivenEarlier {
    #[serde(default)]
    result: String,
}

#[derive(Deserialize)]
struct GivenMeasurand {
    id: String,
    #[serde(default)]
    channel: String,
    #[serde(default)]
    phase: Option<String>,
    #[serde(default)]
    unit: String,
    #[serde(default)]
    value: Option<f64>,
    #[serde(default)]
    interval: Option<Interval>,
    #[serde(default)]
    upper_limit: Option<UpperLimit>,
    #[serde(default)]
    limit: Option<GivenLimit>,
    #[serde(default)]
    verdict: Option<Verdict>,
}

#[derive(Deserialize)]
struct GivenLimit {
    #[serde(default)]
    min: Option<f64>,
    #[serde(default)]
    max: Option<f64>,
}

#[derive(Deserialize)]
struct GivenCondition {
    id: String,
    status: ConditionStatus,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct GivenIntegrity {
    faults: Vec<GivenFault>,
}

#[derive(Deserialize)]
struct GivenFault {
    kind: String,
}

#[derive(Deserialize)]
struct GivenMessage {
    #[serde(default)]
    id: String,
}

impl Given {
    fn entry(self, result_sha256: String) -> Entry {
        let reasons = self.reasons();
        let procedure = self.procedure.unwrap_or_default();
        let limits = procedure.limits.unwrap_or_default();
        let text = |given: Option<String>| given.map(|t| t.trim().to_owned()).unwrap_or_default();
        let unit = self.unit_under_test;
        Entry {
            unit: EntryUnit {
                serial: text(unit.serial),
                model: text(unit.model.filter(|m| !m.trim().is_empty()).or(unit.family)),
                lot: text(unit.lot),
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
                station: text(self.session.station),
                operator: text(self.session.operator),
                evaluated_at: text(self.session.evaluated_at),
                attempt: self.attempt.as_ref().map_or(0, |a| a.number),
                earlier: self.attempt.into_iter().flat_map(|a| a.earlier).map(|e| e.result).collect(),
            },
            verdict: self.verdict,
            result_sha256,
            measurands: self.measurands.into_iter().map(GivenMeasurand::entry).collect(),
            reasons,
            recordings: self.recording,
        }
    }

    /// Each reason once, in the order of the kinds and names. A unit that passes has none, whatever faults there were.
    fn reasons(&self) -> Vec<Reason> {
        if matches!(self.verdict, Verdict::Pass | Verdict::None) {
            return vec![];
        }
        let failed = |m: &&GivenMeasurand| {
            matches!(m.verdict, Some(Verdict::Fail | Verdict::Indeterminate | Verdict::Error))
        };
        let measurands = self.measurands.iter().filter(failed);
        let conditions = self.conditions.iter().filter(|c| c.status == ConditionStatus::Invalid);
        let named = |kind: ReasonKind, name: &str| Reason { kind, name: name.to_owned() };
        let all = measurands
            .map(|m| named(ReasonKind::Measurand, &m.id))
            .chain(conditions.map(|c| named(ReasonKind::Condition, &c.id)))
            .chain(self.integrity.faults.iter().map(|f| named(ReasonKind::Fault, &f.kind)))
            .chain(self.errors.iter().map(|e| named(ReasonKind::Error, &e.id)));
        all.collect::<BTreeSet<Reason>>().into_iter().collect()
    }
}

impl GivenMeasurand {
    fn entry(self) -> EntryMeasurand {
        let limit = self.limit.unwrap_or(GivenLimit { min: None, max: None });
        EntryMeasurand {
            id: self.id,
            channel: self.channel,
            phase: self.phase,
            unit: self.unit,
            value: self.value.filter(|v| v.is_finite()),
            interval: self.interval.filter(|i| i.low.is_finite() && i.high.is_finite()),
            upper_limit: self.upper_limit.filter(|u| u.value.is_finite()),
            min: limit.min,
            max: limit.max,
            verdict: self.verdict.unwrap_or(Verdict::None),
        }
    }
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
