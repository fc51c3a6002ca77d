//! What the program tells of a finished result: the only place where results are understood.

use crate::texts::Lang;
use sagnac_base::estimate::Verdict;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A text in each language of the pages.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct LocalText {
    /// English.
    pub en: String,
    /// Russian.
    pub ru: String,
}

impl LocalText {
    /// The text in a language.
    pub fn of(&self, lang: Lang) -> &str {
        match lang {
            Lang::En => &self.en,
            Lang::Ru => &self.ru,
        }
    }
}

/// What an operator does after a verdict.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Next {
    /// The unit goes on.
    HandOn,
    /// The unit is set aside.
    SetAside,
    /// The serial number does not agree with the recording.
    CheckSerial,
    /// A condition of the test is to be met.
    MeetCondition,
    /// The recording is too short: this length decides, hours.
    RecordLonger(f64),
    /// The report tells why nothing was decided.
    ReadReport,
    /// Limits are to be chosen.
    ChooseLimits,
    /// The recording cannot be tested.
    CheckRecording,
}

/// A quantity with its limit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Quantity {
    /// Id of the measurand, with phase and channel where there are several.
    pub id: String,
    /// Name.
    pub name: LocalText,
    /// Value with its unit.
    pub value: LocalText,
    /// Limit with its unit.
    pub limit: LocalText,
    /// Verdict.
    pub verdict: Verdict,
}

/// What the pages show of a result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Verdict on the unit.
    pub verdict: Verdict,
    /// Id of the procedure.
    pub procedure: String,
    /// Lot of the unit.
    pub lot: Option<String>,
    /// Why the unit does not pass, the first reason first; bounded.
    pub reasons: Vec<LocalText>,
    /// What to do.
    pub next: Next,
    /// The quantities with a limit.
    pub quantities: Vec<Quantity>,
}

/// The program, as far as the server asks it.
pub trait Harness: Send + Sync + 'static {
    /// What a finished folder of results tells; `None` without one.
    fn outcome(&self, folder: &Path) -> Option<Outcome>;
    /// Who signed a folder of results, a line each; an error where a signature does not hold.
    fn signatures(&self, folder: &Path) -> Vec<LocalText>;
    /// Takes a line for the log.
    fn log(&self, line: &str);
}
