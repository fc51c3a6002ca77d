//! A rehearsal of a test on simulated units, as `rehearsal.json` holds it.

use super::{HistoryShare, Message, ProcedureRecord, Program, VerdictCounts};
use serde::{Deserialize, Serialize};

/// Version of the format of a rehearsal.
pub const REHEARSAL_FORMAT: &str = "rehearsal/1";

/// A whole rehearsal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RehearsalRecord {
    /// Always `rehearsal/1`.
    pub format: String,
    /// The program that wrote this.
    pub program: Program,
    /// Moment of the rehearsal, RFC 3339.
    pub made_at: String,
    /// The procedure with its limits.
    pub procedure: ProcedureRecord,
    /// The model of a nominal unit; absent where it follows from the limits.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub model: Option<String>,
    /// Seed: equal seeds give equal rehearsals.
    pub seed: u64,
    /// Simulated units of each level.
    pub units: usize,
    /// Rate of the simulated recordings, Hz.
    pub sample_rate_hz: f64,
    /// Risk that a length is to keep, of a consumer and of a producer.
    pub stated_risk: f64,
    /// The coefficients of a nominal unit.
    pub nominal: Vec<NominalValue>,
    /// The rehearsed lengths, the shortest first.
    pub lengths: Vec<RehearsedLength>,
    /// How long each limit needs by the predicted uncertainty, the longest first.
    pub needed: Vec<NeededLength>,
    /// The shortest rehearsed length at which both risks are at most the stated one, h.
    pub shortest_h: Option<f64>,
    /// What a reader must know.
    pub notes: Vec<Message>,
}

/// A coefficient of a nominal unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NominalValue {
    /// Id of the measurand.
    pub id: String,
    /// Its value.
    pub value: f64,
    /// Its unit.
    pub unit: String,
    /// Where the value comes from.
    pub from: NominalSource,
}

/// Where a coefficient of a nominal unit comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NominalSource {
    /// The model that was given.
    Model,
    /// The typical value that the limits state.
    Expected,
    /// A share of the limit.
    Limit,
    /// Nothing states one.
    Nothing,
}

impl NominalSource {
    /// Its name in texts.
    pub fn id(self) -> &'static str {
        match self {
            NominalSource::Model => "model",
            NominalSource::Expected => "expected",
            NominalSource::Limit => "limit",
            NominalSource::Nothing => "nothing",
        }
    }
}

/// A length of the test with the verdicts on simulated units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RehearsedLength {
    /// Usable length, without the warm-up, h.
    pub length_h: f64,
    /// Verdicts of the whole test on nominal units.
    pub nominal: VerdictCounts,
    /// Verdicts of its rows on nominal units.
    pub rows: Vec<RehearsedRow>,
    /// Units that differ from a nominal one in one quantity.
    pub levels: Vec<RehearsedLevel>,
    /// Share of passes among units at a limit or beyond it, at the level where they are most frequent. `None` without such units.
    pub consumers_risk: Option<HistoryShare>,
    /// Share of nominal units that do not pass.
    pub producers_risk: Option<HistoryShare>,
}

/// The verdicts of a row on nominal units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RehearsedRow {
    /// Id of the measurand.
    pub id: String,
    /// Channel.
    pub channel: String,
    /// Its verdicts.
    pub counts: VerdictCounts,
}

/// Units that differ from a nominal one in one quantity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RehearsedLevel {
    /// Id of the measurand.
    pub id: String,
    /// Channel.
    pub channel: String,
    /// Size as a multiple of the limit.
    pub factor: f64,
    /// Size in the unit of the measurand.
    pub value: f64,
    /// Unit of the measurand.
    pub unit: String,
    /// Verdicts of the whole test.
    pub whole: VerdictCounts,
    /// Verdicts of its own row.
    pub row: VerdictCounts,
}

/// The length that a limit needs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NeededLength {
    /// Id of the measurand.
    pub id: String,
    /// Channel.
    pub channel: String,
    /// The limit.
    pub limit: f64,
    /// Unit of the limit.
    pub unit: String,
    /// Shortest length with which a unit at half of the limit passes and one at 1.5 times the limit fails in 9 of 10 tests, h; `None` where 1000 h
    /// do not suffice.
    pub needed_h: Option<f64>,
}
