//! A lot: units that were tested one by one by the same procedure, as `index.json` holds it.
//!
//! It has of each unit what tells its verdict and why; the whole of it is in the `result.json` of the unit's folder.

use super::{
    ConditionRecord, ConditionStatus, MeasurandRecord, Message, ProcedureRecord, Program, Session,
    UnitUnderTest,
};
use crate::estimate::Verdict;
use serde::{Deserialize, Serialize};

/// Version of the format of a lot.
pub const LOT_FORMAT: &str = "lot/1";

/// A whole lot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LotRecord {
    /// Always `lot/1`.
    pub format: String,
    /// The program that wrote this.
    pub program: Program,
    /// The procedure that every unit was tested by.
    pub procedure: ProcedureRecord,
    /// Who tested, where, when.
    pub session: Session,
    /// Worst verdict of all units.
    pub verdict: Verdict,
    /// How many units have each verdict.
    pub counts: VerdictCounts,
    /// The units, in the order in which their recordings were named.
    pub units: Vec<LotUnit>,
}

/// How many units have each verdict.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct VerdictCounts {
    /// Units that could not be tested as required.
    pub error: usize,
    /// Units that fail.
    pub fail: usize,
    /// Units that neither pass nor fail.
    pub indeterminate: usize,
    /// Units that pass.
    pub pass: usize,
    /// Units without a limit to be judged by.
    pub none: usize,
}

/// One unit of a lot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LotUnit {
    /// The unit.
    pub unit_under_test: UnitUnderTest,
    /// Where its serial number was taken from.
    pub serial_from: SerialSource,
    /// The recording as named: a file or a manifest.
    pub recording: String,
    /// The files that were read.
    pub files: Vec<LotFile>,
    /// Folder of its own report and result, relative to this file.
    pub folder: String,
    /// Verdict of the unit.
    pub verdict: Verdict,
    /// Why, as in its `result.json`.
    pub summary: Vec<Message>,
    /// Conditions of its test.
    pub conditions: Vec<LotCondition>,
    /// Quantities that were set against a limit, as in its `result.json`.
    pub measurands: Vec<MeasurandRecord>,
    /// Errors that made the verdict `error`.
    pub errors: Vec<Message>,
}

/// Where the serial number of a unit was taken from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum SerialSource {
    /// The manifest of the recording states it.
    Manifest,
    /// The recording states it.
    Recording,
    /// The part of the file name that a pattern selects.
    Pattern,
    /// The file name without its ending, since nothing else tells it.
    FileName,
}

/// A file of a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LotFile {
    /// Path as given.
    pub path: String,
    /// SHA-256 of the bytes of the file.
    pub sha256: String,
}

/// A condition, in short.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LotCondition {
    /// Id, for example `temperature`.
    pub id: String,
    /// Phase that it is of, in a test of several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub phase: Option<String>,
    /// State.
    pub status: ConditionStatus,
    /// Why it is not plainly met; absent where it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub message: Option<Message>,
}

impl LotCondition {
    /// A condition of a run, in short.
    pub fn of(condition: &ConditionRecord) -> LotCondition {
        LotCondition {
            id: condition.id.clone(),
            phase: condition.phase.clone(),
            status: condition.status,
            message: condition.message.clone().filter(|_| condition.status != ConditionStatus::Ok),
        }
    }
}

impl VerdictCounts {
    /// Counts verdicts.
    pub fn of(verdicts: impl IntoIterator<Item = Verdict>) -> VerdictCounts {
        let mut counts = VerdictCounts::default();
        for verdict in verdicts {
            *match verdict {
                Verdict::Error => &mut counts.error,
                Verdict::Fail => &mut counts.fail,
                Verdict::Indeterminate => &mut counts.indeterminate,
                Verdict::Pass => &mut counts.pass,
                Verdict::None => &mut counts.none,
            } += 1;
        }
        counts
    }

    /// Number of verdicts.
    pub fn total(self) -> usize {
        self.error + self.fail + self.indeterminate + self.pass + self.none
    }

    /// The counts that are not zero, the worst verdict first.
    pub fn present(self) -> Vec<(Verdict, usize)> {
        let all = [
            (Verdict::Error, self.error),
            (Verdict::Fail, self.fail),
            (Verdict::Indeterminate, self.indeterminate),
            (Verdict::Pass, self.pass),
            (Verdict::None, self.none),
        ];
        all.into_iter().filter(|(_, n)| *n > 0).collect()
    }
}

impl std::ops::AddAssign for VerdictCounts {
    fn add_assign(&mut self, other: VerdictCounts) {
        self.error += other.error;
        self.fail += other.fail;
        self.indeterminate += other.indeterminate;
        self.pass += other.pass;
        self.none += other.none;
    }
}

impl SerialSource {
    /// Every source.
    pub const ALL: [SerialSource; 4] =
        [SerialSource::Manifest, SerialSource::Recording, SerialSource::Pattern, SerialSource::FileName];

    /// The id used in files and tables.
    pub fn id(self) -> &'static str {
        match self {
            SerialSource::Manifest => "manifest",
            SerialSource::Recording => "recording",
            SerialSource::Pattern => "pattern",
            SerialSource::FileName => "file_name",
        }
    }
}

impl LotUnit {
    /// The serial number; empty where there is none.
    pub fn serial(&self) -> &str {
        self.unit_under_test.serial.as_deref().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdicts_are_counted_and_the_worst_is_first() {
        let counts = VerdictCounts::of([Verdict::Pass, Verdict::Error, Verdict::Pass, Verdict::Fail]);
        assert_eq!(counts.present(), [(Verdict::Error, 1), (Verdict::Fail, 1), (Verdict::Pass, 2)]);
    }

    #[test]
    fn sources_are_written_by_their_ids() {
        for source in SerialSource::ALL {
            assert_eq!(serde_json::to_value(source).unwrap(), source.id());
        }
    }
}
