//! A day of a watched folder: what was tested and what was not, as `day.json` holds it.

use super::{LotUnit, Message, Program, VerdictCounts};
use crate::estimate::Verdict;
use serde::{Deserialize, Serialize};

/// Version of the format of a day.
pub const DAY_FORMAT: &str = "day/1";
/// Version of what a hook command is told.
pub const EVENT_FORMAT: &str = "watch-event/1";

/// A whole day.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DayRecord {
    /// Always `day/1`.
    pub format: String,
    /// The program that wrote this.
    pub program: Program,
    /// Day by UTC, such as 2027-03-01.
    pub day: String,
    /// The watched folder.
    pub watched: String,
    /// Moment of the last look at the folder, RFC 3339.
    pub made_at: String,
    /// Worst verdict of the day.
    pub verdict: Verdict,
    /// How many tests have each verdict.
    pub counts: VerdictCounts,
    /// The tests of the day, in their order.
    pub tests: Vec<DayTest>,
    /// Recordings that were not tested at the last look, and why.
    pub untested: Vec<Untested>,
}

/// A test of a day.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DayTest {
    /// Id of the test: SHA-256 over recording, procedure, limits and version of the program.
    pub id: String,
    /// SHA-256 of the recording; of several files, over the hashes of all.
    pub sha256: String,
    /// Id of the procedure.
    pub procedure: String,
    /// Moment of the test, RFC 3339.
    pub tested_at: String,
    /// State of the hook command.
    pub hook: HookState,
    /// The unit, its verdict and the reasons.
    pub unit: LotUnit,
}

/// State of a hook command.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HookState {
    /// The rule has none.
    None,
    /// It is still to be told, or told again.
    Pending,
    /// It was told.
    Told,
}

impl HookState {
    /// Id in files and tables.
    pub fn id(self) -> &'static str {
        match self {
            HookState::None => "none",
            HookState::Pending => "pending",
            HookState::Told => "told",
        }
    }
}

/// A recording that was not tested.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Untested {
    /// Path below the watched folder.
    pub recording: String,
    /// The reason.
    pub why: Message,
}

/// What a hook command is told of a test.
#[derive(Debug, Serialize)]
pub struct WatchEvent<'a> {
    /// Always `watch-event/1`.
    pub format: &'static str,
    /// Id of the test: the same when it is told again.
    pub id: &'a str,
    /// Serial number.
    pub serial: &'a str,
    /// Verdict.
    pub verdict: Verdict,
    /// The recording as it was named.
    pub recording: &'a str,
    /// SHA-256 of the recording.
    pub sha256: &'a str,
    /// Id of the procedure.
    pub procedure: &'a str,
    /// Moment of the test, RFC 3339.
    pub tested_at: &'a str,
    /// Folder of the result.
    pub folder: String,
    /// The record of the result.
    pub result: String,
    /// The page of the result.
    pub report: String,
}
