//! A lot from the records of its units.

use crate::estimate::Verdict;
use crate::ingest::lot::Member;
use crate::record::{
    LOT_FORMAT, LotCondition, LotFile, LotRecord, LotUnit, ProcedureRecord, Program, RunRecord, SerialSource,
    Session, VerdictCounts,
};

/// The part of the record of a unit that a lot keeps.
pub fn unit(member: &Member, record: &RunRecord) -> LotUnit {
    of_record(record, member.serial_from, member.recording.display().to_string(), member.folder.clone())
}

/// Entry of a lot from the record of a unit whose recording was named so, in a folder of its own.
pub fn of_record(
    record: &RunRecord,
    serial_from: SerialSource,
    recording: String,
    folder: String,
) -> LotUnit {
    LotUnit {
        unit_under_test: record.unit_under_test.clone(),
        serial_from,
        recording,
        files: record
            .recording
            .iter()
            .map(|f| LotFile { path: f.path.clone(), sha256: f.sha256.clone() })
            .collect(),
        folder,
        verdict: record.verdict,
        summary: record.summary.clone(),
        conditions: record.conditions.iter().map(LotCondition::of).collect(),
        measurands: record.measurands.iter().filter(|m| m.limit.is_some()).cloned().collect(),
        errors: record.errors.clone(),
    }
}

/// A lot of units, in their order.
pub fn lot(procedure: ProcedureRecord, session: Session, units: Vec<LotUnit>) -> LotRecord {
    LotRecord {
        format: LOT_FORMAT.to_owned(),
        program: Program::this(),
        procedure,
        session,
        verdict: units.iter().map(|u| u.verdict).max().unwrap_or(Verdict::None),
        counts: VerdictCounts::of(units.iter().map(|u| u.verdict)),
        units,
    }
}
